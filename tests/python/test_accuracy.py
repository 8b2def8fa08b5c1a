"""The measures behind `cargo xtask bench`."""

import numpy as np
import pytest
import trimesh

from accuracy import Ball, body, measure, occupancy, read_ply


@pytest.mark.parametrize(
    "name, points",
    # The library's phantoms have the same counts (crates/shrouds/src/volume/phantom/mod.rs).
    [("tori24", 799), ("sphere32", 8783), ("tori128_1x1x3", 39073)],
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


def test_ply_files_of_another_writer(tmp_path):
    sphere = trimesh.creation.icosphere(subdivisions=2)
    sphere.export(tmp_path / "sphere.ply")
    vertices, triangles = read_ply(tmp_path / "sphere.ply")
    assert np.allclose(vertices, sphere.vertices, atol=1e-6)
    assert (triangles == sphere.faces).all()
