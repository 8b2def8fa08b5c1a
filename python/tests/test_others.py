"""Checks, measures, comparisons and volumes, against the program and other tools."""

import json
import warnings

import nibabel
import numpy as np
import pytest
import trimesh
from scipy import ndimage

import shrouds


def test_check_finds_what_is_wrong(program, body, tmp_path):
    made = shrouds.shroud(body)
    assert shrouds.check(made, body)["checks"]["ok"]
    moved = shrouds.check((made.vertices + 1, made.faces), body)
    assert moved["checks"]["wrong_side"] > 0 and not moved["checks"]["ok"]
    holed = shrouds.check((made.vertices, made.faces[1:]), body)
    assert holed["checks"]["boundary_edges"] == 3
    inverted = shrouds.check((made.vertices, made.faces[:, ::-1]), body)
    assert inverted["checks"]["inverted"]
    np.save(tmp_path / "body.npy", body)
    made.save(tmp_path / "body.ply")
    theirs = json.loads(
        program("check", tmp_path / "body.ply", "--volume", tmp_path / "body.npy", "--json")
    )
    ours = shrouds.check(made, body)
    assert all(theirs[name] == value for name, value in ours.items())


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (np.zeros((3, 2)), [[0, 1, 2]], r"shape \(n, 3\)"),
        (np.zeros((3, 3)), [[0, 1]], r"shape \(m, 3\)"),
        (np.zeros((3, 3)), [[0.0, 1, 2]], "whole numbers"),
        (np.zeros((3, 3)), [[0, 1, 3]], "beyond the 3"),
        (np.zeros((3, 3)), [[0, 1, -1]], "beyond the 3"),
        (np.full((3, 3), np.nan), [[0, 1, 2]], "all must be below"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, faces, message):
    with pytest.raises(ValueError, match=message):
        shrouds.check((vertices, faces), np.zeros((3, 3, 3), bool))


def test_measures_are_those_of_the_program(program, body, tmp_path):
    np.save(tmp_path / "body.npy", body)
    theirs = json.loads(program("measure", tmp_path / "body.npy", "--json"))["rows"][0]
    made = shrouds.shroud(body, preset="exact")
    ours = shrouds.measure(made)
    assert ours.keys() == theirs.keys() - {"label", "name", "component"}
    for name, value in ours.items():
        if name == "notes":
            continue
        assert value == pytest.approx(theirs[name], rel=1e-3, abs=1e-4), name
    mesh = made.to_trimesh()
    of_mesh = shrouds.measure(mesh)
    assert of_mesh["triangle_volume"] == pytest.approx(mesh.volume, rel=1e-9)
    assert of_mesh["triangle_area"] == pytest.approx(mesh.area, rel=1e-9)


def test_comparisons_are_those_of_the_program(program, body, tmp_path):
    np.save(tmp_path / "body.npy", body)
    energies = ["bending", "curvature(chord)"]
    printed = program(
        "compare", tmp_path / "body.npy", "--json",
        "--energies", ";".join(energies),
    )  # fmt: skip
    theirs = {row["energy"]: row for row in json.loads(printed)["energies"]}
    for ours in shrouds.compare(body, energies):
        row = theirs[ours["energy"]]
        assert ours.keys() <= row.keys()
        for name in ours.keys() - {"seconds", "value", "projected_step"}:
            expected = row[name]
            if isinstance(expected, float):
                expected = pytest.approx(expected, rel=1e-3, abs=1e-6)
            assert ours[name] == expected, name


def test_boolean_operations_are_those_of_numpy(body):
    other = np.roll(body, 5, axis=2)
    for operation, expected in [
        ("union", body | other),
        ("intersect", body & other),
        ("subtract", body & ~other),
        ("xor", body ^ other),
    ]:
        made = shrouds.combine(operation, body, other)
        assert made.values.dtype == bool and np.array_equal(made.values, expected)
    with pytest.raises(ValueError, match="union, intersect, subtract, xor"):
        shrouds.combine("minus", body, other)
    with pytest.raises(ValueError, match="different lattices"):
        shrouds.combine("union", body, shrouds.Volume(other, np.diag([2, 2, 2, 1])))


def test_offsets_are_those_of_scipy(body):
    spacing = (0.5, 0.75, 1.25)
    within = ndimage.distance_transform_edt(~body, sampling=spacing[::-1])
    grown = shrouds.offset(body, 1.6, spacing=spacing, keep_lattice=True)
    assert np.array_equal(grown.values, within <= 1.6)
    wide = shrouds.offset(body, 4, spacing=spacing)
    assert wide.values.shape > body.shape and wide.axes == "zyx"
    turned = shrouds.offset(body.transpose(), 1.6, spacing=spacing, axes="xyz", keep_lattice=True)
    assert np.array_equal(turned.values.transpose(), grown.values)


def test_voxels_come_back_from_the_mesh(body):
    affine = np.array([[0, -0.5, 0, 3], [0.7, 0, 0.1, -4], [0, 0, 1.5, 9], [0, 0, 0, 1.0]])
    for axes, values in (("zyx", body), ("xyz", body.transpose())):
        place = shrouds.Volume(values, affine, axes, "RAS", "mm")
        again = shrouds.voxelize(shrouds.shroud(place), like=place)
        assert np.array_equal(again.values, values)
        assert (again.axes, again.frame, again.unit) == (axes, "RAS", "mm")
        assert np.array_equal(again.affine, affine)
    box = trimesh.creation.box((4, 6, 8))
    assert shrouds.voxelize(box, spacing=1).values.sum() == 192
    assert max(shrouds.voxelize(box, size=20).values.shape) == 20
    with pytest.raises(ValueError, match="one of size, spacing and like"):
        shrouds.voxelize(box)
    with pytest.warns(UserWarning, match="edges with one triangle"):
        shrouds.voxelize((box.vertices, box.faces[1:]), spacing=1)


def test_packed_volumes_come_back(program, body, tmp_path):
    volume = shrouds.Volume(body, np.diag([0.5, 0.75, 1.25, 1]), "zyx", "RAS", "mm")
    for profile in ("fast", "dense"):
        packed = shrouds.pack(volume, profile=profile)
        again = shrouds.unpack(packed)
        assert np.array_equal(again.values, body) and np.array_equal(again.affine, volume.affine)
        assert (again.frame, again.unit) == ("RAS", "mm")
    (tmp_path / "body.shroud").write_bytes(packed)
    program("unpack", tmp_path / "body.shroud", "-o", tmp_path / "body.npy")
    assert np.array_equal(np.load(tmp_path / "body.npy").astype(bool), body)
    for damaged in (b"", b"no", packed[:-3], packed[:50] + b"x" + packed[51:]):
        with pytest.raises(ValueError):
            shrouds.unpack(damaged)


def test_files_are_read_as_nibabel_reads_them(body, tmp_path):
    affine = np.array([[-0.5, 0, 0, 30], [0, 0.75, 0, -40], [0, 0.1, 1.25, 7], [0, 0, 0, 1]])
    image = nibabel.Nifti1Image(body.transpose().astype(np.uint8), affine)
    image.header.set_xyzt_units("mm")
    image.set_sform(affine, 1)
    nibabel.save(image, tmp_path / "body.nii.gz")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        volume = shrouds.read_volume(tmp_path / "body.nii.gz")
    assert np.array_equal(volume.values, body) and volume.values.dtype == np.uint8
    assert (volume.frame, volume.unit) == ("RAS", "mm")
    loaded = nibabel.load(tmp_path / "body.nii.gz")
    ours = shrouds.shroud(volume)
    theirs = shrouds.shroud(np.asarray(loaded.dataobj), affine=loaded.affine, axes="xyz")
    assert np.array_equal(ours.vertices, theirs.vertices)
    assert ours.report["input"]["frame"] == "RAS"
    assert ours.to_trimesh().volume > 0


def test_files_that_are_none(tmp_path):
    with pytest.raises(FileNotFoundError, match="check the path"):
        shrouds.read_volume(tmp_path / "nothing.nii")
    with pytest.raises(ValueError, match="not a known kind of volume"):
        shrouds.read_volume(tmp_path / "nothing.xyz")
    (tmp_path / "damaged.nii.gz").write_bytes(b"\x1f\x8b\x08damaged")
    with pytest.raises(OSError, match="damaged"):
        shrouds.read_volume(tmp_path / "damaged.nii.gz")
    with pytest.raises(FileNotFoundError):
        shrouds.read_mesh(tmp_path / "nothing.ply")


def test_meshes_are_read(body, tmp_path):
    made = shrouds.shroud(body)
    made.save(tmp_path / "body.ply")
    vertices, faces = shrouds.read_mesh(tmp_path / "body.ply")
    assert np.array_equal(vertices, made.vertices) and np.array_equal(faces, made.faces)
