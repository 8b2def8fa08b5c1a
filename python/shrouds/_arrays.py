"""What callers give as volumes, brought into the one form that the Rust code takes."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native

Axes = Literal["zyx", "xyz"]
Label = int | Iterable[int]
Spacing = float | Sequence[float]
Affine = tuple[tuple[float, float, float, float], ...]


class Place(TypedDict, total=False):
    """Where an array lies, as :func:`shroud` explains it."""

    spacing: Spacing | None
    origin: Sequence[float] | None
    affine: ArrayLike | None
    axes: Axes | None


class Selection(Place, total=False):
    """Where an array lies and which of its voxels are inside, as :func:`shroud` explains it."""

    label: Label | None
    threshold: float | None


@dataclass(frozen=True, eq=False)
class Volume:
    """An array with its place in the world.

    Every function that takes an array takes one of these instead, and then neither ``spacing``, ``origin``
    or ``affine`` nor ``axes``. ``numpy.asarray(volume)`` is its array.
    """

    values: NDArray[Any]
    """One value per lattice point, of three dimensions in the order of ``axes``."""
    affine: NDArray[np.float64]
    """Shape (4, 4): the map from an index (i, j, k) along x, y, z to the world. A voxel is its centre."""
    axes: Axes = "zyx"
    """Whether the array is indexed ``[z, y, x]`` or ``[x, y, z]``."""
    frame: str = "index"
    """What the world is: ``RAS``, ``LPS``, another name, or ``index`` where the file says nothing."""
    unit: str = "unknown"
    """Unit of length."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype=dtype) if copy else np.asarray(self.values, dtype=dtype)

    @classmethod
    def _of_bits(cls, bits: _native.Volume, axes: Axes, frame: str, unit: str) -> Volume:
        affine = np.vstack([bits.affine, (0.0, 0.0, 0.0, 1.0)])
        return cls(in_z_y_x(bits.to_array(), axes), affine, axes, frame, unit)


@dataclass(frozen=True)
class Placed:
    """An array and what is said of its place."""

    values: NDArray[Any]
    """Indexed [z, y, x], of a type that Rust knows."""
    rows: Affine
    axes: Axes
    frame: str
    unit: str


@dataclass(frozen=True)
class Inside:
    """The inside points of an array, and what the array says of its place."""

    bits: _native.Volume
    axes: Axes
    frame: str
    unit: str
    selection: str


def placed(
    values: ArrayLike | Volume,
    spacing: Spacing | None = None,
    origin: Sequence[float] | None = None,
    affine: ArrayLike | None = None,
    axes: Axes | None = None,
) -> Placed:
    """An array with its place."""
    frame, unit = "index", "unknown"
    if isinstance(values, Volume):
        if not (spacing is origin is affine is axes is None):
            raise ValueError("a Volume knows its place: leave spacing, origin, affine and axes out")
        axes, affine, frame, unit = values.axes, values.affine, values.frame, values.unit
        values = values.values
    rows = index_to_world(spacing, origin, affine)
    axes = axes or "zyx"
    return Placed(in_z_y_x(_usable(values), axes), rows, axes, frame, unit)


def inside(
    values: ArrayLike | Volume,
    spacing: Spacing | None = None,
    origin: Sequence[float] | None = None,
    affine: ArrayLike | None = None,
    axes: Axes | None = None,
    label: Label | None = None,
    threshold: float | None = None,
    threads: int | None = None,
) -> Inside:
    """Packs an array to bits."""
    if label is not None and threshold is not None:
        raise ValueError("give a label or a threshold, not both")
    labels = None if label is None else _labels(label)
    level = None if threshold is None else _number(threshold)
    array = placed(values, spacing, origin, affine, axes)
    bits = _native.Volume(array.values, array.rows, labels, level, threads)
    return Inside(bits, array.axes, array.frame, array.unit, _in_words(labels, level))


def in_z_y_x(array: NDArray[Any], axes: Axes) -> NDArray[Any]:
    """A view of an array with its axes turned from, or to, z, y, x."""
    if axes == "zyx":
        return array
    if axes == "xyz":
        return array.transpose()
    raise ValueError(f'axes is {axes!r}, but must be "zyx" or "xyz"')


def index_to_world(
    spacing: Spacing | None, origin: Sequence[float] | None, affine: ArrayLike | None
) -> Affine:
    """Three rows of four, from a spacing and an origin or from an affine."""
    if affine is not None:
        if spacing is not None or origin is not None:
            raise ValueError("an affine holds spacing and origin: leave those out, or the affine")
        matrix = np.asarray(affine, dtype=np.float64)
        if matrix.shape not in ((3, 4), (4, 4)):
            raise ValueError(f"the affine has shape {matrix.shape}, but must be (4, 4) or (3, 4)")
        if matrix.shape == (4, 4) and not np.array_equal(matrix[3], (0, 0, 0, 1)):
            raise ValueError(f"the last row of the affine is {matrix[3]}, but must be 0, 0, 0, 1")
    else:
        steps = three(1.0 if spacing is None else spacing, "spacing")
        if not (np.isfinite(steps) & (steps > 0)).all():
            raise ValueError("spacing must be positive numbers along x, y, z")
        start = three(0.0 if origin is None else origin, "origin")
        matrix = np.column_stack([np.diag(steps), start])
    return tuple((float(a), float(b), float(c), float(d)) for a, b, c, d in matrix[:3])


def three(numbers: float | Sequence[float], name: str) -> NDArray[np.float64]:
    """One number for all axes, or three along x, y, z."""
    array = np.asarray(numbers, dtype=np.float64)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name} must be one number, or three along x, y, z")
    return np.broadcast_to(array, 3)


def _number(threshold: float) -> float:
    level = float(threshold)
    if not np.isfinite(level):
        raise ValueError(f"threshold is {level}, but must be a finite number")
    return level


def _labels(label: Label) -> list[int]:
    labels = list(label) if isinstance(label, Iterable) else [label]
    try:
        return [operator.index(each) for each in labels]
    except TypeError:
        raise ValueError(f"label is {label!r}, but must be one or more whole numbers") from None


def _in_words(labels: list[int] | None, level: float | None) -> str:
    if labels is not None:
        return ", ".join(map(str, labels))
    return "all but 0" if level is None else f"above {level:g}"


def _usable(values: ArrayLike) -> NDArray[Any]:
    """An array of three dimensions of a type that Rust knows: a view, unless its bytes are in another
    order than the machine's or lie astride, or it holds floats of 16 bits."""
    array = np.asarray(values)
    if array.ndim != 3:
        raise ValueError(
            f"the array has shape {array.shape}, but a volume has three dimensions: "
            "take one channel of more, or array[None] of a single slice"
        )
    if array.dtype.kind not in "buif" or array.dtype.itemsize > 8:
        raise ValueError(
            f"the array holds {array.dtype}, but a volume holds bool, integers or floats of at "
            "most 64 bits: convert it with array.astype"
        )
    if array.dtype == np.float16:
        return array.astype(np.float32)
    if not (array.dtype.isnative and array.flags.aligned):
        array = array.astype(array.dtype.newbyteorder("="))
    # A byte of a bool need not be 0 or 1 when it comes from elsewhere.
    return array.view(np.uint8) if array.dtype == np.bool_ else array
