"""Mesh files of one run tell the same, and the reports are what the manual says."""

import json

import numpy as np
import pytest

from conftest import load
from judge import sample_volume

REPORT = {
    "input", "settings", "topology", "solver", "geometry", "checks", "times", "memory", "version",
}


@pytest.fixture
def volume(tmp_path):
    path = tmp_path / "volume.npy"
    np.save(path, sample_volume().transpose(2, 1, 0).astype(np.uint8, order="C"))
    return path


@pytest.mark.parametrize("kind", ["stl", "obj"])
def test_mesh_formats_agree(shrouds, volume, tmp_path, kind):
    meshes = []
    for ending in ("ply", kind):
        path = tmp_path / f"mesh.{ending}"
        shrouds("mesh", volume, "-o", path, "--quiet")
        meshes.append(load(path))
    ply, other = meshes
    assert len(ply.faces) == len(other.faces) > 0
    assert np.allclose(ply.triangles, other.triangles, rtol=0, atol=1e-5)
    if kind == "obj":
        assert len(ply.vertices) == len(other.vertices)


def test_the_report_of_a_mesh(shrouds, volume, tmp_path):
    out = tmp_path / "out.ply"
    report = json.loads(shrouds("mesh", volume, "-o", out, "--json", "--quiet"))
    assert REPORT <= set(report)
    mesh = load(out)
    assert report["topology"]["vertices"] == len(mesh.vertices)
    assert report["topology"]["triangles"] == len(mesh.faces)
    volume = report["geometry"]["volume"]
    assert abs(volume - mesh.volume) < 1e-4 * mesh.volume
    assert abs(report["geometry"]["area"] - mesh.area) < 1e-4 * mesh.area
    stages = {"read", "surface", "optimize", "mesh", "check", "write"}
    assert stages <= set(report["times"])


def test_info_tells_the_dimensions(shrouds, volume):
    info = json.loads(shrouds("info", volume, "--json"))
    assert list(sample_volume().shape) in list(lists_within(info))


def lists_within(value):
    """Every list anywhere in a JSON value."""
    if isinstance(value, list):
        yield value
    elif isinstance(value, dict):
        value = value.values()
    else:
        return
    for part in value:
        yield from lists_within(part)
