"""Runs the program whose path is in SHROUDS_BIN; `cargo xtask test` sets it."""

import os
import subprocess
from pathlib import Path

import pytest
import trimesh


@pytest.fixture(scope="session")
def program():
    """The path of the program."""
    path = os.environ.get("SHROUDS_BIN")
    assert path, "set SHROUDS_BIN to the program, or run `cargo xtask test`"
    return path


@pytest.fixture(scope="session")
def shrouds(program):
    """Calls the program and returns what it wrote to standard output."""

    def call(*arguments):
        done = subprocess.run(
            [program, *map(str, arguments)], capture_output=True, text=True, timeout=120
        )
        assert done.returncode == 0, f"shrouds {arguments}: {done.stderr}"
        return done.stdout

    return call


@pytest.fixture
def mesh_of(shrouds, tmp_path):
    """Shrouds a volume file and loads the mesh as it stands in the file."""

    def run(volume, *options, name="out.ply"):
        out = tmp_path / name
        shrouds("mesh", volume, "-o", out, "--quiet", *options)
        return load(out)

    return run


def load(path):
    """The mesh with the vertices of the file, none of them merged."""
    return trimesh.load(Path(path), process=False, force="mesh")
