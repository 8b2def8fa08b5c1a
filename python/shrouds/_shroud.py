"""The main call: a volume in, its shroud out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _native


class Progress(NamedTuple):
    """How far the optimisation has come."""

    iteration: int
    """Iterations done."""
    energy: float
    """The energy, with the weights of the moment."""
    change: float
    """What the stop rule looks at."""
    tolerance: float
    """What ``change`` has to come down to; 0 where it need not."""
    share: float | None
    """The share of the work that is done, from 0 to 1, where that is known beforehand."""


class Shroud:
    """An optimal separating surface."""

    def __init__(
        self,
        vertices: NDArray[np.floating[Any]],
        faces: NDArray[np.uint32],
        normals: NDArray[np.float32],
        delta: NDArray[np.float64],
        made: _native.Made,
    ) -> None:
        self.vertices = vertices
        self.faces = faces
        self.normals = normals
        self.delta = delta
        self._made = made

    def __iter__(self) -> Iterator[NDArray[Any]]:
        """``vertices, faces = shroud(...)``."""
        return iter((self.vertices, self.faces))

    def __repr__(self) -> str:
        return f"Shroud({len(self.vertices)} vertices, {len(self.faces)} faces)"


def shroud(
    values: ArrayLike,
    *,
    spacing: float | Sequence[float] | None = None,
    origin: Sequence[float] | None = None,
    affine: ArrayLike | None = None,
    axes: _arrays.Axes = "zyx",
    label: _arrays.Label | None = None,
    threshold: float | None = None,
    energy: str | None = None,
    crease: float | None = None,
    preset: Literal["fast", "default", "exact"] | None = None,
    solver: Literal["newton", "sweeps"] | None = None,
    tolerance: float | None = None,
    max_iterations: int | None = None,
    start: str | None = None,
    margin: float | None = None,
    volume: Literal["free", "keep"] | None = None,
    faces: Literal["separate", "join"] | None = None,
    border: Literal["closed", "open"] | None = None,
    surface: Literal["primal", "dual"] | None = None,
    triangles: Literal["fitted", "fixed"] | None = None,
    threads: int | None = None,
    progress: Callable[[Progress], Any] | None = None,
) -> Shroud:
    """The shroud of a volume."""
    given = {
        "energy": energy,
        "crease": crease,
        "preset": preset,
        "solver": solver,
        "tolerance": tolerance,
        "max_iterations": max_iterations,
        "start": start,
        "margin": margin,
        "volume": volume,
        "faces": faces,
        "border": border,
        "surface": surface,
        "triangles": triangles,
    }
    bits = _arrays.volume(
        values,
        spacing=spacing,
        origin=origin,
        affine=affine,
        axes=axes,
        label=label,
        threshold=threshold,
        threads=threads,
    )
    named = [(name, str(value)) for name, value in given.items() if value is not None]
    tell = None if progress is None else lambda *now: progress(Progress(*now))
    return Shroud(*_native.shroud(bits, named, threads, tell))
