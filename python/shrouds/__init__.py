"""Smooth surfaces of voxel segmentations that provably keep every voxel on its own side.

>>> import numpy as np, shrouds
>>> mask = np.zeros((9, 9, 9), bool)
>>> mask[3:6, 3:6, 2:7] = True
>>> vertices, faces = shrouds.shroud(mask)

A voxel is its centre: index (i, j, k) along x, y, z lies at ``affine @ (i, j, k, 1)``, and without an affine
at ``origin + (i, j, k) * spacing``. Positions are x, y, z; arrays are indexed ``[z, y, x]`` unless ``axes`` says
otherwise.
"""

from ._arrays import Volume
from ._meshes import check, compare, measure, read_mesh
from ._native import __version__
from ._shroud import Curves, Progress, Shroud, shroud
from ._volumes import combine, offset, pack, read_volume, unpack, voxelize

__all__ = [
    "Curves",
    "Progress",
    "Shroud",
    "Volume",
    "__version__",
    "check",
    "combine",
    "compare",
    "measure",
    "offset",
    "pack",
    "read_mesh",
    "read_volume",
    "shroud",
    "unpack",
    "voxelize",
]
