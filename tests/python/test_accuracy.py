"""The measures behind `cargo xtask bench`."""

import numpy as np
import pytest
import trimesh

from accuracy import (
    Ball,
    GyroidBall,
    bench,
    body,
    errors,
    measure,
    occupancy,
    read_ply,
    table,
    wrong_by_majority,
)
from judge import wrong_side

# The most that the distance, in voxels, and the angle of the normals, in degrees, may be off by.
LIMITS = {
    "default": {
        "tori24": (0.18, 9.5),
        "sphere128": (0.024, 0.62),
        "tori128": (0.036, 1.30),
        "tori128_1x1x3": (0.115, 3.0),
    },
    "exact": {
        "tori24": (0.14, 7.8),
        "sphere32": (0.023, 1.08),
        "sphere128": (0.0152, 0.47),
        "tori128": (0.024, 1.06),
        "tori128_1x1x3": (0.055, 1.85),
    },
}


@pytest.mark.parametrize(
    "preset, name", [(preset, name) for preset, limits in LIMITS.items() for name in limits]
)
def test_surfaces_are_as_close_to_the_truth_as_promised(program, tmp_path, preset, name):
    [row] = bench(program, tmp_path, "primal", [name], [preset])
    distance, normal = LIMITS[preset][name]
    assert row["distance"] < distance and row["normal"] < normal and row["wrong side"] == 0


@pytest.mark.parametrize(
    "name, points",
    # The library's phantoms have the same counts (crates/shrouds/src/volume/phantom/mod.rs).
    [("tori24", 799), ("sphere32", 8783), ("tori128_1x1x3", 39073), ("gyroid128", 427151)],
)
def test_volumes_are_the_phantoms_of_the_library(name, points):
    assert occupancy(*body(name)).sum() == points


def test_a_ball_that_is_a_tenth_too_large():
    made, dims, spacing = body("sphere32")
    sphere = trimesh.creation.icosphere(subdivisions=6, radius=made.radius + 0.1)
    row = measure(made, dims, spacing, sphere.vertices + made.centre, sphere.faces)
    grown = 1 + 0.1 / made.radius
    assert row["distance"] == pytest.approx(0.1, abs=0.003)
    assert row["normal"] < 1
    assert row["volume"] == pytest.approx(100 * (grown**3 - 1), abs=0.05)
    assert row["area"] == pytest.approx(100 * (grown**2 - 1), abs=0.05)


def test_the_distance_is_integrated_over_the_triangle():
    """A slanted triangle over a nearly flat surface: the integral against a million samples."""
    made = Ball(np.array([0.0, 0.0, -1000.0]), 1000.0)
    corners = np.array([[1.0, 0, 0.5], [-0.5, 0.8, -0.2], [-0.5, -0.8, 0.1]])
    row = measure(made, np.array([1, 1, 1]), np.ones(3), corners, np.array([[0, 1, 2]]))
    weights = np.random.default_rng(0).dirichlet([1, 1, 1], 1_000_000)
    distances = made.distance_and_normal(weights @ corners)[0]
    assert row["distance"] == pytest.approx(np.sqrt((distances**2).mean()), rel=0.005)


def test_tori_have_normals_that_are_gradients():
    made, _, _ = body("tori24")
    points = np.random.default_rng(0).uniform(5, 18, (200, 3))
    _, normals = made.distance_and_normal(points)
    for axis in range(3):
        step = np.eye(3)[axis] * 1e-6
        ahead, behind = (made.distance_and_normal(points + s)[0] for s in (step, -step))
        assert np.abs((ahead - behind) / 2e-6 - normals[:, axis]).max() < 1e-5


def test_the_foot_on_a_gyroid_is_the_nearest_point():
    made = GyroidBall(np.array([3.0, -2.0, 5.0]), 100.0, 20.0)
    points = np.random.default_rng(0).uniform(-30, 30, (2000, 3))
    points = points[np.abs(made._level(points)[0]) < 0.35]  # a voxel; the radius of curvature is 2.9
    assert len(points) > 200
    distances, normals = made.distance_and_normal(points)
    feet = points - distances[:, None] * normals
    level, gradient = made._level(feet)
    steepness = np.linalg.norm(gradient, axis=1)
    assert np.abs(level / steepness).max() < 1e-3
    # Straight above its foot, to within what four steps leave.
    assert (np.linalg.norm(np.cross(gradient, normals), axis=1) / steepness).max() < 0.02
    assert (made.contains(points) == (distances <= 0))[np.abs(distances) > 1e-3].all()


def test_a_gyroid_is_judged_away_from_the_end_of_its_ball():
    made = GyroidBall(np.zeros(3), 20.0, 30.0)
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=20.0)
    assert not made.judged(sphere.vertices).any()
    assert made.judged(0.8 * sphere.vertices).all()
    # What lies beyond counts for nothing.
    corners, beyond = np.eye(3), sphere.faces + 3
    alone = errors(made, corners, np.array([[0, 1, 2]]))
    both = errors(made, np.vstack([corners, sphere.vertices]), np.vstack([[[0, 1, 2]], beyond]))
    assert both["distance"] == pytest.approx(alone["distance"], rel=1e-12)
    assert both["normal"] == pytest.approx(alone["normal"], rel=1e-12)


def test_the_majority_sees_through_a_crack():
    made, dims, spacing = body("sphere32")
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=made.radius)
    vertices, inside = sphere.vertices + made.centre, occupancy(made, dims, spacing)
    whole = wrong_by_majority(spacing, vertices, sphere.faces, inside)
    affine = np.diag([*spacing, 1.0])
    assert whole == wrong_side(affine, vertices, sphere.faces, inside)
    shrunk = (vertices - made.centre) * 0.9 + made.centre
    away = np.linalg.norm(np.argwhere(inside) - made.centre, axis=1)
    many = wrong_by_majority(spacing, shrunk, sphere.faces, inside)
    assert many == pytest.approx((away > 0.9 * made.radius).sum(), rel=0.02)
    facing_x = np.argmax(np.abs(sphere.face_normals[:, 0]))
    torn = np.delete(sphere.faces, facing_x, 0)
    assert wrong_side(affine, vertices, torn, inside) > whole
    assert wrong_by_majority(spacing, vertices, torn, inside) == whole


def test_tables_say_what_is_not_known():
    columns = {"name": ("volume", "{}"), "area": ("area", "{:+.1f}"), "end": ("end", "{}")}
    lines = list(table(columns, [{"name": "a", "area": float("nan")}, {"name": "b", "area": 1.25}]))
    assert lines[1:] == ["|---|---:|---:|", "| a | – | – |", "| b | +1.2 | – |"]


def test_ply_files_of_another_writer(tmp_path):
    sphere = trimesh.creation.icosphere(subdivisions=2)
    sphere.export(tmp_path / "sphere.ply")
    vertices, triangles = read_ply(tmp_path / "sphere.ply")
    assert np.allclose(vertices, sphere.vertices, atol=1e-6)
    assert (triangles == sphere.faces).all()
