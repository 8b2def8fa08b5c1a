"""What a shroud tells of itself: its planar curves, and how far the work on it has come."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


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


@dataclass(frozen=True, eq=False)
class Curves:
    """The planar curves of a shroud across one axis, one after another."""

    vertices: NDArray[np.uint32]
    """Vertices of all curves in their order along them."""
    starts: NDArray[np.int64]
    """Where each curve begins in ``vertices``; one number more, for the end of the last."""
    closed: NDArray[np.bool_]
    """Whether the last vertex of a curve is joined to its first."""

    def __len__(self) -> int:
        """Number of curves."""
        return len(self.closed)

    def __iter__(self) -> Iterator[NDArray[np.uint32]]:
        """The vertices of each curve."""
        return iter(np.split(self.vertices, self.starts[1:-1]) if len(self) else ())

    def segments(self) -> NDArray[np.uint32]:
        """Pairs of vertices that follow each other, shape (n, 2)."""
        after = np.arange(1, len(self.vertices) + 1)
        ends = self.starts[1:] - 1
        after[ends] = self.starts[:-1]
        keep = np.ones(len(self.vertices), bool)
        keep[ends] = self.closed & (np.diff(self.starts) > 1)
        return np.column_stack([self.vertices, self.vertices[after % max(len(after), 1)]])[keep]
