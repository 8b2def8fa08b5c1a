"""NRRD files written by pynrrd: the mesh lies in the space that the header names."""

import nrrd
import numpy as np
import pytest

from judge import assert_separates, sample_volume

DIRECTIONS = np.array([[0.9, 0.3, 0.05], [-0.35, 1.1, 0.45], [0.1, -0.4, 2.2]])  # one axis a row
ORIGIN = np.array([-12.5, 40.25, 7.0])


def frame(directions, origin):
    affine = np.eye(4)
    affine[:3, :3] = directions.T
    affine[:3, 3] = origin
    return affine


@pytest.mark.parametrize("encoding", ["raw", "gzip"])
@pytest.mark.parametrize("dtype", ["uint8", "int16", "<f4", ">u2"])
def test_the_mesh_lies_in_the_space_of_the_file(mesh_of, tmp_path, encoding, dtype):
    inside = sample_volume()
    header = {
        "space": "left-posterior-superior",
        "space directions": DIRECTIONS,
        "space origin": ORIGIN,
        "encoding": encoding,
    }
    path = tmp_path / "volume.nrrd"
    nrrd.write(str(path), inside.astype(dtype), header)
    assert_separates(mesh_of(path), frame(DIRECTIONS, ORIGIN), inside)


def test_mirrored_axes(mesh_of, tmp_path):
    inside = sample_volume()
    directions = np.diag([-1.0, -1.5, -2.0])
    header = {
        "space": "left-posterior-superior",
        "space directions": directions,
        "space origin": ORIGIN,
    }
    path = tmp_path / "volume.nrrd"
    nrrd.write(str(path), inside.astype(np.uint8), header)
    assert_separates(mesh_of(path), frame(directions, ORIGIN), inside)


def test_spacings_without_a_space(mesh_of, tmp_path):
    inside = sample_volume()
    path = tmp_path / "volume.nrrd"
    nrrd.write(str(path), inside.astype(np.uint8), {"spacings": [1.0, 1.5, 2.5]})
    assert_separates(mesh_of(path), np.diag([1.0, 1.5, 2.5, 1.0]), inside)
