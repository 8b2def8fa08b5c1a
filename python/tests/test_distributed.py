"""Surfaces chunk by chunk on Dask's workers, against those made at once."""

import needs

needs.packages("zarr", "dask", "distributed", "cloudvolume", "trimesh")

import os
import random
import signal
import threading

import numpy as np
import pytest
import shrouds
import trimesh
import zarr
from cloudvolume import CloudVolume
from shrouds import distributed
from surfaces import corners, whole


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
    assert np.array_equal(corners(read.vertices, read.faces), corners(vertices, faces))
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
    assert np.array_equal(corners(vertices, faces), expected)
    parts = [shrouds.read_mesh(file) for file in (tmp_path / "b" / "7").iterdir()]
    found = np.sort(np.concatenate([corners(*part) for part in parts]))
    assert np.array_equal(found, expected)


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
