"""Volumes out of volumes and meshes, against SciPy, trimesh and the readers of the formats."""

import json
from pathlib import Path

import nibabel
import nrrd
import numpy as np
import pytest
import trimesh
from scipy import ndimage

BUNNY = Path(__file__).parents[2] / "target" / "data" / "bunny.ply"
SPACING = np.array([0.7, 1.1, 2.3])


def blobs(seed, shape=(24, 21, 18)):
    """Random blobs: some touch the border, some have cavities."""
    noise = np.random.default_rng(seed).normal(size=shape)
    return ndimage.gaussian_filter(noise, 1.5) > 0.05


def write(path, inside):
    header = {
        "space": "left-posterior-superior",
        "space directions": np.diag(SPACING),
        "space origin": [5.0, -3.0, 40.0],
    }
    nrrd.write(str(path), inside.astype(np.uint8), header)


def winding_numbers(mesh, points):
    """The solid angles of all triangles (Van Oosterom and Strackee, 1983) over 4π."""
    numbers = []
    for point in points:
        a, b, c = (mesh.triangles - point).transpose(1, 0, 2)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        triple = np.einsum("ij,ij->i", a, np.cross(b, c))
        dot = lambda u, v: np.einsum("ij,ij->i", u, v)
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        numbers.append(np.arctan2(triple, below).sum() / (2 * np.pi))
    return np.array(numbers)


def read(path):
    """Inside points and the place of the first voxel."""
    values, header = nrrd.read(str(path))
    return values != 0, np.array(header["space origin"], float)


@pytest.mark.parametrize("by", [0.7, 2.3, 4.0, -1.1, -3.0])
@pytest.mark.parametrize("seed", range(3))
def test_offsets_are_euclidean_distances(shrouds, tmp_path, seed, by):
    inside = blobs(seed)
    write(tmp_path / "a.nrrd", inside)
    call = ["offset", tmp_path / "a.nrrd", "--by", by, "-o", tmp_path / "b.nrrd"]
    shrouds(*call, "--keep-lattice", "--border", "open")
    # Ties between a distance and its multiple of the spacing count as reached.
    reach = abs(by) * (1 + 1e-7)
    if by > 0:
        expected = ndimage.distance_transform_edt(~inside, sampling=SPACING) <= reach
    else:
        expected = ndimage.distance_transform_edt(inside, sampling=SPACING) > reach
    assert np.array_equal(read(tmp_path / "b.nrrd")[0], expected)
    shrouds(*call)
    grown, origin = read(tmp_path / "b.nrrd")
    first = np.round((np.array([5.0, -3.0, 40.0]) - origin) / SPACING).astype(int)
    part = tuple(slice(f, f + n) for f, n in zip(first, inside.shape))
    if by > 0:
        assert np.array_equal(grown[part], expected)
        faces = [np.take(grown, [0, -1], axis=axis) for axis in range(3)]
        beyond = ndimage.binary_dilation(np.pad(grown, 1)).sum() >= grown.sum()
        assert all(face.any() for face in faces) and beyond


@pytest.mark.parametrize("seed", range(3))
def test_cleaning_is_that_of_labelled_components(shrouds, tmp_path, seed):
    inside = blobs(seed)
    write(tmp_path / "a.nrrd", inside)
    out = tmp_path / "b.nrrd"
    shrouds("clean", tmp_path / "a.nrrd", "--drop-below", 20, "-o", out)
    labels, count = ndimage.label(inside)
    sizes = ndimage.sum_labels(inside, labels, range(1, count + 1))
    expected = np.isin(labels, 1 + np.flatnonzero(sizes >= 20))
    assert np.array_equal(read(out)[0], expected)
    shrouds("clean", tmp_path / "a.nrrd", "--fill-cavities", "-o", out)
    edges = ndimage.generate_binary_structure(3, 2)
    outside, _ = ndimage.label(~inside, structure=edges)
    border = set()
    for axis in range(3):
        border |= set(np.unique(np.take(outside, [0, -1], axis=axis)))
    expected = inside | ~np.isin(outside, list(border | {0}))
    assert np.array_equal(read(out)[0], expected)


@pytest.mark.parametrize("operation, combine", [
    ("union", np.logical_or),
    ("intersect", np.logical_and),
    ("subtract", lambda a, b: a & ~b),
    ("xor", np.logical_xor),
])
def test_boolean_operations(shrouds, tmp_path, operation, combine):
    a, b = blobs(1), blobs(2)
    write(tmp_path / "a.nrrd", a)
    write(tmp_path / "b.nrrd", b)
    out = tmp_path / "c.nii.gz"
    shrouds("combine", operation, tmp_path / "a.nrrd", tmp_path / "b.nrrd", "-o", out)
    image = nibabel.load(out)
    assert np.array_equal(np.asarray(image.dataobj) != 0, combine(a, b))
    # The world of NIfTI is RAS, that of the input was LPS.
    affine = np.diag([-SPACING[0], -SPACING[1], SPACING[2], 1])
    affine[:3, 3] = [-5.0, 3.0, 40.0]
    assert np.allclose(image.affine, affine, atol=1e-5)


def test_voxels_of_a_mesh(shrouds, tmp_path):
    mesh = trimesh.creation.torus(major_radius=10, minor_radius=4, major_sections=90)
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(np.array([0.3, 0.6, 0.1])))
    mesh.export(tmp_path / "torus.ply")
    out = tmp_path / "torus.nii"
    call = ["voxelize", tmp_path / "torus.ply", "--spacing", 0.5, "-o", out, "--json"]
    report = json.loads(shrouds(*call))
    assert report["method"] == "exact" and not report["notes"]
    assert report["enclosed_volume"] == pytest.approx(mesh.volume, rel=1e-6)
    assert report["voxel_volume"] == pytest.approx(mesh.volume, rel=0.003)
    image = nibabel.load(out)
    inside = np.asarray(image.dataobj) != 0
    index = np.argwhere(np.ones_like(inside))
    chosen = np.random.default_rng(5).choice(len(index), 3000, replace=False)
    points = nibabel.affines.apply_affine(image.affine, index[chosen])
    assert np.array_equal(inside[tuple(index[chosen].T)], winding_numbers(mesh, points) > 0.5)


@pytest.mark.skipif(not BUNNY.exists(), reason="run `cargo xtask data` to fetch the bunny")
def test_the_bunny_and_the_letters(shrouds, tmp_path):
    """Three commands: the paper's Figure 4."""
    folder, bunny, both = (tmp_path / name for name in ("asu", "bunny.npy", "both.npy"))
    shrouds("demo", "letters:ASU", "--size", 60, "--output", folder, "--quiet")
    letters = folder / "volume.npy"
    call = ["voxelize", BUNNY, "--like", letters, "--fit", "-o", bunny, "--json"]
    report = json.loads(shrouds(*call))
    assert report["closed"]
    assert report["voxel_volume"] == pytest.approx(report["enclosed_volume"], rel=0.002)
    shrouds("combine", "intersect", bunny, letters, "-o", both)
    expected = (np.load(bunny) != 0) & (np.load(letters) != 0)
    assert expected.shape == (60, 60, 60) and np.array_equal(np.load(both) != 0, expected)
    shrouds("mesh", both, "-o", tmp_path / "both.ply", "--quiet")
    mesh = trimesh.load(tmp_path / "both.ply", process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent
