"""What a call from Python costs beyond the work in Rust: the table of python/README.md.

    python python/benchmarks/overhead.py

The seconds of each call against those of the stages that Rust measures within it, the packing of the array to bits
among them: the median of several calls with one thread.
"""

import statistics
import time

import numpy as np
import shrouds
from chunks import gyroid, slab, tori

SIZE, CALLS = 256, 9


def share(values):
    """Seconds of a call, and what of them is not spent in a stage."""
    found = []
    for _ in range(CALLS):
        start = time.perf_counter()
        made = shrouds.shroud(values, threads=1)
        whole = time.perf_counter() - start
        times = made.report["times"]
        stages = sum(times[name] for name in ("read", "surface", "optimize", "mesh"))
        found.append((whole, whole - stages))
    return [statistics.median(column) for column in zip(*found, strict=True)]


def main():
    print("| volume | call, s | not in a stage, s | % |")
    print("|---|---:|---:|---:|")
    for body in (tori, gyroid):
        volume = slab(body, SIZE, 0, SIZE)
        orders = {"C": volume, "F": np.asfortranarray(volume), "bool": volume.astype(bool)}
        orders["every other of int64"] = np.repeat(volume, 2, axis=2).astype(np.int64)[:, :, ::2]
        for name, values in orders.items():
            whole, rest = share(values)
            label = f"{body.__name__} {SIZE}³, {name}"
            print(f"| {label} | {whole:.3f} | {rest:.4f} | {100 * rest / whole:.1f} |")


if __name__ == "__main__":
    main()
