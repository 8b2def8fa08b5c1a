"""The package by itself: examples, stubs, the tutorial."""

import doctest
import inspect
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import shrouds
from shrouds import (
    _arrays,
    _labels,
    _materials,
    _meshes,
    _napari,
    _packed,
    _shroud,
    _volumes,
)

HERE = Path(__file__).parent


MODULES = [shrouds, _arrays, _labels, _materials, _meshes, _packed, _shroud, _volumes]


@pytest.mark.parametrize("module", MODULES)
def test_examples(module):
    assert doctest.testmod(module).failed == 0


def test_there_are_examples_for_every_function():
    without = ("read_mesh", "unpack")
    for name in shrouds.__all__:
        if inspect.isfunction(getattr(shrouds, name)) and name not in without:
            assert ">>>" in getattr(shrouds, name).__doc__


def mypy(tool, option, folder, *what):
    pytest.importorskip("mypy")
    settings = f"--{option}={HERE.parent / 'pyproject.toml'}"
    call = [sys.executable, "-m", tool, settings, *what]
    environment = {**os.environ, "MYPY_CACHE_DIR": str(folder)}
    return subprocess.run(
        call, capture_output=True, text=True, check=False, cwd=folder, env=environment
    )


def test_stubs_say_what_is_there(tmp_path):
    done = mypy("mypy.stubtest", "mypy-config-file", tmp_path, "shrouds._native")
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_hold(tmp_path):
    done = mypy("mypy", "config-file", tmp_path, "-p", "shrouds")
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


def test_napari_reads_and_writes(body, tmp_path):
    made = shrouds.shroud(body, spacing=(1, 2, 3))
    (path,) = _napari.write_surface(str(tmp_path / "a.ply"), made.to_napari()[0], {})
    ((vertices, faces), options, kind), = _napari.reader(path)(path)
    assert np.array_equal(vertices[:, ::-1], made.vertices) and np.array_equal(faces, made.faces)
    assert (options, kind) == ({"name": "a"}, "surface")
    affine = np.array([[0, 2, 0, 5], [1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1.0]])
    (tmp_path / "b.shroud").write_bytes(shrouds.pack(shrouds.Volume(body, affine)))
    values, options, kind = _napari.read(str(tmp_path / "b.shroud"))[0]
    assert np.array_equal(values, body) and kind == "labels"
    i, j, k = 3, 4, 5
    assert np.array_equal((options["affine"] @ (k, j, i, 1))[2::-1], (affine @ (i, j, k, 1))[:3])
    assert _napari.reader("c.txt") is None


def test_the_manifest_names_what_is_there():
    npe2 = pytest.importorskip("npe2")
    manifest = npe2.PluginManifest.from_distribution("shrouds")
    manifest.validate_imports()


def test_the_example_of_the_readme_runs(tmp_path, monkeypatch):
    text = (HERE.parent / "README.md").read_text()
    monkeypatch.chdir(tmp_path)
    exec(text.split("```python\n")[1].split("```")[0], {})
    assert (tmp_path / "ball.ply").exists()
