"""NIfTI files written by nibabel: any frame and number type gives a mesh in the world of the file."""

import nibabel
import numpy as np
import pytest

from judge import assert_separates, sample_volume

OBLIQUE = np.array(
    [[0.9, -0.35, 0.1, -12.5], [0.3, 1.1, -0.4, 40.25], [0.05, 0.45, 2.2, 7.0], [0, 0, 0, 1]]
)
MIRRORED = np.diag([-1.5, 0.75, 2.0, 1.0])
TURNED = np.array([[0, 0, 2.0, 1], [-1.0, 0, 0, 2], [0, 1.5, 0, 3], [0, 0, 0, 1]])  # x is -y, ...
FRAMES = {"oblique": OBLIQUE, "mirrored": MIRRORED, "turned": TURNED}


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("surface", ["primal", "dual"])
def test_the_mesh_lies_in_the_world_of_the_file(mesh_of, tmp_path, frame, surface):
    inside, affine = sample_volume(), FRAMES[frame]
    path = tmp_path / "volume.nii.gz"
    nibabel.save(nibabel.Nifti1Image(inside.astype(np.uint8), affine), path)
    assert_separates(mesh_of(path, "--surface", surface), affine, inside)


@pytest.mark.parametrize("dtype", ["uint8", "int16", ">i2", ">f4", "float64", "uint16", "int32"])
def test_number_types_and_byte_orders(mesh_of, tmp_path, dtype):
    inside, dtype = sample_volume(), np.dtype(dtype)
    header = nibabel.Nifti1Header(endianness=dtype.byteorder if dtype.byteorder == ">" else "<")
    image = nibabel.Nifti1Image(inside.astype(dtype) * 3, OBLIQUE, header)
    image.set_data_dtype(dtype)
    path = tmp_path / "volume.nii"
    nibabel.save(image, path)
    assert path.read_bytes()[:4] == (b"\0\0\1\\" if dtype.byteorder == ">" else b"\\\1\0\0")
    assert_separates(mesh_of(path), OBLIQUE, inside)


def test_scaled_values_are_what_the_threshold_sees(mesh_of, tmp_path):
    inside = sample_volume()
    stored = np.where(inside, 3.5, 2.5).astype(np.float32)  # all above the threshold
    image = nibabel.Nifti1Image(stored, OBLIQUE)
    image.header.set_slope_inter(0.5, -1.0)  # nibabel leaves stored floats as they are
    path = tmp_path / "volume.nii.gz"
    nibabel.save(image, path)
    again = nibabel.load(path)
    assert np.allclose(again.get_fdata(), np.where(inside, 0.75, 0.25))
    assert again.dataobj.slope == 0.5
    assert_separates(mesh_of(path, "--threshold", "0.5"), OBLIQUE, inside)


def test_a_frame_from_the_quaternion_alone(mesh_of, tmp_path):
    inside = sample_volume()
    turn, _ = np.linalg.qr(OBLIQUE[:3, :3])
    affine = np.eye(4)
    affine[:3, :3] = turn * [-1.0, 1.25, 2.5]
    affine[:3, 3] = OBLIQUE[:3, 3]
    image = nibabel.Nifti1Image(inside.astype(np.uint8), affine)
    image.set_qform(affine, code=1)
    image.set_sform(None, code=0)
    path = tmp_path / "volume.nii.gz"
    nibabel.save(image, path)
    stored = nibabel.load(path)
    assert stored.header["sform_code"] == 0
    assert_separates(mesh_of(path), stored.affine, inside)


def test_nifti_2(mesh_of, tmp_path):
    inside = sample_volume()
    path = tmp_path / "volume.nii"
    nibabel.save(nibabel.Nifti2Image(inside.astype(np.uint8), OBLIQUE), path)
    assert_separates(mesh_of(path), OBLIQUE, inside)


def test_one_label_of_several(mesh_of, tmp_path):
    inside = sample_volume()
    labels = np.where(inside, 7, 4).astype(np.int16)
    path = tmp_path / "labels.nii.gz"
    nibabel.save(nibabel.Nifti1Image(labels, OBLIQUE), path)
    assert_separates(mesh_of(path, "--label", "7"), OBLIQUE, inside)


@pytest.mark.parametrize("suffix", ["", ".gz"])
def test_a_pair_of_files(mesh_of, tmp_path, suffix):
    inside = sample_volume()
    image = nibabel.Nifti1Pair(inside.astype(np.int16), OBLIQUE)
    nibabel.save(image, tmp_path / f"volume.img{suffix}")
    for name in [f"volume.hdr{suffix}", f"volume.img{suffix}"]:
        assert_separates(mesh_of(tmp_path / name), OBLIQUE, inside)
