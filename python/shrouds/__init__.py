"""Smooth surfaces of voxel segmentations that provably keep every voxel on its own side."""

from ._native import __version__
from ._shroud import Progress, Shroud, shroud

__all__ = ["Progress", "Shroud", "__version__", "shroud"]
