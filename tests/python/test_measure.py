"""Measurements and contours are those of trimesh, scipy and VTK."""

import csv
import json

import numpy as np
import pytest
import scipy.ndimage
import trimesh
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

from conftest import load
from judge import sample_volume


def solid(kind):
    """A volume indexed x, y, z."""
    if kind == "sample":
        return sample_volume().astype(bool)
    points = np.stack(np.meshgrid(*[np.arange(30)] * 3, indexing="ij"), axis=-1) - 14.3
    x, y, z = np.moveaxis(points, -1, 0)
    if kind == "ellipsoid":
        return (x / 12) ** 2 + (y / 9) ** 2 + (z / 6) ** 2 <= 1
    return (np.hypot(x, z) - 9) ** 2 + y**2 <= 16


@pytest.fixture(params=["ellipsoid", "torus", "sample"])
def volume(request, tmp_path):
    path = tmp_path / "volume.npy"
    np.save(path, solid(request.param).transpose(2, 1, 0).astype(np.uint8, order="C"))
    return path


@pytest.fixture
def measured(shrouds):
    def run(*arguments):
        return json.loads(shrouds("measure", *arguments, "--json", "--quiet"))

    return run


def polydata(mesh):
    """The mesh as VTK has it."""
    data, cells, points = vtk.vtkPolyData(), vtk.vtkCellArray(), vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.array(mesh.vertices), deep=True))
    corners = numpy_to_vtkIdTypeArray(np.array(mesh.faces).ravel().astype(np.int64), deep=True)
    firsts = numpy_to_vtkIdTypeArray(np.arange(len(mesh.faces) + 1) * 3, deep=True)
    cells.SetData(firsts, corners)
    data.SetPoints(points)
    data.SetPolys(cells)
    return data


def test_a_mesh_measures_what_trimesh_and_vtk_measure(mesh_of, measured, volume, tmp_path):
    mesh = mesh_of(volume)
    (row,) = measured(tmp_path / "out.ply")["rows"]
    assert row["triangle_area"] == pytest.approx(mesh.area, rel=1e-9)
    assert row["triangle_volume"] == pytest.approx(mesh.volume, rel=1e-9)
    assert row["centroid"] == pytest.approx(mesh.center_mass, abs=1e-6)
    assert row["euler"] == mesh.euler_number
    assert row["surfaces"] == mesh.body_count
    assert [row["box_low"], row["box_high"]] == pytest.approx(mesh.bounds, abs=1e-9)

    properties = vtk.vtkMassProperties()
    properties.SetInputData(polydata(mesh))
    assert row["triangle_area"] == pytest.approx(properties.GetSurfaceArea(), rel=1e-6)
    assert row["triangle_volume"] == pytest.approx(properties.GetVolume(), rel=1e-3)


def test_principal_axes_are_those_of_the_inertia(mesh_of, measured, volume, tmp_path):
    mesh = mesh_of(volume)
    (row,) = measured(tmp_path / "out.ply")["rows"]
    # Moments of inertia of an ellipsoid with half axes a, b, c: m (b² + c²) / 5 …
    half = np.array(row["axis_lengths"]) / 2
    squares = half**2
    inertia = mesh.volume / 5 * (squares.sum() - squares)
    assert np.sort(inertia) == pytest.approx(np.sort(np.linalg.eigvalsh(mesh.moment_inertia)), rel=1e-6)
    axes = np.array([row["axis_1"], row["axis_2"], row["axis_3"]])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1)
    for axis, moment in zip(axes, inertia):
        assert axis @ mesh.moment_inertia @ axis == pytest.approx(moment, rel=1e-6)


def test_voxels_and_components_are_those_of_scipy(measured, volume):
    values = np.load(volume).transpose(2, 1, 0)
    numbers, count = scipy.ndimage.label(values)
    rows = measured(volume, "--components")["rows"]
    assert len(rows) == count
    expected = np.bincount(numbers.ravel())[1:]
    assert sorted(row["voxels"] for row in rows) == sorted(expected)
    (whole,) = measured(volume)["rows"]
    assert whole["voxels"] == values.sum() == whole["voxel_volume"]
    holes = scipy.ndimage.label(np.pad(values == 0, 1, constant_values=True), np.ones((3, 3, 3)))[1] - 1
    assert sum(row["cavities"] for row in rows) <= whole["surfaces"] - count
    if holes == 0:
        assert whole["cavities"] == 0


def test_columns_of_all_labels(measured, shrouds, tmp_path):
    values = np.zeros((24, 24, 24), np.uint8)
    values[4:14, 4:20, 4:20] = 3
    values[14:20, 4:20, 4:20] = 5
    path, table = tmp_path / "labels.npy", tmp_path / "table.csv"
    np.save(path, values)
    report = measured(path, "--labels", "all", "--contacts", "--csv", table)
    assert [row["label"] for row in report["rows"]] == [3, 5]
    for row, label in zip(report["rows"], [3, 5]):
        assert row["voxels"] == (values == label).sum()
        low, high = row["volume_low"], row["volume_high"]
        assert low < row["voxels"] < high
    (contact,) = report["contacts"]
    # A face of 16 × 16 voxels whose corners are rounded.
    assert contact["area"] == pytest.approx(256, rel=0.05)
    with open(table, newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert [line["label"] for line in lines] == ["3", "5"]
    for line, row in zip(lines, report["rows"]):
        assert float(line["area [voxel²]"]) == row["area"]
        assert float(line["axis_1_z"]) == row["axis_1"][2]
    assert report["units"]["surface_to_volume"] == "1/voxel"
    assert "contact of" in shrouds("measure", path, "--labels", "all", "--contacts")


def test_distances_are_those_of_vtk(mesh_of, measured, volume, tmp_path):
    mesh = mesh_of(volume)
    moved = mesh.copy()
    moved.apply_transform(trimesh.transformations.rotation_matrix(0.1, [1, 2, 3], mesh.centroid))
    moved.export(tmp_path / "moved.ply")
    (row,) = measured(tmp_path / "out.ply", "--distance-to", tmp_path / "moved.ply")["rows"]
    for key, one, other in (("forth", mesh, moved), ("back", moved, mesh)):
        locator = vtk.vtkImplicitPolyDataDistance()
        locator.SetInput(polydata(other))
        at = lambda points: np.abs([locator.EvaluateFunction(point) for point in points])
        corners, middles = at(one.vertices), at(one.triangles_center)
        largest = row[f"distance_{key}_maximum"]
        assert corners.max() - 1e-5 <= largest <= 1.1 * corners.max() + 0.05
        # Exact for functions that are quadratic on each triangle.
        means = (corners[one.faces].sum(axis=1) + 9 * middles) / 12
        expected = np.average(means, weights=one.area_faces)
        assert row[f"distance_{key}_mean"] == pytest.approx(expected, rel=0.02)
    assert row["distance_maximum"] == max(
        row["distance_forth_maximum"], row["distance_back_maximum"]
    )


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_contours_are_the_sections_of_trimesh(mesh_of, shrouds, volume, tmp_path, axis):
    mesh = mesh_of(volume)
    number = "xyz".index(axis)
    low, high = mesh.bounds[:, number]
    positions = low + (high - low) * np.array([0.2137, 0.4871, 0.7713])
    at = ",".join(map(repr, positions.tolist()))
    report = json.loads(
        shrouds("contours", tmp_path / "out.ply", "--axis", axis, "--at", at, "-o",
                tmp_path / "c.vtp", "--json", "--quiet")
    )
    assert report["totals"]["open"] == 0
    for position in positions:
        normal, origin = np.eye(3)[number], np.eye(3)[number] * position
        lines = trimesh.intersections.mesh_plane(mesh, normal, origin)
        ours = [c for c in report["contours"] if c["position"] == pytest.approx(position)]
        length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum()
        assert sum(c["length"] for c in ours) == pytest.approx(length, rel=1e-6)
        section = mesh.section(plane_normal=normal, plane_origin=origin)
        loops = [np.delete(np.asarray(loop), number, axis=1) for loop in section.discrete]
        assert len(ours) == len(loops)
        assert all(c["closed"] for c in ours)
        areas = [abs(shoelace(loop)) for loop in loops]
        assert sorted(abs(c["area"]) for c in ours) == pytest.approx(sorted(areas), rel=1e-5)


def shoelace(loop):
    """The area within a closed line in the plane."""
    x, y = loop.T
    return 0.5 * (x[:-1] @ y[1:] - x[1:] @ y[:-1])


def test_open_meshes_have_areas_only(mesh_of, measured, volume, tmp_path):
    mesh = mesh_of(volume)
    mesh.update_faces(np.arange(len(mesh.faces)) > 10)
    mesh.export(tmp_path / "open.ply")
    (row,) = measured(tmp_path / "open.ply")["rows"]
    assert row["triangle_area"] == pytest.approx(load(tmp_path / "open.ply").area, rel=1e-9)
    assert row["volume"] is None and row["notes"]
