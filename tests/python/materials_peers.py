"""Volumes of many labels by `shrouds mesh --materials` and by vtkSurfaceNets3D, judged alike.

    python tests/python/materials_peers.py VOLUME ... [--picture PNG]

needs numpy, nibabel and vtk; the environment variable SHROUDS_BIN names the program. Prints a row of
Markdown for each volume and tool: triangles, lattice points that are not inside their own label (the
background is a label), edges of label boundaries with an odd number of triangles, and seconds of CPU.
The picture, which needs matplotlib, shows both tools side by side where most labels of the last volume meet
in a slice.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def load(path):
    """The labels, indexed [x, y, z]."""
    if path.name.endswith((".nii", ".nii.gz")):
        import nibabel

        return np.asarray(nibabel.load(path).dataobj).astype(np.int32)
    if path.suffix == ".vti":
        reader = vtk.vtkXMLImageDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        image = reader.GetOutput()
        values = vtk_to_numpy(image.GetPointData().GetScalars())
        return values.reshape(image.GetDimensions(), order="F").astype(np.int32)
    values = np.load(path)
    return values.reshape([n for n in values.shape if n > 1][:3]).transpose(2, 1, 0).astype(np.int32)


def surface_nets(labels):
    """Points in index coordinates, triangles and pairs of labels of vtkSurfaceNets3D; CPU seconds."""
    vtk.vtkSMPTools.SetBackend("Sequential")
    padded = np.pad(labels, 1)
    image = vtk.vtkImageData()
    image.SetDimensions(padded.shape)
    image.SetOrigin(-1, -1, -1)
    image.GetPointData().SetScalars(numpy_to_vtk(padded.ravel(order="F"), deep=True))
    nets = vtk.vtkSurfaceNets3D()
    nets.SetInputData(image)
    for n, label in enumerate(np.unique(labels[labels != 0])):
        nets.SetValue(n, float(label))
    nets.SetOutputMeshTypeToTriangles()
    start = time.process_time()
    nets.Update()
    seconds = time.process_time() - start
    return *arrays(nets.GetOutput(), "BoundaryLabels"), seconds


def shrouds(path, shape, preset):
    """The same of `shrouds mesh --materials`, and its report."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "all.vtp"
        call = [os.environ.get("SHROUDS_BIN", "shrouds"), "mesh", str(path), "--materials", "--quiet"]
        call += ["--preset", preset, "--threads", "1", "--json", "--frame", "index", "-o", str(out)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        report = json.loads(subprocess.run(call, check=True, capture_output=True).stdout)
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        times = report["times"]
        work = times["surface"] + times["optimize"] + times["mesh"]
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(out))
        reader.Update()
        # The share of the work in all CPU seconds: the machine may be busy.
        return *arrays(reader.GetOutput(), "labels"), cpu * work / times["total"], report


def arrays(mesh, name):
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    pairs = vtk_to_numpy(mesh.GetCellData().GetArray(name))[-len(triangles) :].astype(int)
    return points, triangles, pairs


def wrong_points(labels, points, triangles, pairs):
    """At which lattice points the boundary of their own label has passed an even number of times along x;
    for the background, an odd number."""
    events = []
    corners = points[triangles] + np.array([0, 1.3e-7, 2.1e-7])
    low = np.ceil(corners[:, :, 1:].min(axis=1)).astype(int)
    high = np.floor(corners[:, :, 1:].max(axis=1)).astype(int)
    for dy in range(int((high - low)[:, 0].max()) + 1):
        for dz in range(int((high - low)[:, 1].max()) + 1):
            row = low + [dy, dz]
            near = np.flatnonzero((row <= high).all(axis=1))
            a, b, c = (corners[near, n] for n in range(3))
            at = row[near]

            def side(p, q):
                return (q[:, 1] - p[:, 1]) * (at[:, 1] - p[:, 2]) - (q[:, 2] - p[:, 2]) * (at[:, 0] - p[:, 1])

            weights = np.stack([side(b, c), side(c, a), side(a, b)], axis=1)
            hit = (weights > 0).all(axis=1) | (weights < 0).all(axis=1)
            weights = weights[hit] / weights[hit].sum(axis=1, keepdims=True)
            x = (weights * np.stack([a[hit, 0], b[hit, 0], c[hit, 0]], axis=1)).sum(axis=1)
            for side_label in (0, 1):
                events.append(np.column_stack([pairs[near[hit], side_label], at[hit], x]))
    events = np.concatenate(events)
    nx, ny, nz = labels.shape
    inside = (events[:, 1:3] >= 0).all(axis=1) & (events[:, 1] < ny) & (events[:, 2] < nz)
    events = events[inside]
    row_of = lambda label, y, z: (label.astype(np.int64) * ny + y.astype(np.int64)) * nz + z.astype(np.int64)
    keys = row_of(events[:, 0], events[:, 1], events[:, 2]) * float(4 * nx) + events[:, 3] + 2
    keys.sort()
    x, y, z = np.indices(labels.shape).reshape(3, -1)
    rows = row_of(labels.ravel(), y, z) * float(4 * nx)
    passed = np.searchsorted(keys, rows + x + 2) - np.searchsorted(keys, rows)
    odd = passed % 2 == 1
    return (odd == (labels.ravel() == 0)).reshape(labels.shape)


def open_edges(triangles, pairs):
    """Edges of the boundary of a label that have an odd number of its triangles."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides.sort(axis=1)
    count = 0
    for side_label in np.unique(pairs):
        own = np.tile((pairs == side_label).any(axis=1), 3)
        keys = sides[own, 0].astype(np.int64) << 32 | sides[own, 1]
        count += int((np.unique(keys, return_counts=True)[1] % 2).sum())
    return count


def where_labels_meet(labels, size):
    """The slice along z and the window in it, `size` points wide, in which most triples of labels meet."""
    best = (-1, None)
    for z in range(labels.shape[2]):
        plane = labels[:, :, z]
        corners = np.stack([plane[:-1, :-1], plane[1:, :-1], plane[1:, 1:], plane[:-1, 1:]])
        corners.sort(axis=0)
        meets = (corners[1:] != corners[:-1]).sum(axis=0) >= 2
        sums = np.pad(meets.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        counts = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
        if counts.size and counts.max() > best[0]:
            best = (counts.max(), (z, *np.unravel_index(counts.argmax(), counts.shape)))
    return best[1]


def cut(points, triangles, z):
    """The segments in which triangles pass a height that no point has."""
    corners = points[triangles]
    above = corners[:, :, 2] > z
    corners, above = corners[above.any(axis=1) & ~above.all(axis=1)], above[above.any(axis=1) & ~above.all(axis=1)]
    lone = above == (above.sum(axis=1) == 1)[:, None]
    rows, first = np.arange(len(corners)), lone.argmax(axis=1)
    apex = corners[rows, first]
    ends = []
    for n in (1, 2):
        other = corners[rows, (first + n) % 3]
        share = (z - apex[:, 2]) / (other[:, 2] - apex[:, 2])
        ends.append((apex + share[:, None] * (other - apex))[:, :2])
    return np.stack(ends, axis=1)


def draw(path, labels, meshes, size=26):
    """What both tools make of a piece of a slice; points in another label than their own are crossed."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import LineCollection

    z, x0, y0 = where_labels_meet(labels, size)
    x, y = np.mgrid[x0 : x0 + size, y0 : y0 + size]
    own = labels[x, y, z]
    colours = np.where(own > 0, np.unique(own, return_inverse=True)[1].reshape(own.shape) % 20, -1)
    figure, panels = pyplot.subplots(1, 2, figsize=(11, 5.6), dpi=100, layout="constrained")
    for panel, (tool, (points, triangles, pairs, _)) in zip(panels, meshes.items()):
        wrong = wrong_points(labels, points, triangles, pairs)[x, y, z]
        panel.scatter(x[own > 0], y[own > 0], c=colours[own > 0], cmap="tab20", vmin=0, vmax=19, s=14)
        panel.scatter(x[own == 0], y[own == 0], c="lightgrey", s=5)
        panel.scatter(x[wrong], y[wrong], c="red", marker="x", s=45)
        segments = cut(points, triangles, z + 1e-4)
        panel.add_collection(LineCollection(segments, colors="black", linewidths=1.1))
        panel.set(xlim=(x0 - 0.5, x0 + size - 0.5), ylim=(y0 - 0.5, y0 + size - 0.5), aspect="equal", xticks=[], yticks=[])
        panel.set_title(f"{tool}: {wrong.sum()} of {wrong.size} points in another label")
    figure.savefig(path)


def main():
    words = sys.argv[1:]
    picture = words.index("--picture") if "--picture" in words else len(words)
    print("| volume | tool | triangles | wrong-label points | % | open edges | CPU s |")
    print("|---|---|---|---|---|---|---|")
    for path in map(Path, words[:picture]):
        labels = load(path)
        rows = {"vtkSurfaceNets3D": surface_nets(labels)}
        for preset in ("default",):
            *mesh, seconds, report = shrouds(path, labels.shape, preset)
            rows[f"shrouds, {preset}"] = (*mesh, seconds)
            print(json.dumps(report["checks"]), json.dumps(report["times"]), report["topology"], file=sys.stderr)
        for tool, (points, triangles, pairs, seconds) in rows.items():
            wrong = int(wrong_points(labels, points, triangles, pairs).sum())
            print(
                f"| {path.name} | {tool} | {len(triangles)} | {wrong} | {100 * wrong / labels.size:.3f} "
                f"| {open_edges(triangles, pairs)} | {seconds:.2f} |",
                flush=True,
            )
    for name in words[picture + 1 :]:
        draw(name, labels, rows)


if __name__ == "__main__":
    main()
