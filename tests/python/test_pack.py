"""Packed volumes come back voxel by voxel, with the place in the world that other tools know."""

import json

import nibabel
import numpy as np
import pytest
import trimesh

from judge import sample_volume

AFFINE = np.array([[-0.9, 0.1, 0, 12], [0, 1.1, 0.2, -40], [0, -0.2, 2.5, 7.5], [0, 0, 0, 1]])


def labels():
    """Touching blocks and a ball of labels, as far as 1000."""
    index = np.indices((40, 30, 20))
    values = (index // [[[[14]]], [[[11]]], [[[9]]]]).sum(0) % 4
    ball = ((index - 15) ** 2).sum(0) < 60
    return np.where(ball, 1000, values * 7).astype(np.int16)


@pytest.fixture
def atlas(tmp_path):
    path = tmp_path / "atlas.nii.gz"
    nibabel.save(nibabel.Nifti1Image(labels(), AFFINE), path)
    return path


@pytest.mark.parametrize("profile", ["fast", "dense"])
@pytest.mark.parametrize("slabs", [[], ["--slab", 7], ["--slab", 7, "--independent"]])
def test_a_volume_comes_back(shrouds, tmp_path, profile, slabs):
    volume = np.ascontiguousarray(sample_volume().transpose(2, 1, 0).astype(np.uint8))
    source, packed, back = (tmp_path / name for name in ("a.npy", "a.shroud", "b.npy"))
    np.save(source, volume)
    options = ["--profile", profile, *slabs]
    report = json.loads(shrouds("pack", source, "-o", packed, "--json", "--quiet", *options))
    assert report["bytes"] == packed.stat().st_size
    pairs = (np.diff(volume.astype(int), axis=axis) for axis in range(3))
    assert report["vertices"] == sum(int(np.abs(pair).sum()) for pair in pairs)
    shrouds("unpack", packed, "-o", back, "--quiet")
    np.testing.assert_array_equal(np.load(back), volume)


def test_a_label_keeps_its_place(shrouds, atlas, tmp_path):
    packed, back = tmp_path / "a.shroud", tmp_path / "b.nii.gz"
    shrouds("pack", atlas, "--label", 1000, "-o", packed, "--quiet")
    shrouds("unpack", packed, "-o", back, "--quiet")
    image = nibabel.load(back)
    np.testing.assert_array_equal(np.asarray(image.dataobj), labels() == 1000)
    np.testing.assert_allclose(image.affine, AFFINE, atol=1e-5)


@pytest.mark.parametrize("profile", ["fast", "dense"])
def test_all_labels_come_back(shrouds, atlas, tmp_path, profile):
    packed, back = tmp_path / "a.shroud", tmp_path / "b.npy"
    shrouds("pack", atlas, "--labels", "all", "-o", packed, "--profile", profile, "--quiet")
    shrouds("unpack", packed, "-o", back, "--quiet")
    np.testing.assert_array_equal(np.load(back), labels().transpose(2, 1, 0))
    image = tmp_path / "b.nii.gz"
    shrouds("unpack", packed, "-o", image, "--quiet")
    np.testing.assert_array_equal(np.asarray(nibabel.load(image).dataobj), labels())
    np.testing.assert_allclose(nibabel.load(image).affine, AFFINE, atol=1e-5)
    shrouds("unpack", packed, "--label", 7, "--label", 1000, "-o", back, "--quiet")
    expected = np.isin(labels(), [7, 1000]).transpose(2, 1, 0)
    np.testing.assert_array_equal(np.load(back), expected)


def test_the_mesh_is_that_of_the_volume(shrouds, atlas, mesh_of, tmp_path):
    packed, out = tmp_path / "a.shroud", tmp_path / "packed.ply"
    shrouds("pack", atlas, "--label", 1000, "-o", packed, "--quiet")
    shrouds("unpack", packed, "-o", out, "--quiet")
    mesh_of(atlas, "--label", 1000)
    assert out.read_bytes() == (tmp_path / "out.ply").read_bytes()


def test_every_bit_brings_the_mesh_nearer(shrouds, tmp_path):
    """Against the sphere itself, known to trimesh alone."""
    source, packed, out = (tmp_path / name for name in ("a.ply", "a.shroud", "b.ply"))
    radius = 1.7
    # So fine that its facets are nearer to the sphere than eight bits tell.
    trimesh.creation.icosphere(subdivisions=7, radius=radius).export(source)
    errors = []
    for bits in (0, 1, 2, 4, 8):
        call = ["pack", source, "--size", 33, "--bits", bits, "-o", packed, "--json", "--quiet"]
        report = json.loads(shrouds(*call))
        assert (report["planes"] or {"bits": 0})["bits"] == bits
        shrouds("unpack", packed, "-o", out, "--quiet")
        mesh = trimesh.load(out)
        assert mesh.is_watertight and mesh.euler_number == 2
        distances = np.linalg.norm(mesh.vertices, axis=1) - radius
        errors.append(np.sqrt((distances**2).mean()) / (2 * radius / 30))
    # A bit halves the interval: at most half of what is left after none of them, and so on.
    limits = [0.25 * 2.0**-bits for bits in (0, 1, 2, 4, 8)]
    assert all(error < limit for error, limit in zip(errors, limits)), errors
    assert errors == sorted(errors, reverse=True)


def test_every_packed_label_has_its_mesh(shrouds, atlas, tmp_path):
    packed, folder = tmp_path / "a.shroud", tmp_path / "organs"
    shrouds("pack", atlas, "--labels", "all", "-o", packed, "--quiet")
    shrouds("unpack", packed, "-o", folder, "--quiet")
    there = sorted(path.name for path in folder.iterdir())
    assert there == sorted(f"label-{label}.ply" for label in np.unique(labels()) if label)
    ball = trimesh.load(folder / "label-1000.ply")
    voxel = abs(np.linalg.det(AFFINE[:3, :3]))
    assert ball.is_watertight
    assert ball.volume == pytest.approx((labels() == 1000).sum() * voxel, rel=0.03)
