"""Certificates say what hashlib, winding numbers and VTK say of the same files."""

import hashlib
import json

import numpy as np
import pytest
import trimesh
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

from conftest import load
from judge import sample_volume, to_index, windings

AFFINE = np.array(
    [[-0.8, 0.1, 0.0, 20.0], [0.1, 1.2, -0.2, -7.0], [0.0, 0.2, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0]]
)


@pytest.fixture
def volume(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    path = tmp_path / "volume.nii"
    nibabel.save(nibabel.Nifti1Image(sample_volume().astype(np.uint8), AFFINE), path)
    return path


def certificate_of(program, mesh, volume, path):
    """The certificate of any mesh, good or bad."""
    import subprocess

    call = [program, "check", mesh, "--volume", volume, "--certificate", path, "--quiet"]
    subprocess.run(list(map(str, call)), capture_output=True, timeout=120)
    return json.loads(path.read_text())


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def index_mesh(mesh):
    """Vertices in units of the index and triangles that face outside there."""
    triangles = np.asarray(mesh.faces)
    if np.linalg.det(AFFINE[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    return to_index(AFFINE, np.asarray(mesh.vertices)), triangles


def distances(points, triangles, queries):
    """Distance of each query from the mesh, by VTK."""
    data = vtk.vtkPolyData()
    corners = vtk.vtkPoints()
    corners.SetData(numpy_to_vtk(np.ascontiguousarray(points, np.float64), deep=True))
    data.SetPoints(corners)
    cells = vtk.vtkCellArray()
    counted = np.insert(triangles.astype(np.int64), 0, 3, axis=1).ravel()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(counted, deep=True))
    data.SetPolys(cells)
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(data)
    locator.BuildLocator()
    place, cell, part, squared = [0.0] * 3, vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
    found = []
    for query in queries:
        locator.FindClosestPoint(query, place, cell, part, squared)
        found.append(float(squared) ** 0.5)
    return np.array(found)


def test_hashes_are_those_of_the_files(shrouds, program, volume, tmp_path):
    mesh = tmp_path / "mesh.ply"
    shrouds("mesh", volume, "-o", mesh, "--quiet")
    certificate = certificate_of(program, mesh, volume, tmp_path / "c.json")
    assert certificate["holds"]
    assert certificate["mesh"]["sha256"] == sha256(mesh.read_bytes())
    assert certificate["volume"]["sha256"] == sha256(volume.read_bytes())
    assert np.allclose(certificate["volume"]["affine"], AFFINE[:3], atol=1e-6)
    shrouds("check", tmp_path / "c.json")


def test_a_header_and_its_data_have_the_hash_of_their_list(shrouds, program, tmp_path):
    simpleitk = pytest.importorskip("SimpleITK")
    image = simpleitk.GetImageFromArray(sample_volume().transpose(2, 1, 0).astype(np.uint8))
    volume, mesh = tmp_path / "volume.mhd", tmp_path / "mesh.ply"
    simpleitk.WriteImage(image, str(volume))
    shrouds("mesh", volume, "-o", mesh, "--quiet")
    certificate = certificate_of(program, mesh, volume, tmp_path / "c.json")
    files = sorted(path for path in tmp_path.iterdir() if path.stem == "volume")
    assert certificate["volume"]["files"] == len(files) == 2
    lines = "".join(f"{sha256(path.read_bytes())}  {path.name}\n" for path in files)
    assert certificate["volume"]["sha256"] == sha256(lines.encode())


@pytest.mark.parametrize("shift", [0.0, 0.45, 1.3])
def test_wrong_points_and_the_margin(shrouds, program, volume, tmp_path, shift):
    good, bad = tmp_path / "good.ply", tmp_path / "bad.ply"
    shrouds("mesh", volume, "-o", good, "--quiet", "--preset", "fast")
    mesh = load(good)
    mesh.vertices[:, 1] += shift
    trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(bad)
    certificate = certificate_of(program, bad, volume, tmp_path / "c.json")
    points, triangles = index_mesh(load(bad))
    inside = sample_volume()
    wrong = (windings(points, triangles, inside.shape) > 0) != inside
    separation = certificate["properties"]["separation"]
    assert separation["tested"] == inside.size
    assert separation["wrong"] == wrong.sum()
    assert (separation["wrong"] > 0) == (shift > 0.4)
    assert certificate["holds"] == (shift == 0.0)
    # In the order of the volume's array, x fastest.
    first = np.argwhere(wrong.transpose(2, 1, 0))[:8, ::-1]
    assert [place["of"] for place in separation["first"]] == first.tolist()
    queries = np.argwhere(np.ones_like(inside)).astype(float)
    nearest = distances(points, triangles, queries)
    assert abs(separation["nearest"]["distance"] - nearest.min()) < 1e-6
    at = nearest[np.ravel_multi_index(separation["nearest"]["index"], inside.shape)]
    assert at < nearest.min() + 1e-6
