"""Volume of the shroud of small shapes made of voxels, against their voxel count.

    SHROUDS_BIN=target/release/shrouds target/python/bin/python tests/python/voxel_shapes.py \
        --preset exact

Options are passed on to the program.
"""

import json
import os
import subprocess
import sys
import tempfile

import numpy as np

BOXES = [
    (1, 1, 1), (16, 1, 1), (16, 2, 2), (16, 3, 3), (16, 16, 1), (16, 16, 2), (16, 16, 3),
    (4, 4, 4), (10, 10, 10), (16, 20, 28),
]  # fmt: skip


def swelling(volume, folder):
    """Volume of the mesh of a volume with unit spacing over its voxel count, less 1."""
    path = os.path.join(folder, "volume.npy")
    np.save(path, volume)
    mesh = os.path.join(folder, "mesh.ply")
    command = [os.environ["SHROUDS_BIN"], "mesh", path, "-o", mesh, "--json", "--quiet"]
    command += sys.argv[1:]
    report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    return report["geometry"]["volume"] / np.count_nonzero(volume) - 1


def main():
    with tempfile.TemporaryDirectory() as folder:
        for size in BOXES:
            shape = " × ".join(map(str, size))
            print(f"{shape:>14}  {swelling(np.ones(size[::-1], np.uint8), folder):+.1%}")
        chain = np.zeros((1, 16, 16), np.uint8)
        np.fill_diagonal(chain[0], 1)
        print(f"diagonal chain  {swelling(chain, folder):+.1%}")


if __name__ == "__main__":
    main()
