"""NRRD files written by pynrrd: the mesh lies in the space that the header names."""

import json

import nrrd
import numpy as np
import pytest
import SimpleITK as sitk

from judge import assert_separates, sample_volume
from test_metaimage import affine_of

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


def told(shrouds, path):
    """What the program says of a file: its affine, and its labels with their counts."""
    info = json.loads(shrouds("info", path, "--json"))
    labels = {entry["label"]: entry["voxels"] for entry in info["labels"]}
    return np.array(info["affine"]), labels


def counts(values):
    labels, numbers = np.unique(values, return_counts=True)
    return dict(zip(labels.tolist(), numbers.tolist(), strict=True))


@pytest.mark.parametrize("encoding", ["raw", "gzip", "ascii"])
def test_a_detached_header(shrouds, tmp_path, encoding):
    values = sample_volume().astype(np.int16) * 5 - 2
    header = {"space directions": DIRECTIONS, "space origin": ORIGIN, "space": "RAS"}
    header["encoding"] = encoding
    path = tmp_path / "volume.nhdr"
    nrrd.write(str(path), values, header, detached_header=True)
    assert len(list(tmp_path.iterdir())) == 2
    affine, labels = told(shrouds, path)
    assert np.allclose(affine, frame(DIRECTIONS, ORIGIN)[:3], rtol=0, atol=1e-6)
    assert labels == counts(values)


def test_one_layer_in_front(shrouds, tmp_path):
    values = sample_volume().astype(np.uint8)[None]
    header = {
        "kinds": ["list", "domain", "domain", "domain"],
        "space": "left-posterior-superior",
        "space directions": np.vstack([np.full(3, np.nan), DIRECTIONS]),
        "space origin": ORIGIN,
    }
    path = tmp_path / "layered.seg.nrrd"
    nrrd.write(str(path), values, header)
    affine, labels = told(shrouds, path)
    assert np.allclose(affine, frame(DIRECTIONS, ORIGIN)[:3], rtol=0, atol=1e-6)
    assert labels == counts(values)


@pytest.mark.parametrize(
    "fields",
    [
        "spacings: 1 -2 3\n",
        "spacings: 1 2 3\naxis mins: 10 20 30\n",
        "spacings: 1 2 3\naxis mins: 10 20 30\ncenters: node node node\n",
        "space: LPS\nspace directions: (1,0,0) (0,0,2) (0,-3,0)\nspace origin: (1,2,3)\n",
        "space: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3)\ncenters: node node node\n",
    ],
)
def test_frames_are_those_of_itk(shrouds, tmp_path, fields):
    path = tmp_path / "a.nrrd"
    start = "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n"
    path.write_bytes((start + fields + "\n").encode() + bytes(range(24)))
    affine, labels = told(shrouds, path)
    assert np.allclose(affine, affine_of(sitk.ReadImage(str(path)))[:3], rtol=0, atol=1e-6)
    assert labels == {n: 1 for n in range(24)}
