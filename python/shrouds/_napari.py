"""What napari finds in this package by ``napari.yaml``: files of meshes and packed volumes in, surfaces out.

napari has its coordinates in the order z, y, x.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ._arrays import Volume
from ._meshes import read_mesh
from ._packed import unpack
from ._surfaces import mesh_of

Layer = tuple[Any, dict[str, Any], str]


def reader(path: str | list[str]) -> Callable[[str | list[str]], list[Layer]] | None:
    """What reads these files, if anything here does."""
    known = {".ply", ".stl", ".obj", ".shroud"}
    return read if all(Path(each).suffix.lower() in known for each in _list(path)) else None


def read(path: str | list[str]) -> list[Layer]:
    """A surface for every mesh, labels for every packed volume."""
    return [_layer(Path(each)) for each in _list(path)]


def write_surface(path: str, data: Any, attributes: dict[str, Any]) -> list[str]:
    """Writes a surface in the format that the name ends with; returns the files that there are then."""
    vertices, faces = np.asarray(data[0], np.float64), np.asarray(data[1])
    if vertices.shape[1] != 3:
        raise ValueError(f"{attributes.get('name', path)}: a surface of three dimensions is wanted")
    mesh = mesh_of((vertices[:, ::-1], faces))
    mesh.write(path, {}, "index", "unknown", 1.0)
    return [path]


def _layer(path: Path) -> Layer:
    if path.suffix.lower() == ".shroud":
        volume = unpack(path.read_bytes())
        options = {"name": path.stem, "affine": affine_in_z_y_x(volume)}
        return volume.values.astype(np.uint8), options, "labels"
    vertices, faces = read_mesh(path)
    return (vertices[:, ::-1], faces), {"name": path.stem}, "surface"


def affine_in_z_y_x(volume: Volume) -> np.ndarray[Any, np.dtype[np.float64]]:
    """The map from index to world with both in napari's order."""
    order = [2, 1, 0, 3]
    return np.asarray(volume.affine)[np.ix_(order, order)]


def _list(path: str | list[str]) -> list[str]:
    return path if isinstance(path, list) else [path]


