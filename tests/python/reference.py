"""What the reference reader of each format finds in a volume file.

Arrays are indexed [i, j, k] along x, y, z; affines map these indices to the world of the file.
"""

import io
from dataclasses import dataclass, field

import nibabel
import nrrd
import numpy as np

SEGMENTATION = ("1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7")


class NoVolume(Exception):
    """The file holds no volume of real numbers, or one of a format that is not read."""


@dataclass
class Layer:
    """One volume of a file: a frame of a series, or a segmentation with all its segments."""

    values: np.ndarray
    affine: np.ndarray
    options: tuple = ()
    """What the program is told to read this one."""
    segments: dict = field(default_factory=dict)
    """Voxels by the name of the segment, where the file has names."""
    turned: bool = False
    """Whether the axes of the program may be turned against these, voxels staying in place."""


def read(path):
    """The layers of a volume file to compare: all, or the first and the last of a series."""
    name = path.name.lower()
    for ending, reader in READERS.items():
        if name.endswith(ending):
            return reader(path)
    raise NoVolume(f"no volume of a format that is read: {path.suffix}")


def nifti(path):
    try:
        image = nibabel.load(path)
        values = np.asanyarray(image.dataobj)
    except (nibabel.filebasedimages.ImageFileError, FileNotFoundError) as error:
        raise NoVolume(str(error)) from error
    if not isinstance(image, nibabel.Nifti1Pair):
        raise NoVolume(f"a {type(image).__name__}")
    if values.dtype.fields or np.iscomplexobj(values):
        raise NoVolume(f"values of type {values.dtype}")
    return frames(values, image.affine)


def frames(values, affine):
    """The first and the last volume of an array with more than three axes."""
    values = values.reshape(*values.shape[:3], -1, order="F")
    last = values.shape[3] - 1
    if last <= 0:
        return [Layer(values[..., 0], affine)]
    return [Layer(values[..., n], affine, ("--frame", n)) for n in (0, last)]


def nrrd_file(path):
    """Axes of a list (of segments that overlap) come before those of space."""
    values, header = nrrd.read(str(path))
    affine, spatial = nrrd_affine(header)
    values = np.moveaxis(values, np.flatnonzero(~spatial), np.arange((~spatial).sum()))
    values = values.reshape(-1, *values.shape[-3:])
    segments = nrrd_segments(header, values)
    if len(values) > 1 and not segments:
        return frames(np.moveaxis(values, 0, 3), affine)
    all_layers = values[0] if len(values) == 1 else values.any(0)
    return [Layer(all_layers, affine, segments=segments)]


def nrrd_affine(header):
    """The affine, and which axes are those of space."""
    affine = np.eye(4)
    if "space directions" not in header:
        affine[range(3), range(3)] = header.get("spacings", 1)
        return affine, np.full(3, True)
    spatial = np.isfinite(header["space directions"]).all(1)
    affine[:3, :3] = header["space directions"][spatial].T
    affine[:3, 3] = header.get("space origin", 0)
    return affine, spatial


def nrrd_segments(header, layers):
    """Voxels by name, as 3D Slicer writes the segments into the header."""
    voxels = {}
    for key in (key for key in header if key.endswith("_LabelValue")):
        segment = key.removesuffix("_LabelValue")
        layer = layers[int(header.get(f"{segment}_Layer", 0))]
        label = int(header[key])
        voxels[header[f"{segment}_Name"]] = int((layer == label).sum())
    return voxels


def itk(path):
    """The same file by ITK, which has one world for all formats: LPS."""
    import SimpleITK

    image = SimpleITK.ReadImage(str(path))
    if image.GetDimension() != 3 or image.GetNumberOfComponentsPerPixel() != 1:
        raise NoVolume(f"{image.GetDimension()} axes")
    affine = np.eye(4)
    affine[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing()
    affine[:3, 3] = image.GetOrigin()
    return Layer(SimpleITK.GetArrayFromImage(image).T, affine)


def vti(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    scalars, dims, first = image.GetPointData().GetScalars(), image.GetDimensions(), 0
    if scalars is None:  # a cell is a voxel, and its centre the lattice point
        scalars, first = image.GetCellData().GetScalars(), 0.5
        dims = [max(n - 1, 1) for n in dims]
    if scalars is None or scalars.GetNumberOfComponents() != 1:
        raise NoVolume("no array of scalars")
    directions = image.GetDirectionMatrix()
    turn = [[directions.GetElement(r, c) for c in range(3)] for r in range(3)]
    affine = np.eye(4)
    affine[:3, :3] = np.array(turn) * image.GetSpacing()
    affine[:3, 3] = image.GetOrigin() + affine[:3, :3] @ np.add(image.GetExtent()[::2], first)
    return [Layer(vtk_to_numpy(scalars).reshape(dims, order="F"), affine)]


def tiff(path):
    """ImageJ gives the distance of pages, TIFF itself those of pixels."""
    import tifffile

    with tifffile.TiffFile(path) as file:
        values, page = file.asarray(), file.pages[0]
        if values.ndim not in (2, 3) or page.samplesperpixel != 1:
            raise NoVolume(f"an array of shape {values.shape}")
        described = file.imagej_metadata or {}
        spacing = [pixel_spacing(page, "XResolution"), pixel_spacing(page, "YResolution")]
        if not described:
            spacing = [1, 1]
    affine = np.diag([*spacing, described.get("spacing", 1), 1]).astype(float)
    return [Layer(values.reshape(-1, *values.shape[-2:]).T, affine)]


def pixel_spacing(page, tag):
    count, length = page.tags[tag].value if tag in page.tags else (1, 1)
    return length / count if count else 1


def npy(path):
    values = np.load(path)
    if values.ndim > 3 and values.shape[-1] == 1:
        values = values[..., 0]  # a channel
    if values.ndim != 3:
        raise NoVolume(f"an array of shape {values.shape}")
    return [Layer(values.T, np.eye(4))]


def npz(path):
    with np.load(path) as archive:
        if not any(archive[name].ndim == 3 for name in archive):
            raise NoVolume("no array with three axes")
        raise NotImplementedError("there was no such file")


def dicom(path):
    """Segmentations; images and all the rest of DICOM are refused."""
    import highdicom
    import pydicom

    data = pydicom.dcmread(path, stop_before_pixels=True, force=True)
    if data.get("SOPClassUID") not in SEGMENTATION:
        raise NoVolume(f"{data.get('SOPClassUID')} is no segmentation")
    segmentation = highdicom.seg.segread(little_endian(path))
    volume = segmentation.get_volume(combine_segments=False, rescale_fractional=False)
    # Indexed [slice, row, column, segment]: x is the column.
    masks = np.moveaxis(volume.array, 3, 0).transpose(0, 3, 2, 1)
    affine = volume.affine[:, [2, 1, 0, 3]]
    names = [item.SegmentLabel for item in segmentation.SegmentSequence]
    counts = {name: int(mask.sum()) for name, mask in zip(names, masks, strict=True)}
    return [Layer(masks.any(0), affine, segments=counts, turned=True)]


def little_endian(path):
    """The file for highdicom, which takes no big endian."""
    import pydicom

    data = pydicom.dcmread(path)
    if data.file_meta.TransferSyntaxUID.is_little_endian:
        return path
    assert data["PixelData"].VR == "OB", "bytes have no order"
    data.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    file = io.BytesIO()
    pydicom.dcmwrite(file, data, implicit_vr=False, little_endian=True, enforce_file_format=True)
    file.seek(0)
    return file


READERS = {
    ".nii": nifti,
    ".nii.gz": nifti,
    ".hdr": nifti,
    ".nrrd": nrrd_file,
    ".nhdr": nrrd_file,
    ".vti": vti,
    ".tif": tiff,
    ".tiff": tiff,
    ".npy": npy,
    ".npz": npz,
    ".dcm": dicom,
}
VOLUMES = (*READERS, ".mgz", ".mgh", ".mha", ".mhd", ".img")
