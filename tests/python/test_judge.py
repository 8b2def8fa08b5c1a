"""The judge finds what it has to find."""

import numpy as np
import pytest
import trimesh

from judge import assert_separates, wrong_side, windings

IDENTITY = np.eye(4)


def ball(radius=5.3, centre=6.0):
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    mesh.apply_translation([centre] * 3)
    index = np.indices((13, 13, 13)).transpose(1, 2, 3, 0)
    return mesh, np.linalg.norm(index - centre, axis=-1) <= radius


def test_a_ball_is_wound_once():
    mesh, inside = ball()
    around = windings(mesh.vertices, mesh.faces, inside.shape)
    assert (around == inside).all()
    inverted = windings(mesh.vertices, mesh.faces[:, ::-1], inside.shape)
    assert (inverted == -inside.astype(int)).all()


def test_one_voxel_on_the_wrong_side_is_counted():
    mesh, inside = ball()
    assert_separates(mesh, IDENTITY, inside)
    inside[6, 6, 6] = False
    assert wrong_side(IDENTITY, mesh.vertices, mesh.faces, inside) == 1
    with pytest.raises(AssertionError):
        assert_separates(mesh, IDENTITY, inside)


def test_vertices_on_lattice_lines_do_not_confuse():
    right, left, back, front, top, bottom = range(6)
    octahedron = 2 + 0.5 * np.array(
        [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    )
    ring = [right, back, left, front]
    upper = [[ring[n], ring[(n + 1) % 4], top] for n in range(4)]
    lower = [[ring[(n + 1) % 4], ring[n], bottom] for n in range(4)]
    inside = np.zeros((5, 5, 5), bool)
    inside[2, 2, 2] = True
    assert wrong_side(IDENTITY, octahedron, np.array(upper + lower), inside) == 0


def test_a_mirrored_frame_wants_outward_triangles_too():
    mesh, inside = ball()
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    mesh.apply_transform(mirror)  # trimesh turns the triangles around
    assert mesh.volume > 0
    assert_separates(mesh, mirror, inside)


def test_a_hole_or_an_inverted_mesh_is_refused():
    mesh, inside = ball()
    torn = trimesh.Trimesh(mesh.vertices, mesh.faces[1:], process=False)
    inverted = trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)
    for wrong in (torn, inverted):
        with pytest.raises(AssertionError):
            assert_separates(wrong, IDENTITY, inside)
