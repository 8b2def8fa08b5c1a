"""Volumes of many labels by `shrouds mesh --materials` and by vtkSurfaceNets3D, judged alike.

    python tests/python/materials_peers.py VOLUME ...

needs numpy, nibabel and vtk; the environment variable SHROUDS_BIN names the program. Prints a row of
Markdown for each volume and tool: triangles, lattice points that are not inside their own label (the
background is a label), edges of label boundaries with an odd number of triangles, and seconds of CPU.
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
    """Lattice points around which the boundary of their own label passes an even number of times along
    x; for the background, an odd number."""
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
    return int((odd == (labels.ravel() == 0)).sum())


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


def main():
    print("| volume | tool | triangles | wrong-label points | % | open edges | CPU s |")
    print("|---|---|---|---|---|---|---|")
    for path in map(Path, sys.argv[1:]):
        labels = load(path)
        rows = {"vtkSurfaceNets3D": surface_nets(labels)}
        for preset in ("default",):
            *mesh, seconds, report = shrouds(path, labels.shape, preset)
            rows[f"shrouds, {preset}"] = (*mesh, seconds)
            print(json.dumps(report["checks"]), json.dumps(report["times"]), report["topology"], file=sys.stderr)
        for tool, (points, triangles, pairs, seconds) in rows.items():
            wrong = wrong_points(labels, points, triangles, pairs)
            print(
                f"| {path.name} | {tool} | {len(triangles)} | {wrong} | {100 * wrong / labels.size:.3f} "
                f"| {open_edges(triangles, pairs)} | {seconds:.1f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
