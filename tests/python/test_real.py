"""Real data, where `cargo xtask data` has fetched it: what `shrouds info` says of every file, and
where every voxel lies, against the reference reader of the format."""

import json
import subprocess
from pathlib import Path

import nibabel
import nrrd
import numpy as np
import pytest
import trimesh

import reference
from judge import assert_separates

DATA = Path(__file__).parents[2] / "target" / "data"
BRAIN = DATA / "brain.nii.gz"
MESHES = (".ply", ".stl", ".obj", ".vtp")
MOST_LABELS = 1 << 16  # more different values are no labels


def fetched(endings):
    """Files that packages brought, as parameters with their path in the package as name."""
    files = sorted(
        path
        for path in DATA.glob("*/**/*")
        if path.name.lower().endswith(endings) and path.relative_to(DATA).parts[0] != "packages"
    )
    if files:
        return [pytest.param(path, id=str(path.relative_to(DATA))) for path in files]
    skipped = pytest.mark.skip(reason="run `cargo xtask data --all` to fetch the files")
    return [pytest.param(None, id="none", marks=skipped)]


@pytest.fixture
def call(program):
    """Runs the program and returns what came of it, whether it was done or not."""

    def run(*arguments):
        command = [program, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)

    return run


@pytest.mark.skipif(not BRAIN.exists(), reason="run `cargo xtask data` to fetch the brain")
def test_half_a_brain(mesh_of, tmp_path):
    """The lower half of the head, cut so that the surface meets the border of the volume."""
    image = nibabel.load(BRAIN)
    half = image.slicer[:, :, : image.shape[2] // 2]
    path = tmp_path / "half.nii.gz"
    nibabel.save(half, path)
    assert_separates(mesh_of(path), half.affine, np.asarray(half.dataobj) != 0)


@pytest.mark.parametrize("path", fetched(reference.VOLUMES))
def test_a_volume_file(call, tmp_path, path):
    """Labels, names, affine and voxels are those of the reference reader; what is no volume for it
    is refused."""
    try:
        layers = reference.read(path)
    except reference.NoVolume:
        assert_refused(call("info", path), path)
        return
    for layer in layers:
        done = call("info", path, "--json", *layer.options)
        assert done.returncode == 0, done.stderr
        info = json.loads(done.stdout)
        assert_labels(info, layer)
        assert_places(np.vstack([info["affine"], [0, 0, 0, 1]]), info["dims"], layer)
        if np.isfinite(layer.values).all():
            whole = ",".join(f"0:{n}" for n in info["dims"])
            out = tmp_path / "out.nrrd"
            done = call("crop", path, "--box", whole, "-o", out, "--quiet", *layer.options)
            if layer.values.any():
                assert done.returncode == 0, done.stderr
                assert_voxels(out, layer)
            else:
                assert_refused(done, path)


@pytest.mark.parametrize("path", fetched((".nrrd", ".nhdr", ".mha", ".mhd")))
def test_itk_agrees(call, path):
    """ITK brings every file into LPS."""
    try:
        layer = reference.itk(path)
    except reference.NoVolume as reason:
        pytest.skip(f"ITK sees {reason}")
    info = json.loads(call("info", path, "--json").stdout)
    world = np.diag([-1, -1, 1, 1]) if info["frame"] == "RAS" else np.eye(4)
    assert_labels(info, layer)
    assert_places(world @ np.vstack([info["affine"], [0, 0, 0, 1]]), info["dims"], layer)


@pytest.mark.parametrize("path", fetched(MESHES))
def test_a_mesh_file(call, path):
    """Vertices and triangles are those of trimesh, unless the file holds none or is refused."""
    done = call("info", path, "--json")
    if done.returncode != 0:
        assert_refused(done, path)
        assert path.suffix not in (".ply", ".stl", ".obj"), done.stderr
        return
    info = json.loads(done.stdout)
    mesh = trimesh.load(path, process=False)
    # An STL file has no vertices but the corners of its triangles.
    vertices = np.unique(mesh.vertices, axis=0) if path.suffix == ".stl" else mesh.vertices
    assert info["vertices"] == len(vertices)
    assert info["triangles"] == len(getattr(mesh, "faces", ()))
    assert np.allclose(info["bounds"], mesh.bounds, rtol=1e-6)


def assert_refused(done, path):
    """It was not done, and one line that names the file, or the one beside it, says why."""
    assert done.returncode in (1, 2), done.stdout
    assert done.stdout == ""
    assert path.stem in done.stderr
    assert len(done.stderr.splitlines()) == 1, done.stderr


def assert_labels(info, layer):
    """As many voxels of each label, by number or by name."""
    if layer.segments:
        voxels = {label["name"]: label["voxels"] for label in info["labels"] if "name" in label}
        assert voxels == layer.segments
        return
    values, counts = np.unique(layer.values, return_counts=True)
    if not (np.isfinite(values).all() and (values == np.round(values)).all()):
        assert info["labels"] is None
    elif len(values) <= MOST_LABELS:
        expected = {int(value): int(count) for value, count in zip(values, counts)}
        assert {label["label"]: label["voxels"] for label in info["labels"]} == expected
    if np.isfinite(values).any():
        low, high = values[np.isfinite(values)][[0, -1]]
        assert np.allclose(info["range"], [low, high], rtol=1e-6)


def assert_places(affine, dims, layer):
    """The first and the last voxel lie where they should, to a millionth of the spacing."""
    shape = np.array(layer.values.shape)
    if layer.turned:
        assert sorted(dims) == sorted(shape)
        return  # `assert_voxels` finds out how
    assert (dims == shape).all()
    spacing = np.linalg.norm(layer.affine[:3, :3], axis=0).min()
    for index in ([0, 0, 0, 1], [*(shape - 1), 1]):
        away = (affine - layer.affine) @ index
        assert np.abs(away).max() <= 1e-6 * spacing


def assert_voxels(cropped, layer):
    """Every voxel inside has its place in the world, and no other is inside."""
    ours, header = nrrd.read(str(cropped))
    affine, _ = reference.nrrd_affine(header)
    to_reference = np.linalg.inv(layer.affine) @ affine
    inside = np.argwhere(ours)
    index = inside @ to_reference[:3, :3].T + to_reference[:3, 3]
    whole = np.round(index).astype(int)
    if layer.turned:
        assert np.abs(index - whole).max() <= 1e-6
    else:
        assert (whole == inside).all()
    assert len(inside) == np.count_nonzero(layer.values)
    assert layer.values[tuple(whole.T)].all()
