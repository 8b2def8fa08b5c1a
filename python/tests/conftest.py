"""Bodies to shroud, and the program to compare with."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture(scope="session")
def program():
    """Runs the program `shrouds` and returns what it printed."""
    path = os.environ.get("SHROUDS_BIN")
    if not path:
        pytest.skip("SHROUDS_BIN does not name the program")

    def run(*arguments):
        call = [path, *map(str, arguments), "--quiet"]
        done = subprocess.run(call, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert Path(path).exists(), path
    return run


@pytest.fixture(scope="session")
def body():
    """A body without any symmetry, indexed [z, y, x], with dimensions of 40, 33 and 70."""
    z, y, x = np.mgrid[:40, :33, :70]
    ball = (x - 20.3) ** 2 + (y - 15.1) ** 2 + (z - 17.8) ** 2 < 140
    rod = ((y - 14) ** 2 + (z - 20 - 0.1 * x) ** 2 < 14) & (x > 15) & (x < 60)
    return ball | rod


@pytest.fixture(scope="session")
def gyroid():
    """A large surface for the size of its volume: work for a while."""
    z, y, x = np.mgrid[:128, :128, :128] * (2 * np.pi / 24)
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) > 0.2


@pytest.fixture(scope="session")
def cluster():
    """Two workers with a process each."""
    import dask
    from distributed import Client, LocalCluster

    # As often as a test kills workers.
    dask.config.set({"distributed.scheduler.allowed-failures": 20})
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            yield cluster, client


@pytest.fixture(scope="session")
def array():
    """Two labels that touch, the first with more vertices than one tile has, indexed [z, y, x]."""
    z, y, x = np.mgrid[:140, :135, :150] * (2 * np.pi / 27)
    gyroid = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    values = np.where(gyroid > 0.2, 7, 0).astype(np.uint64)
    values[30:70, 40:100, 50:90][values[30:70, 40:100, 50:90] == 0] = 2**40 + 3
    return values


@pytest.fixture(scope="session")
def store(array, tmp_path_factory):
    """The array as one level of an OME-Zarr image, in chunks of 64, with a channel axis."""
    import zarr

    path = tmp_path_factory.mktemp("store") / "labels.zarr"
    group = zarr.open_group(str(path), mode="w", zarr_format=2)
    axes = [{"name": "c", "type": "channel"}]
    axes += [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    steps = [{"type": "scale", "scale": [1.0, 0.04, 0.01, 0.01]}]
    dataset = {"path": "0", "coordinateTransformations": steps}
    group.attrs["multiscales"] = [{"axes": axes, "datasets": [dataset], "version": "0.4"}]
    level = group.create_array("0", shape=(1, *array.shape), chunks=(1, 64, 64, 64), dtype="u8")
    level[0] = array
    return path
