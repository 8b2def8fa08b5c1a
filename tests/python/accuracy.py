"""How close the program's surfaces come to bodies whose true surface is known.

    python accuracy.py --program target/release/shrouds --folder target/bench
    python accuracy.py --mesh MESH.ply --volume tori24

The first form makes the volumes, shrouds them and prints a Markdown table; the second judges one
mesh, of any program. Lengths are in world units; the smallest spacing is 1, so they are voxels.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from judge import windings, wrong_side

VOLUMES = ["tori24", "sphere32", "sphere128", "tori128", "tori128_1x1x3"]
PRESETS = ["default", "exact"]
# Vertices or triangles that are judged at a time: bounds the memory.
BLOCK = 1 << 19


class Body:
    """A body whose surface is known."""

    area = volume = float("nan")

    def contains(self, points):
        """Which points lie in the body, its surface included."""
        return self.distance_and_normal(points)[0] <= 0

    def judged(self, points):
        """Which points lie where `distance_and_normal` holds."""
        return np.ones(len(points), bool)


class Ball(Body):
    def __init__(self, centre, radius):
        self.centre, self.radius = centre, radius
        self.area = 4 * np.pi * radius**2
        self.volume = self.area * radius / 3

    def distance_and_normal(self, points):
        """Signed distance (negative inside) and the true surface's normal nearest to each point."""
        away = points - self.centre
        length = np.linalg.norm(away, axis=-1)
        return length - self.radius, away / length[:, None]


class LinkedTori(Body):
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


class GyroidBall(Body):
    """A ball less its points where sin x cos y + sin y cos z + sin z cos x < 0."""

    def __init__(self, centre, radius, period):
        self.centre, self.radius, self.frequency = centre, radius, 2 * np.pi / period

    def contains(self, points):
        near = np.linalg.norm(points - self.centre, axis=-1) <= self.radius
        near[near] = self._level(points[near])[0] >= 0
        return near

    def judged(self, points):
        """Away from the crease where the gyroid ends at the ball."""
        return np.linalg.norm(points - self.centre, axis=-1) < self.radius - 3

    def distance_and_normal(self, points):
        """Distance and normal at the foot of each point on the gyroid; the ball does not count.

        Newton steps lead onto the level set, steps within it to where its gradient looks at the
        point; the error shrinks at each by the distance in radii of curvature.
        """
        foot = points.astype(float)
        for _ in range(4):
            level, gradient = self._level(foot)
            squared = (gradient**2).sum(-1)
            foot -= (level / squared)[:, None] * gradient
            away = points - foot
            foot += away - ((away * gradient).sum(-1) / squared)[:, None] * gradient
        level, gradient = self._level(foot)
        normal = -gradient / np.linalg.norm(gradient, axis=-1)[:, None]
        foot += (level / (gradient**2).sum(-1))[:, None] * -gradient
        return ((points - foot) * normal).sum(-1), normal

    def _level(self, points):
        angles = (points - self.centre) * self.frequency
        (a, b, c), (u, v, w) = np.sin(angles).T, np.cos(angles).T
        gradient = np.stack([u * v - c * a, v * w - a * b, w * u - b * c], -1)
        return a * v + b * w + c * u, self.frequency * gradient


def body(name):
    """The body, the lattice points along x, y, z and the spacing of a volume such as `tori24`."""
    pattern = r"(sphere|tori|gyroid)(\d+)(?:_1x1x(\d+))?(?:_period(\d+))?"
    shape, size, thick, period = re.fullmatch(pattern, name).groups()
    n, spacing = int(size), np.array([1, 1, int(thick or 1)])
    # Off every symmetry of the lattice; the same places as the phantoms of the library.
    centre = (n - 1) / 2 + np.array([0.137, 0.071, -0.093])
    if shape == "sphere":
        made = Ball(centre, 0.4 * n)
    elif shape == "gyroid":
        made = GyroidBall(centre, 0.46 * n, float(period or n / 8))
    else:
        ring = np.array([0.23 * n, 0, 0])
        first = centre - ring / 2
        made = LinkedTori([first, first + ring], 0.23 * n, 0.078 * n)
    return made, -(-n // spacing), spacing


def occupancy(made, dims, spacing):
    """Which lattice points [i, j, k] lie in the body."""
    inside = np.empty(dims, bool)
    plane = np.indices((1, *dims[1:])).reshape(3, -1).T * spacing.astype(float)
    for i in range(dims[0]):
        plane[:, 0] = i * spacing[0]
        inside[i] = made.contains(plane).reshape(dims[1:])
    return inside


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
    inside, affine = occupancy(made, dims, spacing), np.diag([*spacing, 1.0])
    return {
        "vertices": len(vertices),
        "triangles": len(triangles),
        **errors(made, vertices, triangles),
        "wrong side": wrong_side(affine, vertices, triangles, inside),
    }


def errors(made, vertices, triangles):
    """Distance, direction, volume, area and smallest angles of a mesh against its body."""
    corner = np.empty(len(vertices))
    for block in blocks(len(vertices)):
        judged = made.judged(vertices[block])
        corner[block] = np.where(judged, made.distance_and_normal(vertices[block])[0], np.nan)
    parts = [
        _errors_of(made, vertices[triangles[block]], corner[triangles[block]])
        for block in blocks(len(triangles))
    ]
    total = {key: sum(part[key] for part in parts) for key in parts[0] if key != "angles"}
    return {
        "distance": np.sqrt(total["squared distance"] / total["judged area"]),
        "normal": np.degrees(np.sqrt(total["squared angle"] / total["judged area"])),
        "volume": 100 * (total["volume"] / made.volume - 1),
        "area": 100 * (total["area"] / made.area - 1),
        "p5 angle": np.percentile(np.concatenate([part["angles"] for part in parts]), 5),
    }


def blocks(count):
    """Slices of at most `BLOCK` that cover `count` entries; one where there is nothing."""
    return [slice(start, start + BLOCK) for start in range(0, max(count, 1), BLOCK)]


def _errors_of(made, corners, of_corner):
    """What triangles add to each integral, squares times area.

    They are given by their corners and the distances of those, NaN where they are not judged.
    """
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    middle = corners.mean(1)
    judged = made.judged(middle) & np.isfinite(of_corner).all(1)
    of_middle, true_normal = made.distance_and_normal(middle[judged])
    # Exact where the distance varies linearly over the triangle.
    squared = (of_corner[judged] ** 2).sum(1) / 12 + 0.75 * of_middle**2
    away = np.linalg.norm(np.cross(cross[judged], true_normal), axis=1)
    angle = np.arctan2(away, (cross[judged] * true_normal).sum(1))
    return {
        "area": area.sum(),
        "judged area": area[judged].sum(),
        "squared distance": (squared * area[judged]).sum(),
        "squared angle": (angle**2 * area[judged]).sum(),
        "volume": (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6,
        "angles": smallest_angles(corners),
    }


def wrong_by_majority(spacing, vertices, triangles, inside):
    """Lattice points on the wrong side, as most of the lines along x, y and z tell.

    On a closed mesh the three agree; a line through a crack is wrong from there on. A mesh that is
    right along all lines in x is not looked at again.
    """
    points, wrong = vertices / spacing, np.zeros(inside.shape, np.uint8)
    for turn in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
        turned = inside.transpose(turn)
        wrong.transpose(turn)[:] += windings(points[:, turn], triangles, turned.shape) != turned
        if not wrong.any():
            return 0
    return int((wrong >= 2).sum())


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


def bench(program, folder, surface, names=VOLUMES, presets=PRESETS):
    """Shrouds volumes on one thread and yields a row for each and every preset."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        made, dims, spacing = body(name)
        volume, mesh = folder / f"{name}.npy", folder / f"{name}-{surface}.ply"
        np.save(volume, occupancy(made, dims, spacing).transpose(2, 1, 0).astype("u1", order="C"))
        for preset in presets:
            command = [program, "mesh", volume, "-o", mesh, "--surface", surface]
            command += ["--preset", preset, "--spacing", ",".join(map(str, spacing))]
            seconds, megabytes = run([*command, "--threads", "1", "--json", "--quiet"])
            row = measure(made, dims, spacing, *read_ply(mesh))
            costs = {"seconds": seconds, "memory": megabytes}
            yield {"name": name, "preset": preset, **row, **costs}


COLUMNS = {
    "name": ("volume", "{}"),
    "preset": ("preset", "{}"),
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


def table(columns, rows):
    """Lines of a Markdown table; what is not known is a dash."""
    yield "| " + " | ".join(title for title, _ in columns.values()) + " |"
    yield "|" + "---|" + "---:|" * (len(columns) - 1)
    for row in rows:
        known = {key: value for key, value in row.items() if value is not None and value == value}
        cells = (
            form.format(known[key]) if key in known else "–" for key, (_, form) in columns.items()
        )
        yield "| " + " | ".join(cells) + " |"


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
            rows = bench(arguments.program.resolve(), arguments.folder, surface)
            for line in table(COLUMNS, rows):
                print(line, flush=True)
    else:
        parser.error("give --program and --folder, or --mesh and --volume")


if __name__ == "__main__":
    main()
