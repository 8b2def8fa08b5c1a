"""Zarr arrays written by zarr-python and OME-Zarr images written by ome-zarr, of both versions."""

import json
import shutil

import numpy as np
import pytest

# The packages need Python 3.11.
zarr = pytest.importorskip("zarr")

import ome_zarr.format
import ome_zarr.writer
from numcodecs import LZ4, Blosc, GZip, Zlib, Zstd
from zarr.codecs import BloscCodec, BytesCodec, GzipCodec, TransposeCodec, ZstdCodec

from judge import assert_separates, sample_volume

INDEX = np.eye(4)


@pytest.fixture
def info(shrouds):
    return lambda path, *options: json.loads(shrouds("info", path, "--json", "--quiet", *options))


def labels_of(dtype="uint8"):
    """Labels without a symmetry, indexed z, y, x; the largest is the largest of its type."""
    inside = sample_volume()
    kinds = np.array([1, 2, 100, np.iinfo(dtype).max if np.dtype(dtype).kind in "iu" else 7])
    pattern = np.indices(inside.shape).sum(0) // 3 % 4
    return np.where(inside, kinds[pattern], 0).T.astype(dtype)


def assert_is(info, mesh_of, path, labels, affine=INDEX, unit="unknown", frame="index", options=()):
    """Every label is where it should be; `labels` are indexed z, y, x."""
    told = info(path, *options)
    assert told["dims"] == list(labels.shape[::-1])
    values, counts = np.unique(labels, return_counts=True)
    expected = dict(zip(values.astype(object).tolist(), counts.tolist()))
    assert {entry["label"]: entry["voxels"] for entry in told["labels"]} == expected
    spacing = np.abs(np.diag(affine)[:3]).min()
    assert np.abs(np.array(told["affine"]) - affine[:3]).max() < 1e-6 * spacing
    assert (told["frame"], told["unit"]) == (frame, unit)
    assert_separates(mesh_of(path, *options), affine, labels.T > 0)
    assert_separates(mesh_of(path, "--label", 2, *options), affine, labels.T == 2)


SECOND = {
    "raw": None,
    "gzip": GZip(),
    "zlib": Zlib(),
    "zstd": Zstd(),
    "lz4": LZ4(),
    **{
        f"blosc-{name}-{shuffle}": Blosc(cname=name, shuffle=shuffle)
        for name in ["blosclz", "lz4", "lz4hc", "zlib", "zstd"]
        for shuffle in [Blosc.NOSHUFFLE, Blosc.SHUFFLE, Blosc.BITSHUFFLE]
    },
}


@pytest.mark.parametrize("name", SECOND)
@pytest.mark.parametrize("dtype, order", [("<u2", "C"), (">i4", "F")])
def test_version_2(info, mesh_of, tmp_path, name, dtype, order):
    labels = labels_of(dtype)
    path = tmp_path / "plain.zarr"
    array = zarr.create_array(
        path, shape=labels.shape, chunks=(4, 5, 7), dtype=dtype, zarr_format=2, order=order,
        compressors=SECOND[name], chunk_key_encoding={"name": "v2", "separator": "/"},
    )
    array[:] = labels
    assert_is(info, mesh_of, path, labels)


THIRD = {
    "raw": [],
    "gzip": [GzipCodec()],
    "zstd": [ZstdCodec(checksum=True)],
    "blosc-lz4": [BloscCodec(typesize=4, cname="lz4", shuffle="shuffle")],
    "blosc-zstd": [BloscCodec(typesize=4, cname="zstd", shuffle="bitshuffle")],
}


@pytest.mark.parametrize("name", THIRD)
@pytest.mark.parametrize("shards", [None, (6, 10, 14)])
def test_version_3(info, mesh_of, tmp_path, name, shards):
    labels = labels_of("uint32")
    path = tmp_path / "plain.zarr"
    chunks = (4, 5, 7) if shards is None else (3, 5, 7)
    array = zarr.create_array(
        path, shape=labels.shape, chunks=chunks, shards=shards, dtype="uint32",
        compressors=THIRD[name],
    )
    array[:] = labels
    assert_is(info, mesh_of, path, labels)


def test_transposed_big_endian_chunks(info, mesh_of, tmp_path):
    labels = labels_of("int16")
    path = tmp_path / "plain.zarr"
    array = zarr.create_array(
        path, shape=labels.shape, chunks=(4, 5, 7), dtype="int16", filters=[TransposeCodec(order=(1, 2, 0))],
        serializer=BytesCodec(endian="big"), compressors=[GzipCodec()],
        chunk_key_encoding={"name": "default", "separator": "."},
    )
    array[:] = labels
    assert_is(info, mesh_of, path, labels)


@pytest.mark.parametrize(
    "dtype", "bool int8 uint8 int16 uint16 int32 uint32 int64 uint64 float16 float32 float64".split()
)
@pytest.mark.parametrize("version", [2, 3])
def test_every_type_with_a_fill_value(info, mesh_of, tmp_path, dtype, version):
    labels = labels_of("uint8").astype(dtype) if dtype == "bool" else labels_of(dtype)
    fill = labels.max()
    labels[:4] = fill  # whole chunks, which are left out
    path = tmp_path / "plain.zarr"
    array = zarr.create_array(
        path, shape=labels.shape, chunks=(2, 11, 13), dtype=dtype, zarr_format=version, fill_value=fill,
    )
    array[:] = labels
    assert len([p for p in path.rglob("*") if p.is_file()]) < 5 + 2
    values, counts = np.unique(labels, return_counts=True)
    expected = [(int(v), int(n)) for v, n in zip(values, counts)]
    assert [(entry["label"], entry["voxels"]) for entry in info(path)["labels"]] == expected


def test_blosc_buffers_of_many_blocks(info, tmp_path):
    """Blocks that are split, a last one that is not, and bytes that do not compress."""
    random = np.random.default_rng(1)
    noise = random.integers(0, 60000, (40, 50, 61), np.uint16)
    ramp = np.arange(noise.size, dtype=np.uint16).reshape(noise.shape) // 7
    for values in [noise, ramp]:
        for name in ["blosclz", "lz4", "zlib", "zstd"]:
            for shuffle in [Blosc.NOSHUFFLE, Blosc.SHUFFLE, Blosc.BITSHUFFLE]:
                path = tmp_path / f"{name}{shuffle}.zarr"
                codec = Blosc(cname=name, shuffle=shuffle, blocksize=4096, clevel=9)
                array = zarr.create_array(
                    path, shape=values.shape, chunks=values.shape, dtype="u2", zarr_format=2,
                    compressors=codec, overwrite=True,
                )
                array[:] = values
                numbers, counts = np.unique(values, return_counts=True)
                told = info(path)["labels"]
                assert [entry["label"] for entry in told] == numbers.tolist()
                assert [entry["voxels"] for entry in told] == counts.tolist()


SCALES = [[2.5, 0.75, 0.5], [2.5, 1.5, 1.0]]
SHIFTS = [[100.0, -20.0, 3.0], [100.0, -19.625, 3.25]]


def affine_of(level):
    affine = np.diag([*SCALES[level][::-1], 1.0])
    affine[:3, 3] = SHIFTS[level][::-1]
    return affine


def write_image(path, levels, version, axes="zyx", unit="micrometer", labels=()):
    form = ome_zarr.format.FormatV04() if version == 2 else ome_zarr.format.FormatV05()
    group = zarr.open_group(path, mode="w", zarr_format=version)
    space = [{"name": name, "type": "space", "unit": unit} for name in axes if name in "zyx"]
    other = {"t": {"name": "t", "type": "time"}, "c": {"name": "c", "type": "channel"}}
    kinds = {axis["name"]: axis for axis in space} | other
    scales = [dict(zip("zyx", scale)) for scale in SCALES]
    shifts = [dict(zip("zyx", shift)) for shift in SHIFTS]
    transforms = [
        [
            {"type": "scale", "scale": [scale.get(name, 1.0) for name in axes]},
            {"type": "translation", "translation": [shift.get(name, 0.0) for name in axes]},
        ]
        for scale, shift in zip(scales, shifts)
    ][: len(levels)]
    described = dict(axes=[kinds[name] for name in axes], coordinate_transformations=transforms, fmt=form)
    ome_zarr.writer.write_multiscale(levels, group, **described)
    for name, pyramid in labels:
        ome_zarr.writer.write_multiscale_labels(
            pyramid, group, name,
            label_metadata={"properties": [{"label-value": 1, "name": "nucleus"}]}, **described,
        )
    return group


@pytest.mark.parametrize("version", [2, 3])
def test_images_lie_where_ome_says(info, mesh_of, tmp_path, version):
    labels = labels_of("uint16")
    path = tmp_path / "image.zarr"
    write_image(path, [labels, labels[:, ::2, ::2]], version)
    names = dict(unit="um", frame="unnamed")
    assert_is(info, mesh_of, path, labels, affine_of(0), **names)
    # A resolution by its own folder.
    level = path / ("1" if (path / "1").exists() else "s1")
    assert_is(info, mesh_of, level, labels[:, ::2, ::2], affine_of(1), **names)


@pytest.mark.parametrize("version", [2, 3])
def test_the_labels_of_an_image(info, mesh_of, tmp_path, version):
    labels = labels_of("uint64")
    path = tmp_path / "image.zarr"
    image = np.full(labels.shape, 9.5, np.float32)
    write_image(path, [image], version, labels=[("cells", [labels])])
    names = dict(unit="um", frame="unnamed")
    assert_is(info, mesh_of, path, labels, affine_of(0), **names)
    assert_is(info, mesh_of, path / "labels" / "cells", labels, affine_of(0), **names)
    # A folder whose name ends otherwise, named from within or with a slash.
    other = tmp_path / "renamed"
    shutil.copytree(path, other)
    assert_is(info, mesh_of, f"{other}/", labels, affine_of(0), **names)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("axes", ["tczyx", "czyx"])
def test_axes_of_length_one(info, mesh_of, tmp_path, version, axes):
    labels = labels_of()
    path = tmp_path / "image.zarr"
    pixels = labels.reshape((1,) * (len(axes) - 3) + labels.shape)
    write_image(path, [pixels], version, axes=axes, unit="nanometer")
    assert_is(info, mesh_of, path, labels, affine_of(0), unit="nm", frame="unnamed")


def test_units_of_a_plane(info, tmp_path):
    pixels = labels_of()[4]
    path = tmp_path / "plane.zarr"
    write_image(path, [pixels], 3, axes="yx", unit="millimeter")
    told = info(path)
    assert told["dims"] == [*pixels.shape[::-1], 1]
    assert told["spacing"] == [0.5, 0.75, 0.5] and told["unit"] == "mm"
    assert told["inside"] == int((pixels > 0).sum())


@pytest.mark.parametrize("axes, turn", [("zyx", (0, 1, 2)), ("xyz", (2, 1, 0))])
def test_axes_of_plain_arrays(info, mesh_of, tmp_path, axes, turn):
    labels = labels_of()
    path = tmp_path / "plain.zarr"
    pixels = labels.transpose(turn)
    zarr.create_array(path, data=pixels, chunks=(4, 5, 3))
    assert_is(info, mesh_of, path, labels, options=["--axes", axes])


def test_named_axes(info, mesh_of, tmp_path):
    labels = labels_of()
    path = tmp_path / "plain.zarr"
    array = zarr.create_array(
        path, shape=labels.transpose(1, 2, 0).shape, dtype="u1", chunks=(4, 5, 3), dimension_names=["y", "x", "z"]
    )
    array[:] = labels.transpose(1, 2, 0)
    assert_is(info, mesh_of, path, labels)
