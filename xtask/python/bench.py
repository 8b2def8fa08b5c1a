"""Measures shrouds and its peers and rewrites the tables of docs/benchmarks.md.

`cargo xtask bench` builds what this needs and calls it. Every worker is a process that holds one
volume and does one run per request; the contenders of a comparison take turns, so that what else
the machine does falls on all of them. CPU seconds are those of the whole process; of several runs
the least counts.
"""

import argparse
import filecmp
import json
import os
import platform
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/python"))

import accuracy  # noqa: E402

VOLUMES = ["tori24", "sphere128", "tori128", "tori128_1x1x3", "gyroid256", "brain"]
LARGE = ["sphere512", "tori512", "gyroid512"]
QUICK = ["tori24", "tori128"]
# The same kind of surface, everywhere of the same roughness: only their number of vertices differs.
GROWTH = ["gyroid96_period32", "gyroid256"]
LARGE_GROWTH = [*GROWTH, "gyroid416_period32"]
# Seconds that make a turn too slow for another one.
SLOW = 15
# Seconds after which a comparison takes no further turns.
PATIENCE = 60


class Worker:
    """A process that answers requests about one volume."""

    def __init__(self, *command):
        self.command = [str(word) for word in command]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self.process = subprocess.Popen(self.command, text=True, **pipes)

    def ask(self, request):
        try:
            self.process.stdin.write(request + "\n")
            self.process.stdin.flush()
            return json.loads(self.process.stdout.readline())
        except (BrokenPipeError, json.JSONDecodeError) as error:
            raise SystemExit(f"failed at {request}: {' '.join(self.command)}") from error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait()


class Volume:
    """A volume in a file, with what is known about it."""

    def __init__(self, name, folder, data):
        self.name, self.path = name, folder / f"{name}.npy"
        if name == "brain":
            self.body, (self.inside, self.spacing) = None, brain(data / "brain.nii.gz")
        else:
            self.body, dims, self.spacing = accuracy.body(name)
            self.inside = accuracy.occupancy(self.body, dims, self.spacing)
        np.save(self.path, self.inside.transpose(2, 1, 0).astype("u1", order="C"))

    def quality(self, vertices, triangles):
        """Errors of a mesh, in smallest spacings and degrees."""
        known = accuracy.errors(self.body, vertices, triangles) if self.body else {}
        wrong = accuracy.wrong_by_majority(self.spacing, vertices, triangles, self.inside)
        return {**known, "wrong side": wrong}


def brain(path):
    """The mask with two layers around it, at the origin, in its smallest spacings."""
    import nibabel

    image = nibabel.load(path)
    spacing = np.array(image.header.get_zooms()[:3], float)
    return np.pad(np.asanyarray(image.dataobj) != 0, 2), spacing / spacing.min()


def alternate(contenders, repeats):
    """Lets (worker, request) pairs take turns; the first answers, then all later ones, of each.

    A first turn that takes long is the only one.
    """
    start = time.monotonic()
    first = [worker.ask(request) for worker, request in contenders]
    if time.monotonic() - start > SLOW:
        return first, [[answer] for answer in first]
    later, start = [[] for _ in contenders], time.monotonic()
    for _ in range(repeats):
        for answers, (worker, request) in zip(later, contenders):
            answers.append(worker.ask(request))
        if time.monotonic() - start > PATIENCE:
            break
    return first, later


def least(answers, key):
    return min(answer[key] for answer in answers)


class Bench:
    def __init__(self, arguments):
        self.arguments, self.repeats = arguments, arguments.repeats
        self.folder = arguments.folder
        self.folder.mkdir(parents=True, exist_ok=True)
        listed = subprocess.run([arguments.worker, "presets"], stdout=subprocess.PIPE, text=True)
        self.presets = listed.stdout.split()

    def ours(self, volume, preset, threads=1):
        dims, spacing = (",".join(map(str, x)) for x in (volume.inside.shape, volume.spacing))
        return Worker(self.arguments.worker, volume.path, dims, spacing, preset, threads)

    def vtk(self, volume):
        script = Path(__file__).with_name("bench_vtk.py")
        return Worker(sys.executable, "-B", script, volume.path, ",".join(map(str, volume.spacing)))

    def volumes(self, names):
        """Makes the volumes one by one; the brain only where `cargo xtask data` has been."""
        for name in names:
            if name == "brain" and not (self.arguments.data / "brain.nii.gz").exists():
                say("brain is left out: run `cargo xtask data` for it")
                continue
            yield Volume(name, self.folder, self.arguments.data)

    def compare(self, names):
        """Rows of the tables `speed`, `stages` and `midpoint`."""
        speed, stages, midpoint = [], [], []
        for volume in self.volumes(names):
            peers = []
            for preset in self.presets:
                row, peer, stage = self.preset(volume, preset)
                peers += [peer] if peer else []
                speed.append(row)
                stages.append(stage)
            if peers:
                speed.append({**min(peers, key=lambda peer: peer["cpu"]), **self.vtk_quality(volume)})
            midpoint.append(self.midpoint(volume))
        return speed, stages, midpoint

    def preset(self, volume, preset):
        """A row of ours, one of VTK in turns with it (if asked for), and one of our stages."""
        say(f"{volume.name}, {preset}")
        mesh = self.folder / f"{volume.name}-{preset}.ply"
        with ExitStack() as workers:
            ours = workers.enter_context(self.ours(volume, preset))
            contenders = [(ours, "run")]
            if self.arguments.peers == "vtk":
                contenders.append((workers.enter_context(self.vtk(volume)), "nets"))
            first, later = alternate(contenders, self.repeats)
            ours.ask(f"save {mesh}")
            for vtk, _ in contenders[1:]:
                vtk.ask(f"save {self.vtk_mesh(volume)}")
            _, (parts,) = alternate([(ours, "stages")], min(3, self.repeats))
        row = cost(first[0], later[0], f"shrouds {preset}", volume)
        peer = None
        if len(first) > 1:
            peer = {**cost(first[1], later[1], "vtkSurfaceNets3D", volume), "ratio": 1}
            row["ratio"] = row["cpu"] / peer["cpu"]
        stage = {"name": volume.name, "preset": preset, "vertices": row["vertices"]}
        for name in STAGE_NAMES:
            stage[name] = 1e9 * min(part[name]["cpu"] for part in parts) / row["vertices"]
        row.update(volume.quality(*accuracy.read_ply(mesh)))
        return row, peer, stage

    def vtk_mesh(self, volume):
        return self.folder / f"{volume.name}-vtk.npz"

    def vtk_quality(self, volume):
        with np.load(self.vtk_mesh(volume)) as mesh:
            return volume.quality(mesh["vertices"].astype(float), mesh["triangles"])

    def midpoint(self, volume):
        say(f"{volume.name}, midpoint")
        keys = ["ours"]
        with ExitStack() as workers:
            ours = workers.enter_context(self.ours(volume, self.presets[0]))
            contenders = [(ours, "midpoint")]
            if self.arguments.peers == "vtk":
                keys += ["flying", "discrete"]
                vtk = workers.enter_context(self.vtk(volume))
                contenders += [(vtk, key) for key in keys[1:]]
            first, later = alternate(contenders, self.repeats)
        row = {"name": volume.name, "vertices": first[0]["vertices"]}
        row |= {key: 1e3 * least(answers, "cpu") for key, answers in zip(keys, later)}
        if "flying" in row:
            row["times"] = min(row["flying"], row["discrete"]) / row["ours"]
        return row

    def growth(self, names):
        """Microseconds per vertex on the same kind of surface."""
        rows = []
        for volume in self.volumes(names):
            row = {"name": volume.name}
            for preset in self.presets:
                say(f"{volume.name}, growth, {preset}")
                with self.ours(volume, preset) as ours:
                    _, (runs,) = alternate([(ours, "run")], self.repeats)
                row["vertices"] = runs[0]["vertices"]
                row[preset] = 1e6 * least(runs, "cpu") / row["vertices"]
            rows.append(row)
        return rows

    def threads(self, names):
        """Wall seconds on one and on two threads, and whether the meshes have the same bytes."""
        rows = []
        for volume in self.volumes(names):
            for preset in self.presets:
                say(f"{volume.name}, two threads, {preset}")
                with self.ours(volume, preset, 1) as one, self.ours(volume, preset, 2) as two:
                    _, (ones, twos) = alternate([(one, "run"), (two, "run")], self.repeats)
                    paths = [self.folder / f"threads-{n}.ply" for n in (1, 2)]
                    for worker, path in zip((one, two), paths):
                        worker.ask(f"save {path}")
                same = filecmp.cmp(*paths, shallow=False)
                row = {"name": volume.name, "preset": preset, "vertices": ones[0]["vertices"]}
                row |= {"one": least(ones, "wall"), "two": least(twos, "wall")}
                row |= {"ratio": row["one"] / row["two"], "same": "yes" if same else "NO"}
                rows.append(row)
        return rows

    def program(self, names):
        """The whole program at its defaults, from the NPY file to the PLY file."""
        rows = []
        for volume in self.volumes(names):
            say(f"{volume.name}, whole program")
            mesh = self.folder / "program.ply"
            command = [self.arguments.program, "mesh", volume.path, "-o", mesh, "--quiet"]
            command += ["--spacing", ",".join(map(str, volume.spacing)), "--threads"]
            row = {"name": volume.name, "inside": int(volume.inside.sum())}
            for threads in (1, 2):
                runs = [accuracy.run([*command, threads]) for _ in range(min(3, self.repeats))]
                row[f"seconds{threads}"], row[f"memory{threads}"] = map(min, zip(*runs))
            rows.append(row)
        return rows

    def accuracy(self, names):
        """The program's own tables of accuracy, primal and dual, of two presets."""
        for surface in ("primal", "dual"):
            say(f"accuracy, {surface}")
            rows = accuracy.bench(self.arguments.program, self.folder, surface, names)
            yield f"accuracy-{surface}", accuracy.COLUMNS, list(rows)


def cost(first, later, program, volume):
    cpu = least(later, "cpu")
    return {
        "name": volume.name,
        "program": program,
        "vertices": first["vertices"],
        "cpu": cpu,
        "per vertex": 1e6 * cpu / max(first["vertices"], 1),
        "memory": first["memory"],
        "end": first.get("status"),
        "step": first.get("step"),
    }


STAGE_NAMES = ["bits", "surface", "solve", "mesh"]
SPEED = {
    "name": ("volume", "{}"),
    "program": ("program", "{}"),
    "vertices": ("vertices", "{}"),
    "cpu": ("CPU s", "{:.4f}"),
    "ratio": ("× VTK", "{:.2f}"),
    "per vertex": ("µs per vertex", "{:.2f}"),
    "memory": ("extra peak MB", "{:.0f}"),
    "distance": ("distance RMS", "{:.4f}"),
    "normal": ("normal RMS, °", "{:.2f}"),
    "wrong side": ("wrong-side points", "{}"),
    "end": ("end", "{}"),
    "step": ("RMS step left", "{:.1e}"),
}
STAGES = {
    "name": ("volume", "{}"),
    "preset": ("preset", "{}"),
    "vertices": ("vertices", "{}"),
    **{name: (name, "{:.0f}") for name in STAGE_NAMES},
}
MIDPOINT = {
    "name": ("volume", "{}"),
    "vertices": ("vertices", "{}"),
    "ours": ("shrouds, ms", "{:.2f}"),
    "flying": ("vtkFlyingEdges3D, ms", "{:.2f}"),
    "discrete": ("vtkDiscreteFlyingEdges3D, ms", "{:.2f}"),
    "times": ("times faster", "{:.1f}"),
}
THREADS = {
    "name": ("volume", "{}"),
    "preset": ("preset", "{}"),
    "vertices": ("vertices", "{}"),
    "one": ("one thread, s", "{:.2f}"),
    "two": ("two threads, s", "{:.2f}"),
    "ratio": ("one / two", "{:.2f}"),
    "same": ("same bytes", "{}"),
}
PROGRAM = {
    "name": ("volume", "{}"),
    "inside": ("inside voxels", "{}"),
    "seconds1": ("one thread, s", "{:.2f}"),
    "memory1": ("peak MB", "{:.0f}"),
    "seconds2": ("two threads, s", "{:.2f}"),
    "memory2": ("peak MB, two threads", "{:.0f}"),
}


def tables(bench):
    """Name, columns and rows of every table, as they get ready."""
    arguments = bench.arguments
    if arguments.quick:
        plan, growth, many = [("", QUICK)], GROWTH[:1], GROWTH[:1]
    else:
        plan, growth, many = [("", VOLUMES)], GROWTH, ["gyroid256"]
    if arguments.large:
        plan, growth = [*plan, ("-large", LARGE)], LARGE_GROWTH
    yield from bench.accuracy(QUICK if arguments.quick else accuracy.VOLUMES)
    for suffix, names in plan:
        for name, columns, rows in zip(
            ("speed", "stages", "midpoint"), (SPEED, STAGES, MIDPOINT), bench.compare(names)
        ):
            yield name + suffix, columns, rows
    # Two sizes show no growth: the document has a place for the complete table only.
    columns = {"name": ("volume", "{}"), "vertices": ("vertices", "{}")}
    columns |= {preset: (f"{preset}, µs per vertex", "{:.3f}") for preset in bench.presets}
    yield "growth" if arguments.large else "growth-small", columns, bench.growth(growth)
    for suffix, names in [("", many), *([("-large", ["gyroid512"])] if arguments.large else [])]:
        yield f"threads{suffix}", THREADS, bench.threads(names)
        yield f"program{suffix}", PROGRAM, bench.program(names)


def commit():
    """What is measured; asked before the first table makes the document differ."""
    command = ["git", "-C", ROOT, "describe", "--always", "--dirty", "--abbrev=10"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout.strip() or "no commit"


def circumstances(measured):
    """When, what and on which machine: stands above every table."""
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    day = time.strftime("%Y-%m-%d")
    return f"*{day}, {measured}, {processor()}, {os.cpu_count()} cores{load}.*"


def processor():
    try:
        with open("/proc/cpuinfo") as file:
            return next(line.partition(":")[2].strip() for line in file if "model name" in line)
    except (OSError, StopIteration):
        return platform.machine()


def rewrite(document, name, lines):
    """Puts `lines` between the marks of a section; whether it has one."""
    text = document.read_text()
    start, end = f"<!-- bench {name} -->\n", f"<!-- /bench {name} -->"
    if start not in text:
        return False
    before, rest = text.split(start)
    _, after = rest.split(end)
    part = document.with_suffix(".part")
    part.write_text(before + start + "\n".join(lines) + "\n" + end + after)
    part.replace(document)
    return True


def say(message):
    print(f"{time.strftime('%H:%M:%S')} {message}", file=sys.stderr, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    for name in ("worker", "program", "folder", "data", "document"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--peers", choices=["vtk", "none"], default="vtk")
    arguments = parser.parse_args()
    complete = not arguments.quick and arguments.peers == "vtk"
    measured = commit()
    for name, columns, rows in tables(Bench(arguments)):
        lines = ["", circumstances(measured), "", *accuracy.table(columns, rows), ""]
        print(f"## {name}", *lines, sep="\n", flush=True)
        if complete and rewrite(arguments.document, name, lines):
            say(f"{arguments.document} has a new table {name}")


if __name__ == "__main__":
    main()
