"""Surfaces chunk by chunk on Dask's workers, against those made at once.

What these tests need besides the package is in requirements-distributed.txt; without it they say so and are skipped,
unless SHROUDS_REQUIRE_ALL is set.
"""

import importlib.util
import os
import random
import signal
import threading

import numpy as np
import pytest
import shrouds

NEEDED = ["zarr", "dask", "distributed", "cloudvolume", "trimesh"]
missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
if missing:
    message = f"not installed: {', '.join(missing)} (python/tests/requirements-distributed.txt)"
    if os.environ.get("SHROUDS_REQUIRE_ALL"):
        raise ImportError(message)
    pytest.skip(message, allow_module_level=True)

import dask
import trimesh
import zarr
from cloudvolume import CloudVolume
from distributed import Client, LocalCluster
from shrouds import distributed

SHAPE = (140, 135, 150)


@pytest.fixture(scope="module")
def cluster():
    """Two workers with a process each."""
    # As often as a test kills workers.
    dask.config.set({"distributed.scheduler.allowed-failures": 20})
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            yield cluster, client


@pytest.fixture(scope="module")
def array():
    """Two labels that touch, the first with more vertices than one tile has, indexed [z, y, x]."""
    z, y, x = np.mgrid[: SHAPE[0], : SHAPE[1], : SHAPE[2]] * (2 * np.pi / 17)
    gyroid = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    values = np.where(gyroid > 0.2, 7, 0).astype(np.uint64)
    values[30:70, 40:100, 50:90][values[30:70, 40:100, 50:90] == 0] = 2**40 + 3
    return values


@pytest.fixture(scope="module")
def store(array, tmp_path_factory):
    """The array as one level of an OME-Zarr image, in chunks of 64, with a channel axis."""
    path = tmp_path_factory.mktemp("store") / "labels.zarr"
    group = zarr.open_group(str(path), mode="w", zarr_format=2)
    axes = [{"name": "c", "type": "channel"}]
    axes += [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    steps = [{"type": "scale", "scale": [1.0, 0.04, 0.01, 0.01]}]
    dataset = {"path": "0", "coordinateTransformations": steps}
    group.attrs["multiscales"] = [{"axes": axes, "datasets": [dataset], "version": "0.4"}]
    level = group.create_array("0", shape=(1, *SHAPE), chunks=(1, 64, 64, 64), dtype="u8")
    level[0] = array
    return path


def corners(vertices, faces):
    """The corners of all triangles as bytes, the least one first, sorted."""
    places = np.ascontiguousarray(vertices[faces].astype("<f4"))
    triangles = places.view("V12")[..., 0]
    least = np.argsort(triangles, axis=1)[:, 0]
    order = (least[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(triangles, order, axis=1)
    return sorted(map(bytes, turned))


def whole(array, label, spacing, origin=(0, 0, 0)):
    made = shrouds.shroud(array == label, spacing=spacing, origin=origin)
    return made.vertices, made.faces


def test_precomputed_is_what_cloud_volume_reads(cluster, store, array, tmp_path):
    output = tmp_path / "layer"
    found = distributed.mesh(store, output, cluster[1], chunk=128)
    assert sorted(found) == [7, 2**40 + 3]
    volume = CloudVolume(f"file://{output}", progress=False)
    spacing = (10, 10, 40)
    vertices, faces = whole(array, 7, spacing, (5, 5, 20))
    assert len(vertices) > 75_000, "more than one tile"
    assert found[7] == (len(vertices), len(faces))
    read = volume.mesh.get(7, remove_duplicate_vertices=True)
    read = read[7] if isinstance(read, dict) else read
    assert corners(read.vertices, read.faces) == corners(vertices, faces)
    assert trimesh.Trimesh(read.vertices, read.faces, process=True).is_watertight
    # Of one tile alone: the same triangles, but for which of them where, and nearly the same places.
    other = volume.mesh.get(2**40 + 3, remove_duplicate_vertices=True)
    other = other[2**40 + 3] if isinstance(other, dict) else other
    vertices, faces = whole(array, 2**40 + 3, spacing, (5, 5, 20))
    assert other.faces.shape == faces.shape
    assert not (tmp_path / "layer.work").exists()


def test_files_have_the_surface_that_is_made_at_once(cluster, store, array, tmp_path):
    distributed.mesh(store, tmp_path / "a", cluster[1], labels=[7], chunk=128, format="ply")
    distributed.mesh(store, tmp_path / "b", cluster[1], labels=[7], chunk=256, format="parts")
    expected = corners(*whole(array, 7, (0.01, 0.01, 0.04)))
    vertices, faces = shrouds.read_mesh(tmp_path / "a" / "7.ply")
    assert corners(vertices, faces) == expected
    parts = [shrouds.read_mesh(file) for file in (tmp_path / "b" / "7").iterdir()]
    assert sorted(sum((corners(*part) for part in parts), [])) == expected


def test_killed_workers_change_nothing(cluster, store, tmp_path):
    cluster, client = cluster
    distributed.mesh(store, tmp_path / "a", client, labels=[7], chunk=128, format="ply")
    killed, over = [], threading.Event()

    def kill():
        choose = random.Random(5)
        while len(killed) < 3 and not over.wait(choose.uniform(0.4, 1.2)):
            worker = choose.choice(list(cluster.workers.values()))
            if worker.status.name == "running" and worker.pid:
                os.kill(worker.pid, signal.SIGKILL)
                killed.append(worker.pid)

    killer = threading.Thread(target=kill)
    killer.start()
    runs = 0
    try:
        # As often as it takes to be killed three times in the midst of it.
        while len(killed) < 3:
            distributed.mesh(store, tmp_path / "b", client, labels=[7], chunk=128, format="ply")
            runs += 1
            result = (tmp_path / "b" / "7.ply").read_bytes()
            assert result == (tmp_path / "a" / "7.ply").read_bytes(), f"run {runs}, {killed}"
    finally:
        over.set()
        killer.join()
    assert len(killed) == 3


def test_a_run_that_was_broken_off_goes_on(cluster, store, tmp_path, monkeypatch):
    client = cluster[1]
    call = {"labels": [7], "chunk": 128, "format": "ply"}
    distributed.mesh(store, tmp_path / "a", client, **call)
    expected = (tmp_path / "a" / "7.ply").read_bytes()

    def fail(*_):
        raise RuntimeError("broken off")

    with monkeypatch.context() as patch:
        patch.setattr(distributed, "_join", fail)
        patch.setattr(distributed, "RETRIES", 0)
        with pytest.raises(Exception, match="broken off|_join"):
            distributed.mesh(store, tmp_path / "b", client, **call)
    work = tmp_path / "b.work" / "7"
    assert not (tmp_path / "b" / "7.ply").exists()
    next(work.glob("piece-*")).unlink()
    distributed.mesh(store, tmp_path / "b", client, **call)
    assert (tmp_path / "b" / "7.ply").read_bytes() == expected
    assert not work.exists()


def test_what_cannot_be_is_said(cluster, store, tmp_path):
    client = cluster[1]
    with pytest.raises(ValueError, match="multiple of 128"):
        distributed.mesh(store, tmp_path / "a", client, labels=[7], chunk=100)
    with pytest.raises(ValueError, match="preset"):
        distributed.mesh(store, tmp_path / "b", client, labels=[7], preset="exact")
    with pytest.raises(ValueError, match="format"):
        distributed.mesh(store, tmp_path / "c", client, format="obj")
    plain = tmp_path / "plain.zarr"
    zarr.create_array(str(plain), shape=(2, 4, 4, 4), dtype="u1")
    with pytest.raises(ValueError, match="not one volume"):
        distributed.Source.open(plain)
