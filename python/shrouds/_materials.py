"""Several materials: one network of interfaces between all labels of a volume."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Place, Placed, Volume, placed
from ._shroud import named

if TYPE_CHECKING:
    import trimesh
    from typing_extensions import Unpack


class Materials:
    """The interfaces between all labels of a volume, as :func:`materials` makes them.

    Every interface is there once, between its two labels; those of a label together are closed, and every voxel lies
    inside its own label.
    """

    vertices: NDArray[np.floating[Any]]
    """Positions in world coordinates x, y, z, shape (n, 3)."""
    faces: NDArray[np.uint32]
    """Vertices of the triangles, shape (m, 3); their normals point from the first label to the second."""
    pairs: NDArray[np.int64]
    """The labels on both sides of each triangle, shape (m, 2): the background, 0, second, else ascending."""
    lines: NDArray[np.uint32]
    """Edges of the mesh where three or more labels meet, shape (l, 2)."""

    def __init__(self, array: Placed, seconds: float, parts: tuple[Any, ...]) -> None:
        self.vertices, self.faces, self.pairs, self.lines, made = parts
        self._made: _native.MadeMaterials = made
        self._said = {
            "selection": "labels",
            "frame": array.frame,
            "unit": array.unit,
            "seconds": seconds,
        }
        self._report: dict[str, Any] | None = None

    def __repr__(self) -> str:
        return f"Materials({len(self.labels)} labels, {len(self.faces)} faces)"

    @property
    def labels(self) -> list[int]:
        """All labels but the background, ascending."""
        return [int(label) for label in np.unique(self.pairs) if label]

    @property
    def report(self) -> dict[str, Any]:
        """What ``shrouds mesh --materials --report`` tells: ``labels`` with volume, area and checks of each,
        ``contacts`` with the area of each, ``checks``, ``topology``, ``solver``, ``times``.

        All boundaries are checked against the voxels when it is first asked for.
        """
        if self._report is None:
            self._report = dict(json.loads(self._made.report(self._said, None)))
        return self._report

    def closed(self, label: int) -> tuple[NDArray[np.floating[Any]], NDArray[np.uint32]]:
        """The boundary of one label as vertices and faces, its normals pointing out: the very triangles that it shares
        with its neighbours.

        Raises
        ------
        ValueError
            When there is no such label.
        """
        first, second = self.pairs.T == label
        faces = self.faces[first | second]
        if not len(faces):
            raise ValueError(f"there is no label {label}: there are {self.labels}")
        turned = second[first | second]
        faces[turned] = faces[turned][:, [0, 2, 1]]
        used, faces = np.unique(faces, return_inverse=True)
        return self.vertices[used], faces.reshape(-1, 3).astype(np.uint32)

    def to_trimesh(self) -> Mapping[int, trimesh.Trimesh]:
        """A closed ``trimesh.Trimesh`` of every label but the background, nothing merged."""
        import trimesh

        return {label: trimesh.Trimesh(*self.closed(label), process=False) for label in self.labels}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all interfaces to one file with their labels: ``.ply``, ``.obj``, ``.glb``, ``.vtp`` or ``.3mf``.

        Raises
        ------
        ValueError
            When the name does not end as that of a format that holds labels.
        OSError
            When the file cannot be written.
        """
        self._made.write(os.fspath(path), str(self._said["frame"]), str(self._said["unit"]))


def materials(
    values: ArrayLike | Volume,
    *,
    preset: Literal["fast", "default", "exact"] | None = None,
    tolerance: float | None = None,
    max_iterations: int | None = None,
    start: str | None = None,
    margin: float | None = None,
    volume: Literal["free", "keep"] | None = None,
    faces: Literal["separate", "join"] | None = None,
    threads: int | None = None,
    **place: Unpack[Place],
) -> Materials:
    """Make the smooth interfaces between all labels of a segmentation, which meet without gaps and keep every voxel
    inside its own label.

    Parameters
    ----------
    values
        An array of whole numbers of three dimensions, or a :class:`Volume`. 0 is the background.
    preset, tolerance, max_iterations, start, margin, faces, threads
        As for :func:`shroud`.
    volume
        ``"keep"`` has every label enclose as many voxel volumes as it has voxels.
    **place
        Where the volume lies: ``spacing``, ``origin``, ``affine`` and ``axes`` of :func:`shroud`.

    Returns
    -------
    Materials
        With ``vertices``, ``faces``, ``pairs``, ``lines``, ``report``, ``closed(label)``. A volume of one label has
        the very surface of :func:`shroud`.

    Raises
    ------
    ValueError
        When the array holds no whole numbers, or a setting is not possible.

    Examples
    --------
    Two halves of a block:

    >>> import numpy as np, shrouds
    >>> labels = np.zeros((12, 12, 12), np.uint8)
    >>> labels[3:6, 3:9, 3:9], labels[6:9, 3:9, 3:9] = 1, 2
    >>> made = shrouds.materials(labels)
    >>> made.labels, np.unique(made.pairs, axis=0).tolist()
    ([1, 2], [[1, 0], [1, 2], [2, 0]])
    >>> made.report["checks"]["wrong_label"]
    0
    """
    begin = time.perf_counter()
    array = placed(values, **place)
    if array.values.dtype.kind not in "bui":
        raise ValueError(f"the array holds {array.values.dtype}, but labels are whole numbers")
    given = {
        "preset": preset,
        "tolerance": tolerance,
        "max_iterations": max_iterations,
        "start": start,
        "margin": margin,
        "volume": volume,
        "faces": faces,
    }
    seconds = time.perf_counter() - begin
    made = _native.interfaces(array.values, array.rows, named(given), threads)
    return Materials(array, seconds, made)
