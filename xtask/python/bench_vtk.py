"""The peer of `cargo xtask bench`: VTK at its defaults, on one thread.

    python bench_vtk.py VOLUME.npy SX,SY,SZ

Answers each line on standard input with a line of JSON, as crates/shrouds-cli/examples/bench_worker.rs
does: `nets` (vtkSurfaceNets3D), `flying` (vtkFlyingEdges3D), `discrete` (vtkDiscreteFlyingEdges3D)
and `save PATH.npz`, which writes the mesh of the last `nets`.
"""

import json
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkSurfaceNets3D
from vtkmodules.vtkFiltersGeneral import vtkDiscreteFlyingEdges3D


def nets(image):
    """Surface nets and sixteen smoothing sweeps within VTK's own constraint."""
    work = vtkSurfaceNets3D()
    work.SetInputData(image)
    work.SetValue(0, 1)
    work.SetOutputMeshTypeToTriangles()
    return work


def flying(image):
    """Marching cubes at one half, without normals, which the midpoint surface has not either."""
    work = vtkFlyingEdges3D()
    work.SetInputData(image)
    work.SetValue(0, 0.5)
    return bare(work)


def discrete(image):
    """Marching cubes of the label."""
    work = vtkDiscreteFlyingEdges3D()
    work.SetInputData(image)
    work.SetValue(0, 1)
    return bare(work)


def bare(work):
    work.ComputeNormalsOff()
    work.ComputeGradientsOff()
    work.ComputeScalarsOff()
    return work


WORK = {"nets": nets, "flying": flying, "discrete": discrete}


def image_of(values, spacing):
    """An image over the memory of `values`, which the caller keeps."""
    image = vtkImageData()
    image.SetDimensions(*values.shape[::-1])
    image.SetSpacing(*spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel()))
    return image


def measured(work):
    """The mesh, and what making it took."""
    held = watch_memory()
    cpu, wall = time.process_time(), time.perf_counter()
    work.Update()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    peak, mesh = kilobytes("VmHWM:"), work.GetOutput()
    return mesh, {
        "cpu": cpu,
        "wall": wall,
        "memory": None if held is None else (peak - held) / 1024,
        "vertices": mesh.GetNumberOfPoints(),
        "triangles": mesh.GetNumberOfPolys(),
    }


def watch_memory():
    """Kilobytes held now, from where on the peak is watched; only Linux tells."""
    try:
        with open("/proc/self/clear_refs", "w") as file:
            file.write("5")
    except OSError:
        return None
    return kilobytes("VmRSS:")


def kilobytes(key):
    try:
        with open("/proc/self/status") as file:
            return next(int(line.split()[1]) for line in file if line.startswith(key))
    except OSError:
        return None


def save(mesh, path):
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    np.savez(path, vertices=vtk_to_numpy(mesh.GetPoints().GetData()), triangles=triangles)
    return {"saved": path}


def main(volume, spacing):
    vtkSMPTools.SetBackend("Sequential")
    values = np.ascontiguousarray(np.load(volume))
    image = image_of(values, [float(s) for s in spacing.split(",")])
    nets_mesh = mesh = None
    for line in sys.stdin:
        command, _, path = line.strip().partition(" ")
        if command == "save":
            answer = save(nets_mesh, path)
        else:
            nets_mesh = mesh = None  # freed before, not while, the clock runs
            mesh, answer = measured(WORK[command](image))
            nets_mesh = mesh if command == "nets" else None
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
