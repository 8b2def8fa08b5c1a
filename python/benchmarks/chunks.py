"""Memory of each worker, and the surface against that of one machine: what docs/scale.md tells of Dask.

    python python/benchmarks/chunks.py gyroid --size 512 --chunk 128 --compare

Needs the package and what python/tests/requirements-distributed.txt lists. The volume is written to a Zarr store slab by
slab, then made a PLY file by workers of one thread each, whose peak memory the system tells; with --compare the same
volume is shrouded at once here. One line of JSON is printed.
"""

import argparse
import json
import tempfile
import time
from pathlib import Path

import numpy as np
import shrouds
import zarr
from dask.distributed import Client, LocalCluster
from shrouds import distributed

#: Centres are no symmetric places of the lattice.
CENTRE = np.array([0.137, 0.071, -0.093])


def tori(x, y, z, size):
    """Two linked tori."""
    ring, tube = 0.23 * size, 0.078 * size

    def inside(u, v, height):
        return (np.sqrt(u**2 + v**2) - ring) ** 2 + height**2 <= tube**2

    return inside(x + ring / 2, y, z) | inside(x - ring / 2, z, y)


def gyroid(x, y, z, size):
    """A gyroid in a ball: one body with walls and saddles everywhere."""
    ball = x**2 + y**2 + z**2 <= (0.46 * size) ** 2
    x, y, z = (16 * np.pi / size * each for each in (x, y, z))
    return ball & (np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) >= 0)


def slab(body, size, first, end):
    """Layers of the volume, indexed [z, y, x]."""
    middle = (size - 1) / 2 + CENTRE
    z, y, x = np.ogrid[first:end, :size, :size]
    places = (axis.astype(np.float32) - m for axis, m in zip((x, y, z), middle, strict=True))
    return body(*(place.astype(np.float32) for place in places), size).astype(np.uint8)


def write_store(path, body, size):
    store = zarr.create_array(path, shape=(size,) * 3, chunks=(128,) * 3, dtype="u1")
    for first in range(0, size, 128):
        end = min(first + 128, size)
        for start in range(first, end, 32):
            store[start : min(start + 32, end)] = slab(body, size, start, min(start + 32, end))


def peak_memory():
    """Peak bytes of this process, as Linux tells them; those of getrusage can be its parent's."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def in_order(vertices, faces, size):
    """Grid edges as numbers, ascending, where each vertex lies on its own, and the triangles by the ranks of these
    numbers, ascending too."""
    whole = np.rint(vertices)
    axis = np.abs(vertices - whole).argmax(1)
    shift = np.take_along_axis(vertices, axis[:, None], 1)[:, 0]
    low = whole.astype(np.int64)
    low[np.arange(len(low)), axis] = np.floor(shift)
    x, y, z = low.T + 1
    edges = ((axis * (size + 2) + z) * (size + 2) + y) * (size + 2) + x
    order = np.argsort(edges)
    rank = np.empty(len(order), np.uint32)
    rank[order] = np.arange(len(order), dtype=np.uint32)
    triangles = rank[faces]
    turn = triangles.argmin(1)[:, None]
    triangles = np.take_along_axis(triangles, (turn + np.arange(3)) % 3, 1)
    return edges[order], shift[order], triangles[np.lexsort(triangles.T)]


def compared(path, values, size):
    """What the file has against the surface that is made at once."""
    vertices, faces = shrouds.read_mesh(path)
    found = shrouds.check((vertices, faces), values, self_intersections=False)["checks"]
    edges, shift, triangles = in_order(vertices, faces, size)
    del vertices, faces
    one = shrouds.shroud(values)
    made = one.vertices.astype(np.float64), one.faces
    del one
    other_edges, other_shift, other_triangles = in_order(*made, size)
    same = np.array_equal(edges, other_edges)
    return {
        "wrong_side": found["wrong_side"],
        "ok": found["ok"],
        "same_vertices": same,
        "same_triangles": np.array_equal(triangles, other_triangles),
        "largest_delta_difference": float(np.abs(shift - other_shift).max()) if same else None,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("body", choices=["tori", "gyroid"])
    parser.add_argument("--size", type=int, default=512, help="voxels along each axis")
    parser.add_argument("--chunk", type=int, default=128, help="voxels along each axis of a chunk")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--format", choices=["ply", "draco"], default="ply")
    parser.add_argument("--compare", action="store_true", help="with the surface made at once; PLY")
    parser.add_argument("--folder", type=Path, help="for all files [default: a temporary one]")
    options = parser.parse_args()
    body = {"tori": tori, "gyroid": gyroid}[options.body]
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        store, output = Path(folder, "volume.zarr"), Path(folder, "meshes")
        write_store(str(store), body, options.size)
        print(json.dumps(measured(options, store, output, body)))


def measured(options, store, output, body):
    cluster = LocalCluster(
        n_workers=options.workers, threads_per_worker=1, memory_limit=None, dashboard_address=None
    )
    with cluster, Client(cluster) as client:
        before = client.run(peak_memory)
        start = time.perf_counter()
        counts = distributed.mesh(
            store, output, client, labels=[1], chunk=options.chunk, format=options.format
        )
        seconds = time.perf_counter() - start
        after = client.run(peak_memory)
    report = {
        "body": options.body,
        "size": options.size,
        "chunk": options.chunk,
        "format": options.format,
        "vertices": counts[1][0],
        "triangles": counts[1][1],
        "seconds": round(seconds, 1),
        "worker_megabytes_before": [round(n / 1e6) for n in before.values()],
        "worker_megabytes_peak": [round(n / 1e6) for n in after.values()],
    }
    if options.compare and options.format == "ply":
        values = np.concatenate(
            [slab(body, options.size, z, min(z + 32, options.size)) for z in range(0, options.size, 32)]
        )
        report.update(compared(output / "1.ply", values, options.size))
    if options.format == "draco":
        sizes = [(output / "mesh" / "1").stat().st_size, (output / "mesh" / "1.index").stat().st_size]
        report["bytes"] = sum(sizes)
    return report


if __name__ == "__main__":
    main()
