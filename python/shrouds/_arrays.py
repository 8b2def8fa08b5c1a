"""What callers give as volumes, brought into the one form that the Rust code takes."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native

Axes = Literal["zyx", "xyz"]
Label = int | Iterable[int]
Affine = tuple[tuple[float, float, float, float], ...]


def volume(
    values: ArrayLike,
    *,
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    affine: ArrayLike | None = None,
    axes: Axes = "zyx",
    label: Label | None = None,
    threshold: float | None = None,
    threads: int | None = None,
) -> _native.Volume:
    """The inside points of an array, a bit each."""
    if label is not None and threshold is not None:
        raise ValueError("give a label or a threshold, not both")
    labels = None if label is None else _labels(label)
    level = None if threshold is None else float(threshold)
    frame = index_to_world(spacing, origin, affine)
    return _native.Volume(in_z_y_x(_usable(values), axes), frame, labels, level, threads)


def in_z_y_x(array: NDArray[Any], axes: Axes) -> NDArray[Any]:
    """A view of an array with its axes turned from, or to, z, y, x."""
    if axes == "zyx":
        return array
    if axes == "xyz":
        return array.transpose()
    raise ValueError(f'axes is {axes!r}, but must be "zyx" or "xyz"')


def index_to_world(
    spacing: float | Sequence[float] | None,
    origin: Sequence[float] | None,
    affine: ArrayLike | None,
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
        steps = _three(1.0 if spacing is None else spacing, "spacing")
        if not (np.isfinite(steps) & (steps > 0)).all():
            raise ValueError("spacing must be positive numbers along x, y, z")
        matrix = np.column_stack([np.diag(steps), _three(origin or 0.0, "origin")])
    return tuple(tuple(map(float, row)) for row in matrix[:3])


def _three(numbers: float | Sequence[float], name: str) -> NDArray[np.float64]:
    array = np.asarray(numbers, dtype=np.float64)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name} must be one number, or three along x, y, z")
    return np.broadcast_to(array, 3)


def _labels(label: Label) -> list[int]:
    labels = list(label) if isinstance(label, Iterable) else [label]
    try:
        return [operator.index(each) for each in labels]
    except TypeError:
        raise ValueError(f"label is {label!r}, but must be one or more whole numbers") from None


def _usable(values: ArrayLike) -> NDArray[Any]:
    """An array of three dimensions of a type that Rust knows: a view, unless its bytes are in another
    order than the machine's, lie astride, or are floats of 16 bits."""
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
