"""DICOM segmentations written by highdicom: voxels and their places are those that went in."""

import json
import subprocess

import highdicom as hd
import numpy as np
import pydicom
import pytest
from highdicom.content import PixelMeasuresSequence, PlaneOrientationSequence, PlanePositionSequence
from pydicom.pixels.utils import pack_bits
from pydicom.sr.codedict import codes
from pydicom.uid import (
    DeflatedExplicitVRLittleEndian,
    ExplicitVRLittleEndian,
    ImplicitVRLittleEndian,
    RLELossless,
)

from judge import assert_separates, sample_volume

ROTATION = np.linalg.qr(np.array([[0.9, 0.2, -0.1], [-0.25, 1.0, 0.3], [0.1, -0.3, 0.95]]))[0]
ROTATION *= np.sign(np.linalg.det(ROTATION))
SPACING = np.array([0.7, 1.3, 2.5])  # between columns, rows, slices
ORIGIN = np.array([-120.5, 33.25, 410.0])
COLUMN, ROW, NORMAL = ROTATION.T


def frame(spacing=SPACING):
    """Maps column, row, slice to LPS millimetres."""
    affine = np.eye(4)
    affine[:3, :3] = ROTATION * spacing
    affine[:3, 3] = ORIGIN
    return affine


def source_image():
    """As much of a CT slice as a segmentation has to refer to."""
    image = pydicom.Dataset()
    image.file_meta = pydicom.dataset.FileMetaDataset()
    image.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    image.SOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    image.Modality = "CT"
    for name in ["SOPInstanceUID", "SeriesInstanceUID", "StudyInstanceUID", "FrameOfReferenceUID"]:
        setattr(image, name, hd.UID())
    for name in ["PatientID", "PatientName", "PatientBirthDate", "PatientSex", "StudyID"]:
        setattr(image, name, "")
    for name in ["StudyDate", "StudyTime", "AccessionNumber", "ReferringPhysicianName"]:
        setattr(image, name, "")
    image.Rows, image.Columns, image.SamplesPerPixel = 4, 4, 1
    image.BitsAllocated = image.BitsStored = 16
    image.ImagePositionPatient, image.ImageOrientationPatient = [0, 0, 0], [1, 0, 0, 0, 1, 0]
    image.PixelSpacing, image.SliceThickness = [1, 1], 1
    return image


def description(number, name):
    return hd.seg.SegmentDescription(
        segment_number=number,
        segment_label=name,
        segmented_property_category=codes.SCT.Organ,
        segmented_property_type=codes.SCT.Liver,
        algorithm_type="MANUAL",
    )


def segmentation(pixels, kind, names, places=None, between=SPACING[2], **more):
    """`pixels` are indexed slice, row, column, and segment unless they are labels."""
    places = range(len(pixels)) if places is None else places
    positions = [ORIGIN + k * SPACING[2] * NORMAL for k in places]
    return hd.seg.Segmentation(
        source_images=[source_image()],
        pixel_array=pixels,
        segmentation_type=kind,
        segment_descriptions=[description(n, name) for n, name in names.items()],
        series_instance_uid=hd.UID(),
        series_number=1,
        sop_instance_uid=hd.UID(),
        instance_number=1,
        manufacturer="none",
        manufacturer_model_name="none",
        software_versions="1",
        device_serial_number="1",
        plane_positions=[PlanePositionSequence("PATIENT", p) for p in positions],
        plane_orientation=PlaneOrientationSequence("PATIENT", [*COLUMN, *ROW]),
        pixel_measures=PixelMeasuresSequence(
            pixel_spacing=[SPACING[1], SPACING[0]],
            slice_thickness=SPACING[2],
            spacing_between_slices=between,
        ),
        **more,
    )


@pytest.fixture
def info(shrouds):
    return lambda path: json.loads(shrouds("info", path, "--json", "--quiet"))


def assert_labels(info, labels, affine):
    """`labels` are indexed slice, row, column."""
    assert info["dims"] == list(labels.shape[::-1])
    values, counts = np.unique(labels, return_counts=True)
    expected = dict(zip(values.tolist(), counts.tolist()))
    assert {entry["label"]: entry["voxels"] for entry in info["labels"]} == expected
    assert np.abs(np.array(info["affine"]) - affine[:3]).max() < 1e-6 * SPACING.min()
    assert (info["frame"], info["unit"]) == ("LPS", "mm")


def labels_of(inside):
    """Three labels in a volume indexed x, y, z; indexed z, y, x."""
    pattern = 1 + np.add.outer(np.arange(inside.shape[0]), np.arange(inside.shape[1])) % 3
    labels = (inside * pattern[:, :, None]).T.astype(np.uint8)
    labels[[0, -1], 0, 0] = 1  # frames without a voxel are not stored
    return labels


NAMES = {1: "one", 2: "zwei äöü", 3: "three"}


@pytest.mark.parametrize("dims", [(5, 7, 9), (13, 11, 9), (16, 8, 4)])
@pytest.mark.parametrize("syntax", [ExplicitVRLittleEndian, ImplicitVRLittleEndian])
def test_binary_frames_that_start_within_bytes(info, mesh_of, tmp_path, dims, syntax):
    labels = labels_of(sample_volume(dims))
    path = tmp_path / "binary.dcm"
    segmentation(labels, "BINARY", NAMES, transfer_syntax_uid=syntax).save_as(path)
    assert_labels(info(path), labels, frame())
    assert_separates(mesh_of(path), frame(), labels.T > 0)
    assert_separates(mesh_of(path, "--label", 2), frame(), labels.T == 2)


@pytest.mark.parametrize(
    "syntax", [ExplicitVRLittleEndian, ImplicitVRLittleEndian, RLELossless, "deflated"]
)
@pytest.mark.parametrize("kind", ["FRACTIONAL", "LABELMAP"])
def test_other_kinds(info, mesh_of, tmp_path, kind, syntax):
    labels = labels_of(sample_volume())
    path = tmp_path / "other.dcm"
    deflated = syntax == "deflated"
    syntax = ExplicitVRLittleEndian if deflated else syntax
    seg = segmentation(labels, kind, NAMES, transfer_syntax_uid=syntax)
    if deflated:
        seg.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
    seg.save_as(path)
    assert_labels(info(path), labels, frame())
    assert_separates(mesh_of(path), frame(), labels.T > 0)


@pytest.mark.parametrize("syntax", [ExplicitVRLittleEndian, RLELossless])
def test_labels_of_two_bytes(info, tmp_path, syntax):
    labels = labels_of(sample_volume()).astype(np.uint16) * 300
    names = {300 * number: name for number, name in NAMES.items()}
    path = tmp_path / "wide.dcm"
    segmentation(labels, "LABELMAP", names, transfer_syntax_uid=syntax).save_as(path)
    assert_labels(info(path), labels, frame())


def test_fractions_count_from_a_half_on(info, tmp_path):
    fractions = np.linspace(0, 1, 5 * 6 * 7).reshape(5, 6, 7)
    path = tmp_path / "fractional.dcm"
    seg = segmentation(fractions, "FRACTIONAL", {1: "one"}, max_fractional_value=200)
    seg.save_as(path)
    stored = seg.pixel_array.astype(int)
    # A first frame of zeros alone may be left out; the values rise from frame to frame.
    assert info(path)["inside"] == int((2 * stored >= 200).sum())


def test_segments_that_overlap(mesh_of, tmp_path):
    one, two = sample_volume(seed=1), sample_volume(seed=2)
    pixels = np.stack([one.T, two.T], -1).astype(np.uint8)
    path = tmp_path / "overlap.dcm"
    segmentation(pixels, "BINARY", {1: "one", 2: "two"}).save_as(path)
    assert (one & two).any()
    assert_separates(mesh_of(path), frame(), one | two)
    assert_separates(mesh_of(path, "--label", 1), frame(), one)
    assert_separates(mesh_of(path, "--label", 2), frame(), two)


@pytest.mark.parametrize("kind", ["BINARY", "FRACTIONAL", "LABELMAP"])
def test_frames_in_any_order(info, mesh_of, tmp_path, kind):
    labels = labels_of(sample_volume())
    seg = segmentation(labels, kind, NAMES)
    order = np.random.default_rng(3).permutation(int(seg.NumberOfFrames))
    pixels = seg.pixel_array[order]
    seg.PixelData = pack_bits(pixels) if kind == "BINARY" else pixels.tobytes()
    groups = seg.PerFrameFunctionalGroupsSequence
    seg.PerFrameFunctionalGroupsSequence = pydicom.Sequence([groups[n] for n in order])
    path = tmp_path / "shuffled.dcm"
    seg.save_as(path)
    assert_labels(info(path), labels, frame())
    assert_separates(mesh_of(path, "--label", 3), frame(), labels.T == 3)


def test_slices_without_a_frame_are_empty(info, mesh_of, tmp_path):
    labels = labels_of(sample_volume())
    labels[[2, 3, 6]] = 0
    path = tmp_path / "gaps.dcm"
    seg = segmentation(labels, "BINARY", NAMES)
    assert seg.NumberOfFrames < labels.shape[0] * 3
    seg.save_as(path)
    assert_labels(info(path), labels, frame())
    assert_separates(mesh_of(path), frame(), labels.T > 0)


def test_distance_of_slices_from_their_positions(info, tmp_path):
    labels = labels_of(sample_volume())
    path = tmp_path / "positions.dcm"
    segmentation(labels, "BINARY", NAMES, between=None).save_as(path)
    assert_labels(info(path), labels, frame())
    segmentation(labels, "BINARY", NAMES, between=1.7).save_as(path)
    assert_labels(info(path), labels, frame())


def test_slices_in_falling_order(info, tmp_path):
    labels = labels_of(sample_volume())
    path = tmp_path / "falling.dcm"
    places = range(len(labels))[::-1]
    segmentation(labels[::-1], "BINARY", NAMES, places=places).save_as(path)
    assert_labels(info(path), labels, frame())


def test_the_volume_is_that_of_highdicom(info, tmp_path):
    labels = labels_of(sample_volume())
    labels[4] = 0
    path = tmp_path / "volume.dcm"
    segmentation(labels, "BINARY", NAMES).save_as(path)
    volume = hd.seg.segread(path).get_volume(combine_segments=True)
    ours = info(path)
    counts = {entry["label"]: entry["voxels"] for entry in ours["labels"]}
    values, expected = np.unique(volume.array, return_counts=True)
    assert counts == dict(zip(values.tolist(), expected.tolist()))
    # Its index runs along slices, rows, columns, and slices may run the other way.
    for k, j, i in [(0, 0, 0), (8, 10, 12), (3, 1, 7)]:
        own = k if np.dot(volume.affine[:3, 0], NORMAL) > 0 else volume.shape[0] - 1 - k
        theirs = volume.affine @ [own, j, i, 1]
        assert np.abs(np.array(ours["affine"]) @ [i, j, k, 1] - theirs[:3]).max() < 1e-6


def test_uneven_slices_are_refused(program, tmp_path):
    path = tmp_path / "uneven.dcm"
    pixels = np.ones((4, 5, 6), np.uint8)
    places = [0, 1, 2.4, 3.7]
    segmentation(pixels, "BINARY", {1: "one"}, places=places, between=None).save_as(path)
    done = subprocess.run([program, "info", path], capture_output=True, text=True)
    assert done.returncode == 1 and "from 2.5000 to 3.5000 mm apart" in done.stderr, done.stderr
