"""Real data, where `cargo xtask data` has fetched it."""

from pathlib import Path

import nibabel
import numpy as np
import pytest

from judge import assert_separates

BRAIN = Path(__file__).parents[2] / "target" / "data" / "brain.nii.gz"


@pytest.mark.skipif(not BRAIN.exists(), reason="run `cargo xtask data` to fetch the brain")
def test_half_a_brain(mesh_of, tmp_path):
    """The lower half of the head, cut so that the surface meets the border of the volume."""
    image = nibabel.load(BRAIN)
    half = image.slicer[:, :, : image.shape[2] // 2]
    path = tmp_path / "half.nii.gz"
    nibabel.save(half, path)
    assert_separates(mesh_of(path), half.affine, np.asarray(half.dataobj) != 0)
