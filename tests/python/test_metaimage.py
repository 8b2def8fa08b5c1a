"""MetaImage files written by SimpleITK: the values and the place of every voxel are ITK's."""

import json

import numpy as np
import pytest
import SimpleITK as sitk

from judge import assert_separates, sample_volume

TURN = np.linalg.qr(np.array([[0.9, 0.3, 0.05], [-0.35, 1.1, 0.45], [0.1, -0.4, 2.2]]))[0]
SPACING = (0.5, 1.25, 2.5)
ORIGIN = (-12.5, 40.25, 7.0)


def image(values, turn=TURN, spacing=SPACING, origin=ORIGIN):
    """An image of ITK from values indexed x, y, z."""
    made = sitk.GetImageFromArray(np.ascontiguousarray(values.T))
    made.SetDirection(turn.ravel().tolist())
    made.SetSpacing(spacing)
    made.SetOrigin(origin)
    return made


def affine_of(made):
    """Index to world, as ITK computes it."""
    origin = np.array(made.TransformContinuousIndexToPhysicalPoint([0.0, 0.0, 0.0]))
    steps = [
        np.array(made.TransformContinuousIndexToPhysicalPoint(step.tolist())) - origin
        for step in np.eye(3)
    ]
    affine = np.eye(4)
    affine[:3, :3] = np.stack(steps, 1)
    affine[:3, 3] = origin
    return affine


def assert_same(shrouds, path):
    """The program and ITK tell the same of a file."""
    told = json.loads(shrouds("info", path, "--json"))
    made = sitk.ReadImage(str(path))
    assert tuple(told["dims"]) == made.GetSize()
    assert np.allclose(told["affine"], affine_of(made)[:3], rtol=0, atol=1e-6 * min(SPACING))
    labels, counts = np.unique(sitk.GetArrayViewFromImage(made), return_counts=True)
    expected = list(zip(labels.tolist(), counts.tolist(), strict=True))
    assert [(entry["label"], entry["voxels"]) for entry in told["labels"]] == expected


@pytest.mark.parametrize("name", ["a.mha", "a.mhd"])
@pytest.mark.parametrize("compressed", [False, True])
def test_the_mesh_lies_where_itk_places_the_image(mesh_of, shrouds, tmp_path, name, compressed):
    inside = sample_volume()
    made = image(inside.astype(np.uint8) * 3)
    sitk.WriteImage(made, str(tmp_path / name), compressed)
    assert_same(shrouds, tmp_path / name)
    assert_separates(mesh_of(tmp_path / name), affine_of(made), inside)


@pytest.mark.parametrize(
    "dtype", ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32"]
)
def test_number_types(shrouds, tmp_path, dtype):
    values = (np.arange(60).reshape(5, 4, 3) % 7).astype(dtype)
    turn = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 1.0]])
    sitk.WriteImage(image(values, turn), str(tmp_path / "a.mha"))
    assert_same(shrouds, tmp_path / "a.mha")


@pytest.mark.parametrize(
    "fields",
    [
        "ElementSize = 2 3 4\n",
        "ElementSize = 2 3 4\nElementSpacing = 1 1 5\n",
        "ElementSpacing = 1 -1 5\nOffset = 1 2 3\n",
        "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nElementSpacing = 1 2 3\nCenterOfRotation = 4 5 6\n",
        "Rotation = 0 1 0 -1 0 0 0 0 1\nPosition = 7 8 9\nOffset = 1 2 3\n",
        "Orientation = 0 0 1 0 1 0 -1 0 0\nOffset = 7 8 9\nOrigin = 1 2 3\n",
        "ImagePosition = 7 8 9\nOffset = 1 2 3\nOrigin = 4 5 6\n",
        "Orientation = 0 1 0 -1 0 0 0 0 1\nTransformMatrix = 0 0 1 0 1 0 -1 0 0\n",
        "AnatomicalOrientation = LPS\nTransformMatrix = 0 0 1 1 0 0 0 1 0\n",
        "ElementByteOrderMSB = True\n",
        "BinaryDataByteOrderMSB = False\nElementByteOrderMSB = True\n",
        "HeaderSize = -1\n",
    ],
)
def test_fields_for_the_same_thing(shrouds, tmp_path, fields):
    path = tmp_path / "a.mha"
    start = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_USHORT\n"
    values = np.arange(24, dtype="<u2").tobytes()
    path.write_bytes((start + fields + "ElementDataFile = LOCAL\n").encode() + values)
    assert_same(shrouds, path)


def test_slices_in_a_list_and_by_a_pattern(shrouds, tmp_path):
    for n in range(1, 4):
        (tmp_path / f"slice{n:02}.raw").write_bytes(bytes(range(4 * n, 4 * n + 8)))
    start = "NDims = 3\nDimSize = 4 2 3\nElementType = MET_UCHAR\nElementDataFile = "
    names = "\n".join(f"slice{n:02}.raw" for n in (1, 2, 3))
    for data in (f"LIST\n{names}\n", "slice%02d.raw 1 3 1\n"):
        path = tmp_path / "a.mhd"
        path.write_text("ObjectType = Image\n" + start + data)
        assert_same(shrouds, path)
