"""Every mesh format, read by programs of others, tells what the PLY of the same run tells."""

import json
import shutil
import subprocess
from pathlib import Path

import nrrd
import numpy as np
import pytest
import trimesh
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from conftest import load
from judge import sample_volume

ROOT = Path(__file__).resolve().parents[2]
VALIDATOR = "gltf-validator@2.0.0-dev.3.10"
# Places of the files have 32 bits, counted from the origin or from the middle of the mesh.
ROUNDING = 4e-6
# The origin of the second one is far away: from there 32 bits would round places to 1/16.
ORIGINS = {"near": (0.0, 0.0, 0.0), "far": (1e6, -1e6, 1e6)}


@pytest.fixture(scope="module", params=ORIGINS)
def meshes(program, request, tmp_path_factory):
    """Files of all formats from one volume, and the mesh of the PLY."""
    folder = tmp_path_factory.mktemp("formats")
    volume = folder / "volume.nrrd"
    header = {
        "space": "left-posterior-superior",
        "space directions": np.diag([1.0, 1.5, 2.0]),
        "space origin": np.array(ORIGINS[request.param]),
        "space units": ["mm"] * 3,
    }
    nrrd.write(str(volume), sample_volume().astype(np.uint8), header)
    for kind in ("ply", "stl", "obj", "glb", "vtp", "3mf"):
        call = [program, "mesh", volume, "-o", folder / f"mesh.{kind}", "--quiet"]
        # STL warns that it has too few digits.
        subprocess.run(list(map(str, call)), check=True, capture_output=True, timeout=120)
    return folder, load(folder / "mesh.ply"), request.param


def agrees(mesh, ply, normals=None):
    """The same vertices and triangles in the same order, closed, normals to the outside."""
    assert np.array_equal(mesh.faces, ply.faces)
    assert np.abs(mesh.vertices - ply.vertices).max() <= ROUNDING
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
    if normals is not None:
        assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
        # As they stand in the file: those of the mesh may be trimesh's own.
        raw = ply.metadata["_ply_raw"]["vertex"]["data"]
        expected = np.stack([raw[name] for name in ("nx", "ny", "nz")], axis=1)
        assert np.abs(normals - expected).max() < 1e-6


def test_obj_and_stl(meshes):
    folder, ply, where = meshes
    agrees(load(folder / "mesh.obj"), ply)
    stl = load(folder / "mesh.stl")
    assert len(stl.faces) == len(ply.faces)
    assert np.abs(stl.triangles - ply.triangles).max() <= (ROUNDING if where == "near" else 0.04)


def test_glb(meshes):
    folder, ply, _ = meshes
    scene = trimesh.load(folder / "mesh.glb", process=False)
    (name,) = scene.graph.nodes_geometry
    transform, geometry = scene.graph[name]
    mesh = scene.geometry[geometry]
    # Digits are those of the mesh about its middle, not of its place in the world.
    placed = trimesh.Trimesh(
        mesh.vertices.astype(float) + transform[:3, 3], mesh.faces, process=False
    )
    assert np.array_equal(transform[:3, :3], np.eye(3))
    agrees(placed, ply, mesh.vertex_normals)


def test_3mf(meshes):
    folder, ply, _ = meshes
    scene = trimesh.load(folder / "mesh.3mf", process=False)
    assert scene.units == "millimeter"
    (mesh,) = scene.geometry.values()
    agrees(mesh, ply)


def test_vtp(meshes):
    folder, ply, _ = meshes
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(folder / "mesh.vtp"))
    reader.Update()
    data = reader.GetOutput()
    cells = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    places = vtk_to_numpy(data.GetPoints().GetData())
    normals = vtk_to_numpy(data.GetPointData().GetNormals())
    agrees(trimesh.Trimesh(places, cells, process=False), ply, normals)
    fields = data.GetFieldData()
    texts = [fields.GetAbstractArray(name).GetValue(0) for name in ("SPACE", "UNIT")]
    assert texts == ["LPS", "mm"]


@pytest.fixture(scope="session")
def validator():
    """Calls the validator of the Khronos Group; installed once under target/."""
    if not (shutil.which("npm") and shutil.which("node")):
        pytest.skip("npm and node are not there: the official glTF validator did not run")
    folder = ROOT / "target" / "gltf"
    mark = folder / "installed"
    if not (mark.exists() and mark.read_text() == VALIDATOR):
        call = ["npm", "install", "--silent", "--no-save", "--prefix", str(folder), VALIDATOR]
        done = subprocess.run(call, capture_output=True, text=True, timeout=300)
        if done.returncode != 0:
            pytest.skip("the official glTF validator cannot be installed: is npm's index reachable?")
        mark.write_text(VALIDATOR)
    script = (
        "const fs = require('fs'); require('gltf-validator')"
        ".validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))"
        ".then(report => console.log(JSON.stringify(report.issues)))"
    )

    def issues(path):
        call = ["node", "-e", script, str(path)]
        done = subprocess.run(
            call, cwd=folder, capture_output=True, text=True, check=True, timeout=120
        )
        return json.loads(done.stdout)

    return issues


def test_the_official_validator_finds_nothing_in_glb(meshes, validator, tmp_path):
    folder, _, _ = meshes
    found = validator(folder / "mesh.glb")
    assert found["numErrors"] == found["numWarnings"] == found["numInfos"] == 0, found
    # It does look.
    damaged = bytearray((folder / "mesh.glb").read_bytes())
    damaged[-1] = 0xFF
    (tmp_path / "damaged.glb").write_bytes(damaged)
    assert validator(tmp_path / "damaged.glb")["numErrors"] > 0
