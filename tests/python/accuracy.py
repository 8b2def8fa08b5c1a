"""How close the program's surfaces come to bodies whose true surface is known.

    python accuracy.py --program target/release/shrouds --folder target/bench
    python accuracy.py --mesh MESH.ply --volume tori24

The first form makes the volumes, shrouds them and prints a Markdown table; the second judges one
mesh, of any program. Lengths are in world units; the smallest spacing is 1, so they are voxels.
"""

import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np

from judge import wrong_side

VOLUMES = ["tori24", "sphere32", "sphere128", "tori128", "tori128_1x1x3"]


class Ball:
    def __init__(self, centre, radius):
        self.centre, self.radius = centre, radius
        self.area = 4 * np.pi * radius**2
        self.volume = self.area * radius / 3

    def distance_and_normal(self, points):
        """Signed distance (negative inside) and the true surface's normal nearest to each point."""
        away = points - self.centre
        length = np.linalg.norm(away, axis=-1)
        return length - self.radius, away / length[:, None]


class LinkedTori:
    """The first torus has its axis along z, the second along y."""

    def __init__(self, centres, ring, tube):
        self.centres, self.ring, self.tube = centres, ring, tube
        self.area = 2 * 4 * np.pi**2 * ring * tube
        self.volume = self.area * tube / 2

    def distance_and_normal(self, points):
        one, two = (self._one(points - c, axis) for c, axis in zip(self.centres, (2, 1)))
        nearer = one[0] <= two[0]
        return np.where(nearer, one[0], two[0]), np.where(nearer[:, None], one[1], two[1])

    def _one(self, away, axis):
        in_plane = away.copy()
        in_plane[:, axis] = 0
        radial = in_plane / np.linalg.norm(in_plane, axis=-1)[:, None]
        from_circle = away - self.ring * radial
        length = np.linalg.norm(from_circle, axis=-1)
        return length - self.tube, from_circle / length[:, None]


def body(name):
    """The body, the lattice points along x, y, z and the spacing of a volume such as `tori24`."""
    shape, _, rest = name.partition("_")
    n = int(shape.lstrip("abcdefghijklmnopqrstuvwxyz"))
    spacing = np.array([1, 1, 3] if rest == "1x1x3" else [1, 1, 1])
    # Off every symmetry of the lattice; the same places as the phantoms of the library.
    centre = (n - 1) / 2 + np.array([0.137, 0.071, -0.093])
    if shape.startswith("sphere"):
        made = Ball(centre, 0.4 * n)
    else:
        ring = np.array([0.23 * n, 0, 0])
        first = centre - ring / 2
        made = LinkedTori([first, first + ring], 0.23 * n, 0.078 * n)
    return made, -(-n // spacing), spacing


def occupancy(made, dims, spacing):
    """Which lattice points [i, j, k] lie in the body."""
    points = np.indices(dims).reshape(3, -1).T * spacing
    return (made.distance_and_normal(points.astype(float))[0] <= 0).reshape(dims)


def read_ply(path):
    """Vertices and triangles of a binary little-endian PLY file."""
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = [line.split() for line in data[:end].decode().splitlines()]
    assert ["format", "binary_little_endian", "1.0"] in header, "a binary little-endian PLY file"
    types = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4"}
    types |= {"uint": "<u4", "float": "<f4", "double": "<f8", "int8": "i1", "uint8": "u1"}
    types |= {"int32": "<i4", "uint32": "<u4", "float32": "<f4", "float64": "<f8"}
    counts, layout = {}, {}
    for words in header:
        if words[0] == "element":
            element, counts[words[1]] = words[1], int(words[2])
            layout[element] = []
        elif words[0] == "property" and words[1] == "list":
            layout[element] += [("n", types[words[2]]), (words[4], types[words[3]], 3)]
        elif words[0] == "property":
            layout[element].append((words[2], types[words[1]]))
    vertices = np.frombuffer(data, layout["vertex"], counts["vertex"], end)
    faces = np.frombuffer(data, layout["face"], counts["face"], end + vertices.nbytes)
    assert (faces["n"] == 3).all(), "triangles only"
    return np.stack([vertices[c] for c in "xyz"], 1).astype(float), faces[faces.dtype.names[1]]


def measure(made, dims, spacing, vertices, triangles):
    """Errors of a mesh against the body it stands for."""
    corners = vertices[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    total = area.sum()
    of_vertex = made.distance_and_normal(vertices)[0]
    of_middle, true_normal = made.distance_and_normal(corners.mean(1))
    # Exact where the distance varies linearly over the triangle.
    squared = (of_vertex[triangles] ** 2).sum(1) / 12 + 0.75 * of_middle**2
    wide = area > 1e-9
    angle = np.arctan2(
        np.linalg.norm(np.cross(cross[wide], true_normal[wide]), axis=1),
        (cross[wide] * true_normal[wide]).sum(1),
    )
    volume = (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    return {
        "vertices": len(vertices),
        "triangles": len(triangles),
        "distance": np.sqrt((squared * area).sum() / total),
        "normal": np.degrees(np.sqrt((angle**2 * area[wide]).sum() / area[wide].sum())),
        "volume": 100 * (volume / made.volume - 1),
        "area": 100 * (total / made.area - 1),
        "p5 angle": np.percentile(smallest_angles(corners), 5),
        "wrong side": wrong_side(
            np.diag([*spacing, 1.0]), vertices, triangles, occupancy(made, dims, spacing)
        ),
    }


def smallest_angles(corners):
    """Smallest angle of each triangle, in degrees."""
    angles = []
    for a in range(3):
        u = corners[:, (a + 1) % 3] - corners[:, a]
        v = corners[:, (a + 2) % 3] - corners[:, a]
        angles.append(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(1)))
    return np.degrees(np.min(angles, 0))


# A process of its own: the peak of a child is never less than its parent's memory at the start.
LAUNCHER = """
import resource, subprocess, sys, time
start = time.perf_counter()
done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL)
print(time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(done.returncode)
"""


def run(command):
    """Seconds and peak megabytes of a command, measured from outside."""
    launched = [sys.executable, "-c", LAUNCHER, *map(str, command)]
    done = subprocess.run(launched, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"failed: {' '.join(launched[3:])}")
    seconds, peak = map(float, done.stdout.split())
    return seconds, peak / (1024**2 if sys.platform == "darwin" else 1024)


def bench(program, folder, surface):
    """Shrouds every volume on one thread and yields its row."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in VOLUMES:
        made, dims, spacing = body(name)
        volume, mesh = folder / f"{name}.npy", folder / f"{name}-{surface}.ply"
        np.save(volume, occupancy(made, dims, spacing).transpose(2, 1, 0).astype("u1", order="C"))
        command = [program, "mesh", volume, "-o", mesh, "--surface", surface, "--json", "--quiet"]
        command += ["--spacing", ",".join(map(str, spacing)), "--threads", "1"]
        seconds, megabytes = run(command)
        row = measure(made, dims, spacing, *read_ply(mesh))
        yield {"name": name, **row, "seconds": seconds, "memory": megabytes}


COLUMNS = {
    "name": ("volume", "{}"),
    "vertices": ("vertices", "{}"),
    "triangles": ("triangles", "{}"),
    "distance": ("distance RMS, voxels", "{:.4f}"),
    "normal": ("normal RMS, °", "{:.2f}"),
    "volume": ("volume error, %", "{:+.2f}"),
    "area": ("area error, %", "{:+.2f}"),
    "p5 angle": ("5th percentile angle, °", "{:.1f}"),
    "wrong side": ("wrong-side points", "{}"),
    "seconds": ("seconds", "{:.2f}"),
    "memory": ("peak MB", "{:.0f}"),
}


def print_table(rows):
    """Prints rows as they come."""
    print("| " + " | ".join(title for title, _ in COLUMNS.values()) + " |")
    print("|" + "---|" + "---:|" * (len(COLUMNS) - 1))
    for row in rows:
        cells = (form.format(row[key]) for key, (_, form) in COLUMNS.items())
        print("| " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=Path, help="the program to run")
    parser.add_argument("--folder", type=Path, help="where volumes and meshes go")
    parser.add_argument("--mesh", help="a finished mesh to judge instead")
    parser.add_argument("--volume", help="the volume it stands for, such as tori24")
    arguments = parser.parse_args()
    if arguments.mesh and arguments.volume:
        for key, value in measure(*body(arguments.volume), *read_ply(arguments.mesh)).items():
            print(f"{key:12} {value}")
    elif arguments.program and arguments.folder:
        for surface in ("primal", "dual"):
            print(f"\n`--surface {surface}`, one thread:\n")
            print_table(bench(arguments.program.resolve(), arguments.folder, surface))
    else:
        parser.error("give --program and --folder, or --mesh and --volume")


if __name__ == "__main__":
    main()
