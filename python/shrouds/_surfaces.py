"""Triangle meshes of any origin, brought into the one form that the Rust code takes."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from . import _native


@runtime_checkable
class HasFaces(Protocol):
    """What has vertices and faces: a :class:`Shroud`, a ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


Surface = HasFaces | tuple[ArrayLike, ArrayLike]


def mesh_of(surface: Surface) -> _native.Mesh:
    """A mesh as the Rust code takes it."""
    if isinstance(surface, HasFaces):
        vertices, faces = np.asarray(surface.vertices), np.asarray(surface.faces)
    else:
        vertices, faces = map(np.asarray, surface)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or vertices.dtype.kind not in "fiu":
        raise ValueError(f"vertices must be numbers of shape (n, 3), not {vertices.shape}")
    if faces.ndim != 2 or faces.shape[1] != 3 or faces.dtype.kind not in "iu":
        raise ValueError(f"faces must be whole numbers of shape (m, 3), not {faces.shape}")
    if faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise ValueError(f"a face names a vertex beyond the {len(vertices)} there are")
    return _native.Mesh(
        np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.uint32), None
    )
