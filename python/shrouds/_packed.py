"""Volumes and surfaces as the few bytes of a ``.shroud`` file, and back."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Inside, Place, Selection, Volume, in_z_y_x, inside, placed
from ._shroud import Profile, Shroud, named

if TYPE_CHECKING:
    from typing_extensions import Unpack


def pack(
    values: ArrayLike | Volume,
    *,
    profile: Profile = "dense",
    faces: Literal["separate", "join"] = "separate",
    border: Literal["closed", "open"] = "closed",
    threads: int | None = None,
    **selection: Unpack[Selection],
) -> bytes:
    """Pack the inside voxels of a volume, without loss, into the bytes of a ``.shroud`` file.

    Whoever unpacks them makes the same shroud again: a surface in a fraction of a bit per triangle. To have the
    places of the vertices of one shroud in it, see :meth:`Shroud.pack`. ``selection`` is as for :func:`check`.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> z, y, x = np.ogrid[-20:21, -20:21, -20:21]
    >>> ball = x**2 + y**2 + z**2 < 300
    >>> packed = shrouds.pack(ball)
    >>> len(packed) < 500, bool((shrouds.unpack(packed).values == ball).all())
    (True, True)
    """
    volume = inside(values, threads=threads, **selection)
    frame, unit = volume.frame, volume.unit
    return volume.bits.pack(profile, faces, border, frame, unit, threads)


def pack_labels(
    values: ArrayLike | Volume, *, profile: Profile = "dense", **place: Unpack[Place]
) -> bytes:
    """Pack all labels of an array of whole numbers as they are, without loss; :func:`unpack` gives them back.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> labels = np.zeros((20, 20, 20), np.uint16)
    >>> labels[5:10, 5:15, 5:15], labels[10:15, 5:15, 5:15] = 7, 300
    >>> again = shrouds.unpack(shrouds.pack_labels(labels))
    >>> bool((again.values == labels).all())
    True
    """
    array = placed(values, **place)
    return _native.pack_labels(array.values, array.rows, profile, array.frame, array.unit)


def unpack(packed: bytes, *, threads: int | None = None) -> Volume:
    """The volume in the bytes of a ``.shroud`` file, indexed ``[z, y, x]``: of bool, or of int64 for labels.

    Raises
    ------
    ValueError
        When the bytes are those of another file, or damaged.
    """
    data = bytes(packed)
    if _native.is_labels(data):
        values, rows, frame, unit = _native.unpack_labels(data)
        affine = np.vstack([rows, (0.0, 0.0, 0.0, 1.0)])
        return Volume(in_z_y_x(values, "zyx"), affine, "zyx", frame, unit)
    bits, frame, unit = _native.Volume.unpack(data, threads)
    return Volume._of_bits(bits, "zyx", frame, unit)


def unpack_shroud(packed: bytes, *, threads: int | None = None, **settings: Any) -> Shroud:
    """The shroud of a packed volume. Where the file has bits of the places of its vertices, it is the smoothest surface
    that agrees with them.

    ``settings`` are those of :func:`shroud` by their names, ``faces`` and ``border`` excepted, which are packed. With
    bits and without a preset the optimisation goes on until it converges.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> z, y, x = np.ogrid[-9:10, -9:10, -9:10]
    >>> made = shrouds.shroud(x**2 + 2 * y**2 + z**2 < 60)
    >>> again = shrouds.unpack_shroud(made.pack(bits=8))
    >>> bool(abs(again.delta - made.delta).max() <= 2**-8)
    True
    """
    begin = time.perf_counter()
    made, bits, frame, unit = _native.unpack_shroud(bytes(packed), named(settings), threads)
    points = Inside(bits, "zyx", frame, unit, "all but 0")
    return Shroud(points, time.perf_counter() - begin, made)
