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
from ._curves import Curves, Progress
from ._labels import measure_labels
from ._materials import Materials, materials
from ._meshes import check, compare, components, measure, read_mesh
from ._native import __version__
from ._packed import pack, pack_labels, unpack, unpack_shroud
from ._shroud import NotConverged, Shroud, shroud
from ._volumes import combine, offset, read_volume, voxelize

__all__ = [
    "Curves",
    "Materials",
    "NotConverged",
    "Progress",
    "Shroud",
    "Volume",
    "__version__",
    "check",
    "combine",
    "compare",
    "components",
    "materials",
    "measure",
    "measure_labels",
    "offset",
    "pack",
    "pack_labels",
    "read_mesh",
    "read_volume",
    "shroud",
    "unpack",
    "unpack_shroud",
    "voxelize",
]
