"""NumPy files in both memory orders and both readings of the axes."""

import numpy as np
import pytest

from judge import assert_separates, sample_volume

SPACING = (1.0, 1.5, 2.5)
AFFINE = np.diag([*SPACING, 1.0])


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("axes", [None, "zyx", "xyz"])
def test_orders_and_axes(mesh_of, tmp_path, order, axes):
    inside = sample_volume()
    array = inside if axes == "xyz" else inside.transpose(2, 1, 0)
    path = tmp_path / "volume.npy"
    np.save(path, np.asarray(array.astype(np.uint8), order=order))
    assert np.load(path).flags.f_contiguous == (order == "F")
    options = [] if axes is None else ["--axes", axes]
    mesh = mesh_of(path, "--spacing", ",".join(map(str, SPACING)), *options)
    assert_separates(mesh, AFFINE, inside)


@pytest.mark.parametrize("dtype", ["bool", "int8", ">i4", "<u8", ">f8", "float32"])
def test_number_types(mesh_of, tmp_path, dtype):
    inside = sample_volume()
    path = tmp_path / "volume.npy"
    np.save(path, inside.transpose(2, 1, 0).astype(dtype, order="C"))
    assert_separates(mesh_of(path), np.eye(4), inside)


@pytest.mark.parametrize("surface", ["primal", "dual"])
def test_pure_noise(mesh_of, tmp_path, surface):
    """Half of all points inside, at random: every case of the topology, most faces ambiguous."""
    inside = np.random.default_rng(1).random((12, 10, 11)) < 0.5
    path = tmp_path / "noise.npy"
    np.save(path, np.ascontiguousarray(inside.transpose(2, 1, 0)))
    assert_separates(mesh_of(path, "--surface", surface), np.eye(4), inside)
