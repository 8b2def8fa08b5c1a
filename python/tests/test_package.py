"""The package by itself: examples, stubs, the tutorial."""

import doctest
import os
import subprocess
import sys
from pathlib import Path

import pytest

import shrouds
from shrouds import _arrays, _meshes, _shroud, _volumes

HERE = Path(__file__).parent


@pytest.mark.parametrize("module", [shrouds, _arrays, _meshes, _shroud, _volumes])
def test_examples(module):
    assert doctest.testmod(module).failed == 0


def test_there_are_examples_for_every_function():
    for name in ("shroud", "check", "measure", "compare", "combine", "offset", "voxelize", "pack"):
        assert ">>>" in getattr(shrouds, name).__doc__


def test_stubs_say_what_is_there(tmp_path):
    pytest.importorskip("mypy")
    call = [sys.executable, "-m", "mypy.stubtest", "shrouds"]
    done = subprocess.run(call, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_hold(tmp_path):
    pytest.importorskip("mypy")
    package = str(Path(shrouds.__file__).parent)
    call = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), package]
    call += ["--ignore-missing-imports"]
    done = subprocess.run(call, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_tutorial_runs(tmp_path):
    pytest.importorskip("pyvista")
    pytest.importorskip("nibabel")
    call = [sys.executable, str(HERE.parent / "examples" / "tutorial.py"), str(tmp_path)]
    environment = {**os.environ, "PYVISTA_OFF_SCREEN": "true"}
    done = subprocess.run(call, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "tutorial.png").stat().st_size > 10_000
    assert (tmp_path / "kidney.ply").exists()
