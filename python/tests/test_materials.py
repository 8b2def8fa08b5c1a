"""Interfaces between several labels, and every label measured, against the program and trimesh."""

import json

import numpy as np
import pytest
import shrouds
import trimesh

AFFINE = np.array([[0.5, 0, 0, 3], [0, 0, 0.75, 5], [0, -1.0, 0, 7], [0, 0, 0, 1]])


@pytest.fixture(scope="module")
def labels():
    """Three bodies that touch each other and the background, and one alone, indexed [z, y, x]."""
    z, y, x = np.mgrid[:24, :27, :30]
    values = np.zeros(z.shape, np.int32)
    ball = (x - 14.2) ** 2 + (y - 13.1) ** 2 + (z - 11.7) ** 2 < 81
    values[ball] = 5
    values[ball & (x + 0.3 * y > 18)] = 300
    values[ball & (z > 13) & (y > 12)] = -2
    values[2:4, 2:4, 2:9] = 9
    return values


def test_every_label_is_closed_and_holds_its_voxels(labels):
    made = shrouds.materials(labels, affine=AFFINE)
    assert made.labels == [-2, 5, 9, 300] and made.report["checks"]["wrong_label"] == 0
    for label, mesh in made.to_trimesh().items():
        assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
        inside = shrouds.voxelize(mesh, like=shrouds.Volume(labels, AFFINE))
        assert np.array_equal(inside.values, labels == label), label


def test_interfaces_are_there_once(labels):
    made = shrouds.materials(labels)
    assert {tuple(pair) for pair in np.unique(made.pairs, axis=0)} == {
        (-2, 0), (-2, 5), (-2, 300), (5, 0), (5, 300), (9, 0), (300, 0)
    }  # fmt: skip
    edges = np.sort(made.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    found, counts = np.unique(edges, axis=0, return_counts=True)
    assert set(map(tuple, np.sort(made.lines, axis=1))) == set(map(tuple, found[counts > 2]))
    with pytest.raises(ValueError, match="there is no label 4"):
        made.closed(4)


def test_labels_enclose_their_voxels(labels):
    made = shrouds.materials(labels, volume="keep")
    kept = made.report["solver"]["kept_volumes"]
    assert kept["labels"] == len(made.labels)
    assert kept["held"] == []
    assert kept["relative_error"] < 1e-9
    for label, mesh in made.to_trimesh().items():
        # Positions are handed out in single precision.
        assert mesh.volume == pytest.approx((labels == label).sum(), rel=1e-5), label


def test_files_and_report_are_those_of_the_program(program, labels, tmp_path):
    np.save(tmp_path / "labels.npy", labels)
    theirs = json.loads(
        program("mesh", tmp_path / "labels.npy", "--materials", "--json", "-o", tmp_path / "a.ply")
    )
    made = shrouds.materials(labels)
    made.save(tmp_path / "b.ply")
    ours = made.report
    for name in ("topology", "labels", "contacts", "checks", "solver"):
        assert ours[name] == theirs[name], name
    program("mesh", tmp_path / "labels.npy", "--materials", "-o", tmp_path / "folder")
    for label in made.labels:
        vertices, faces = shrouds.read_mesh(tmp_path / "folder" / f"label-{label}.ply")
        own = made.closed(label)
        assert np.array_equal(vertices.astype(np.float32), own[0])
        assert np.array_equal(faces, own[1])
    first, second = ((tmp_path / name).read_bytes() for name in ("a.ply", "b.ply"))
    end = b"end_header\n"
    assert first.split(end, 1)[1] == second.split(end, 1)[1]


def test_one_label_is_a_shroud(body):
    made, one = shrouds.materials(body), shrouds.shroud(body)
    assert np.array_equal(made.vertices, one.vertices) and np.array_equal(made.faces, one.faces)
    assert made.labels == [1] and not len(made.lines)


def test_what_are_no_labels_is_refused(labels):
    for call in (shrouds.materials, shrouds.measure_labels, shrouds.pack_labels):
        with pytest.raises(ValueError, match="whole numbers"):
            call(labels * 0.5)
    for call in (shrouds.materials, shrouds.pack_labels):
        with pytest.raises(ValueError, match="64 bits with a sign"):
            call(np.full((3, 3, 3), 2**64 - 1, np.uint64))
    with pytest.raises(ValueError, match="margin"):
        shrouds.materials(labels, margin=0.4)


def test_measures_of_labels_are_those_of_the_program(program, labels, tmp_path):
    np.save(tmp_path / "labels.npy", labels)
    call = ["measure", tmp_path / "labels.npy", "--labels", "all", "--json"]
    theirs = json.loads(program(*call, "--contacts"))
    ours = shrouds.measure_labels(labels, contacts=True)
    assert [row["label"] for row in ours["rows"]] == [row["label"] for row in theirs["rows"]]
    for row, other in zip(ours["rows"], theirs["rows"], strict=True):
        for name in ("volume", "area", "euler", "voxels", "thickness_mean"):
            if name in row:
                # Positions are of 32 bits here.
                assert row[name] == pytest.approx(other[name], rel=1e-6), name
    assert [(one["label"], one["other"]) for one in ours["contacts"]] == [
        (one["label"], one["other"]) for one in theirs["contacts"]
    ]
    for one, other in zip(ours["contacts"], theirs["contacts"], strict=True):
        assert one["area"] == pytest.approx(other["area"], rel=1e-9)
    parts = shrouds.measure_labels(labels, labels=[5], components=True)["rows"]
    others = json.loads(program(*call, "--components"))["rows"]
    others = [row for row in others if row["label"] == 5]
    assert [row["component"] for row in parts] == [row["component"] for row in others]
    assert [row["volume"] for row in parts] == pytest.approx([row["volume"] for row in others])


def test_components_of_a_mesh(labels):
    made = shrouds.shroud(labels, label=[9, 5, 300, -2])
    parts = shrouds.components(made)
    assert len(parts) == 2
    volumes = [trimesh.Trimesh(*part).volume for part in parts]
    assert sum(volumes) == pytest.approx(made.to_trimesh().volume)


def test_the_distance_to_another_surface(body):
    made = shrouds.shroud(body)
    moved = (made.vertices + np.float32([0, 0, 0.25]), made.faces)
    found = shrouds.measure(made, distance_to=moved)
    names = [name for name in found if "distance" in name]
    assert names and shrouds.measure(made).keys() < found.keys()
    assert 0 < max(found[name] for name in names if found[name] is not None) <= 0.25 + 1e-6


def test_packed_labels_come_back(program, labels, tmp_path):
    volume = shrouds.Volume(labels, AFFINE, frame="RAS", unit="mm")
    packed = shrouds.pack_labels(volume)
    again = shrouds.unpack(packed)
    assert np.array_equal(again.values, labels) and (again.frame, again.unit) == ("RAS", "mm")
    assert np.allclose(again.affine, AFFINE)
    np.save(tmp_path / "labels.npy", labels)
    program("pack", tmp_path / "labels.npy", "--labels", "all", "-o", tmp_path / "a.shroud")
    theirs = (tmp_path / "a.shroud").read_bytes()
    assert shrouds.pack_labels(labels) == theirs


@pytest.mark.parametrize("bits", [1, 4, 8])
def test_packed_places_come_back(body, bits):
    made = shrouds.shroud(body, preset="exact", spacing=(1, 2, 1))
    packed = made.pack(bits)
    again = shrouds.unpack_shroud(packed)
    assert abs(again.delta - made.delta).max() <= 2.0**-bits
    assert np.array_equal(again.faces.shape, made.faces.shape)
    assert again.report["checks"]["wrong_side"] == 0
    assert shrouds.unpack(packed).values.sum() == body.sum()


def test_places_of_packed_files_are_those_of_the_program(program, body, tmp_path):
    made = shrouds.shroud(body)
    (tmp_path / "a.shroud").write_bytes(made.pack(4))
    program("unpack", tmp_path / "a.shroud", "-o", tmp_path / "a.ply")
    vertices, faces = shrouds.read_mesh(tmp_path / "a.ply")
    again = shrouds.unpack_shroud(made.pack(4))
    assert np.array_equal(vertices.astype(np.float32), again.vertices)
    assert np.array_equal(faces, again.faces)
    with pytest.raises(ValueError, match="0 to 8"):
        made.pack(9)
    with pytest.raises(ValueError, match="keep"):
        shrouds.unpack_shroud(made.pack(4), volume="keep")
