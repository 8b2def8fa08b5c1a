"""VTK image data written by VTK: every mode of its writer, points and cells."""

import numpy as np
import pytest
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from judge import assert_separates, sample_volume

TURN = np.array([[0.0, -1.0, 0.0], [0.8, 0.0, -0.6], [0.6, 0.0, 0.8]])
SPACING = np.array([0.5, 1.25, 2.0])
ORIGIN = np.array([-12.5, 40.25, 7.0])
START = np.array([3, -4, 10])


def image(inside, dtype, cells=False):
    """An image whose extent does not begin at 0, and the affine of its values."""
    data = vtk.vtkImageData()
    last = START + np.array(inside.shape) - (0 if cells else 1)
    data.SetExtent(*np.column_stack([START, last]).ravel().tolist())
    data.SetOrigin(*ORIGIN)
    data.SetSpacing(*SPACING)
    data.SetDirectionMatrix(*TURN.ravel())
    values = numpy_to_vtk(inside.astype(dtype).ravel(order="F"), deep=True)
    values.SetName("labels")
    attributes = data.GetCellData() if cells else data.GetPointData()
    attributes.SetScalars(values)
    affine = np.eye(4)
    affine[:3, :3] = TURN * SPACING
    affine[:3, 3] = ORIGIN + affine[:3, :3] @ (START + (0.5 if cells else 0.0))
    return data, affine


def write(path, data, mode="appended", encode=False, compressor="zlib", wide=True, big=False):
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    {
        "ascii": writer.SetDataModeToAscii,
        "binary": writer.SetDataModeToBinary,
        "appended": writer.SetDataModeToAppended,
    }[mode]()
    writer.SetEncodeAppendedData(encode)
    {"none": writer.SetCompressorTypeToNone, "zlib": writer.SetCompressorTypeToZLib}[compressor]()
    (writer.SetHeaderTypeToUInt64 if wide else writer.SetHeaderTypeToUInt32)()
    (writer.SetByteOrderToBigEndian if big else writer.SetByteOrderToLittleEndian)()
    writer.SetBlockSize(512)
    assert writer.Write()


@pytest.mark.parametrize(
    "mode, encode", [("ascii", False), ("binary", False), ("appended", False), ("appended", True)]
)
@pytest.mark.parametrize("compressor", ["none", "zlib"])
@pytest.mark.parametrize("wide, big", [(False, False), (True, False), (True, True)])
def test_modes(mesh_of, tmp_path, mode, encode, compressor, wide, big):
    inside = sample_volume()
    data, affine = image(inside, np.int16)
    path = tmp_path / "volume.vti"
    write(path, data, mode, encode, compressor, wide, big)
    assert_separates(mesh_of(path), affine, inside)


@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint32", "int64", "float32", "float64"])
def test_number_types(mesh_of, tmp_path, dtype):
    inside = sample_volume()
    data, affine = image(inside, dtype)
    path = tmp_path / "volume.vti"
    write(path, data)
    assert_separates(mesh_of(path), affine, inside)


@pytest.mark.parametrize("mode", ["ascii", "appended"])
def test_cells(mesh_of, tmp_path, mode):
    inside = sample_volume()
    data, affine = image(inside, np.uint8, cells=True)
    path = tmp_path / "volume.vti"
    write(path, data, mode)
    assert_separates(mesh_of(path), affine, inside)
