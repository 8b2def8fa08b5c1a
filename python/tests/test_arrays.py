"""Every kind of array gives the same surface, and none is copied."""

import subprocess
import sys
import tracemalloc

import numpy as np
import pytest

import shrouds

TYPES = ["bool", "u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8"]


def same(one, other):
    for name in ("vertices", "faces", "normals", "delta"):
        a, b = getattr(one, name), getattr(other, name)
        assert a.dtype == b.dtype and np.array_equal(a, b), name


@pytest.fixture(scope="module")
def made(body):
    return shrouds.shroud(body)


@pytest.mark.parametrize("dtype", TYPES + [">u2", ">i8", ">f4"])
def test_all_types(body, made, dtype):
    same(shrouds.shroud(body.astype(dtype)), made)


def strided(body):
    """A view in the midst of a larger array, with gaps along every axis."""
    nz, ny, nx = body.shape
    large = np.full((2 * nz + 3, 3 * ny + 1, 2 * nx + 5), 7, np.uint16)
    view = large[2 : 2 + 2 * nz : 2, 1 : 1 + 3 * ny : 3, 5 : 5 + 2 * nx : 2]
    view[...] = body
    return view


@pytest.mark.parametrize(
    "change",
    [
        np.asfortranarray,
        strided,
        lambda a: np.ascontiguousarray(a[::-1, ::-1, ::-1])[::-1, ::-1, ::-1],
        lambda a: np.ascontiguousarray(a.transpose(1, 0, 2)).transpose(1, 0, 2),
        lambda a: np.ascontiguousarray(a.transpose(0, 2, 1)).transpose(0, 2, 1),
        lambda a: np.asfortranarray(a.astype(np.int32))[:, :, :],
        lambda a: np.frombuffer(b"x" + a.astype("u4").tobytes(), np.uint8)[1:]
        .view("u4")
        .reshape(a.shape),
        lambda a: a.tolist(),
    ],
    ids=["Fortran", "strided", "reversed", "y slowest", "y fastest", "ints", "astride", "lists"],
)
def test_all_orders_in_memory(body, made, change):
    same(shrouds.shroud(change(body)), made)


def test_an_array_of_one_value_over_and_over():
    whole = np.broadcast_to(np.array([[[0], [1], [1], [0]]], np.uint8), (5, 4, 6))
    same(shrouds.shroud(whole), shrouds.shroud(whole.copy()))


def test_axes_are_turned_and_positions_are_not(body, made):
    same(shrouds.shroud(body.transpose(), axes="xyz"), made)
    same(shrouds.shroud(np.ascontiguousarray(body.transpose()), axes="xyz"), made)


def test_read_only_and_memory_mapped(body, made, tmp_path):
    array = body.copy()
    array.flags.writeable = False
    same(shrouds.shroud(array), made)
    np.save(tmp_path / "body.npy", body)
    same(shrouds.shroud(np.load(tmp_path / "body.npy", mmap_mode="r")), made)


def test_labels_and_thresholds(body):
    labels = np.where(body, 3, 0).astype(np.int64)
    labels[:20] *= -7
    for label, inside in [(3, labels == 3), ((3, -21), labels != 0), (0, labels == 0)]:
        same(shrouds.shroud(labels, label=label), shrouds.shroud(inside))
    big = np.where(body, np.uint64(2**64 - 1), np.uint64(2**64 - 2))
    same(shrouds.shroud(big, label=2**64 - 1), shrouds.shroud(body))
    same(shrouds.shroud(labels * 0.5, threshold=0.25), shrouds.shroud(labels > 0))
    same(shrouds.shroud(labels, label=np.array([3])), shrouds.shroud(labels == 3))


def test_bytes_of_bools_that_are_not_0_or_1(body):
    odd = (body * np.uint8(64)).view(bool)
    same(shrouds.shroud(odd), shrouds.shroud(body))


def test_spacing_origin_and_affine_agree(body):
    affine = [[0.5, 0, 0, -3], [0, 0.7, 0, 10], [0, 0, 2, 1], [0, 0, 0, 1]]
    placed = shrouds.shroud(body, spacing=(0.5, 0.7, 2), origin=(-3, 10, 1))
    same(placed, shrouds.shroud(body, affine=affine))
    volume = shrouds.Volume(body, np.array(affine))
    same(placed, shrouds.shroud(volume))
    turned = shrouds.Volume(body.transpose(), np.array(affine), "xyz")
    same(placed, shrouds.shroud(turned))


def test_far_from_the_origin_positions_have_64_bits(body):
    near, far = (shrouds.shroud(body, origin=(x, 0, 0)).vertices for x in (0, 1e5))
    assert near.dtype == np.float32 and far.dtype == np.float64
    assert np.abs(far - (1e5, 0, 0) - near).max() < 1e-5


NAN = np.zeros((3, 3, 3))
NAN[1, 2, 0] = np.nan


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        (np.float64(1), {}, r"shape \(\), but a volume has three dimensions"),
        (np.zeros((4, 4)), {}, "array.None. of a single slice"),
        (np.zeros((2, 3, 4, 5)), {}, "take one channel"),
        (np.zeros((0, 4, 4)), {}, "each dimension must lie between 1 and"),
        (np.zeros((4, 4, 4), object), {}, "holds object"),
        (np.zeros((4, 4, 4), complex), {}, "holds complex128"),
        (np.full((4, 4, 4), "a"), {}, "holds <U1"),
        (np.zeros((4, 4, 4), np.longdouble), {}, "at most 64 bits"),
        (np.zeros((4, 4, 4), "M8[s]"), {}, "datetime64"),
        (NAN, {}, r"voxel \[0, 2, 1\] \(x, y, z\) is not a number"),
        (NAN == 0, {"label": 1, "threshold": 2}, "not both"),
        (NAN == 0, {"label": 1.5}, "whole numbers"),
        (NAN == 0, {"threshold": np.nan}, "finite"),
        (NAN == 0, {"axes": "xzy"}, '"zyx" or "xyz"'),
        (NAN == 0, {"spacing": (1, 2)}, "three along x, y, z"),
        (NAN == 0, {"spacing": -1}, "positive"),
        (NAN == 0, {"affine": np.eye(3)}, r"\(4, 4\)"),
        (NAN == 0, {"affine": np.zeros((4, 4))}, "last row"),
        (NAN == 0, {"affine": np.zeros((3, 4))}, "axes independent"),
        (NAN == 0, {"affine": np.eye(4), "origin": (0, 0, 0)}, "leave those out"),
        (NAN == 0, {"threads": 0}, "between 1 and 1024"),
        (NAN == 0, {"border": "open", "surface": "dual"}, "closed for a dual mesh"),
        (shrouds.Volume(NAN == 0, np.eye(4)), {"spacing": 1}, "knows its place"),
    ],
)
def test_what_is_no_volume_is_refused(values, options, message):
    with pytest.raises(ValueError, match=message):
        shrouds.shroud(values, **options)


def test_numpy_makes_no_copy(gyroid, tmp_path):
    np.save(tmp_path / "gyroid.npy", gyroid)
    views = [
        gyroid,
        np.asfortranarray(gyroid),
        np.repeat(gyroid, 2, axis=2)[:, :, ::2],
        np.load(tmp_path / "gyroid.npy", mmap_mode="r"),
    ]
    for view in views:
        tracemalloc.start()
        shrouds.shroud(view, max_iterations=0)
        made = shrouds.shroud(view[:1], max_iterations=0)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert peak < gyroid.nbytes / 4 + 30 * len(made.vertices) or peak < 3 * 2**24


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells")
@pytest.mark.parametrize("order", ["C", "F"])
def test_nothing_as_large_as_the_array_is_made(order):
    """A ball of 20 voxels in 512³: bits are an eighth of a byte, and few of them are needed twice."""
    code = f"""
import numpy as np, shrouds
array = np.zeros((512, 512, 512), np.uint16, order={order!r})
array[:] = 0
array[240:260, 240:260, 240:260] = 1
def status(key):
    lines = open("/proc/self/status").read().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith(key))
shrouds.shroud(array[:64, :64, :64])
open("/proc/self/clear_refs", "w").write("5")
before = status("VmRSS")
made = shrouds.shroud(array)
assert len(made.vertices) > 1000
print((status("VmHWM") - before) / array.nbytes)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    # Bits, with a layer around them, and the numbers of the rows' vertices.
    assert float(done.stdout) < 0.35
