"""TIFF files written by tifffile: pages, hyperstacks, OME, tiles, compressions, and folders of slices."""

import json

import numpy as np
import pytest
import tifffile

from judge import assert_separates, sample_volume


def zyx(inside, dtype=np.uint8):
    """The volume as tifffile wants it: indexed [z, y, x]."""
    return np.ascontiguousarray(inside.transpose(2, 1, 0)).astype(dtype)


@pytest.mark.parametrize("compression", [None, "zlib", "lzw", "packbits"])
@pytest.mark.parametrize("tile", [None, (16, 16)])
@pytest.mark.parametrize("predictor", [False, True])
@pytest.mark.parametrize("dtype", ["uint8", ">u2", "int32", "float32"])
def test_layouts(shrouds, tmp_path, compression, tile, predictor, dtype):
    if predictor and compression in (None, "packbits"):
        pytest.skip("tifffile predicts only before zlib and lzw")
    labels = zyx(sample_volume(), dtype) * 3
    path = tmp_path / "volume.tif"
    order = ">" if dtype.startswith(">") else "<"
    options = {"compression": compression, "predictor": predictor, "tile": tile}
    tifffile.imwrite(path, labels, byteorder=order, photometric="minisblack", **options)
    assert counts(shrouds, path) == expected_counts(tifffile.imread(path))


@pytest.mark.parametrize("bigtiff", [False, True])
def test_the_mesh_lies_at_the_pixels(mesh_of, tmp_path, bigtiff):
    inside = sample_volume()
    path = tmp_path / "volume.tif"
    tifffile.imwrite(path, zyx(inside), bigtiff=bigtiff, photometric="minisblack")
    assert_separates(mesh_of(path), np.eye(4), inside)


def test_bits(mesh_of, tmp_path):
    inside = sample_volume()
    path = tmp_path / "volume.tif"
    tifffile.imwrite(path, zyx(inside, bool), photometric="minisblack")
    assert_separates(mesh_of(path), np.eye(4), inside)


def test_imagej_spacing(mesh_of, shrouds, tmp_path):
    inside = sample_volume()
    path = tmp_path / "volume.tif"
    metadata = {"axes": "ZYX", "spacing": 2.5, "unit": "micron"}
    tifffile.imwrite(path, zyx(inside), imagej=True, resolution=(4, 2), metadata=metadata)
    assert_separates(mesh_of(path), np.diag([0.25, 0.5, 2.5, 1]), inside)
    info = json.loads(shrouds("info", path, "--json"))
    assert info["unit"] == "um"


def test_ome_sizes(mesh_of, tmp_path):
    inside = sample_volume()
    path = tmp_path / "volume.ome.tif"
    sizes = {"PhysicalSizeX": 0.25, "PhysicalSizeY": 500, "PhysicalSizeZ": 0.0025}
    units = {"PhysicalSizeXUnit": "µm", "PhysicalSizeYUnit": "nm", "PhysicalSizeZUnit": "mm"}
    metadata = {"axes": "ZYX", **sizes, **units}
    tifffile.imwrite(path, zyx(inside), metadata=metadata, photometric="minisblack")
    assert_separates(mesh_of(path), np.diag([0.25, 0.5, 2.5, 1]), inside)


def test_a_folder_of_slices(mesh_of, tmp_path):
    inside = sample_volume()
    folder = tmp_path / "slices"
    folder.mkdir()
    for n, page in enumerate(zyx(inside)):
        tifffile.imwrite(folder / f"slice{n + 1}.tif", page, photometric="minisblack")
    assert_separates(mesh_of(folder), np.eye(4), inside)


def counts(shrouds, path):
    """What the program says of the labels of a file."""
    info = json.loads(shrouds("info", path, "--json"))
    return [(row["label"], row["voxels"]) for row in info["labels"]]


def expected_counts(array):
    values, numbers = np.unique(array, return_counts=True)
    return [(int(value), int(number)) for value, number in zip(values, numbers)]
