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
