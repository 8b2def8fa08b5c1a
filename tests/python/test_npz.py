"""NumPy archives, stored and deflated."""

import numpy as np
import pytest

from judge import assert_separates, sample_volume


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
@pytest.mark.parametrize("order", ["C", "F"])
def test_the_only_volume_is_read(mesh_of, tmp_path, save, order):
    inside = sample_volume()
    path = tmp_path / "volume.npz"
    array = np.asarray(inside.transpose(2, 1, 0).astype(np.uint16), order=order)
    save(path, names=np.array(["a", "b"]), spacing=np.ones(3), labels=array)
    assert_separates(mesh_of(path), np.eye(4), inside)
