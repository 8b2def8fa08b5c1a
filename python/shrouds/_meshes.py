"""Meshes of any origin: checked against voxels, measured, read."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Selection, Volume, inside
from ._shroud import Shroud, shroud
from ._surfaces import Surface, mesh_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


def check(
    surface: Surface,
    values: ArrayLike | Volume,
    *,
    border: Literal["closed", "open"] = "closed",
    faces: Literal["separate", "join"] = "separate",
    all_axes: bool = False,
    self_intersections: bool = True,
    threads: int | None = None,
    **selection: Unpack[Selection],
) -> dict[str, Any]:
    """Find out whether a mesh separates the voxels of a volume, with exact predicates.

    The mesh may come from anywhere; nothing of what makes shrouds is used.

    Parameters
    ----------
    surface
        A :class:`Shroud`, anything with ``vertices`` and ``faces``, or the two as a tuple, in world
        coordinates.
    values
        The volume.
    border, faces
        The conventions that the mesh was made with, as for :func:`shroud`.
    all_axes
        Whether to follow the lines of the lattice along y and z too: it tells more of meshes with holes.
    self_intersections
        Whether to look for triangles that cross each other, the longest part of the work.
    threads
        Number of threads; all there are if not given.
    **selection
        Where the volume lies and which of its voxels are inside: ``spacing``, ``origin``, ``affine``, ``axes``,
        ``label`` and ``threshold`` of :func:`shroud`.

    Returns
    -------
    dict
        As ``shrouds check --json`` prints it: ``checks["ok"]``, ``checks["problems"]`` in sentences,
        ``checks["wrong_side"]``, the number of voxels on the wrong side, and so on.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> mask = np.zeros((9, 9, 9), bool)
    >>> mask[3:6, 3:6, 3:6] = True
    >>> found = shrouds.check(shrouds.shroud(mask), mask)
    >>> found["checks"]["ok"], found["checks"]["wrong_side"], found["euler"]
    (True, 0, [2])
    """
    volume = inside(values, threads=threads, **selection)
    mesh = mesh_of(surface)
    found = mesh.check(volume.bits, border, faces, all_axes, self_intersections, threads)
    return dict(json.loads(found))


def measure(
    surface: Surface, *, distance_to: Surface | None = None, threads: int | None = None
) -> dict[str, Any]:
    """Measure a surface: volume, area, shape, curvature, thickness, with errors where they are known.

    Of a :class:`Shroud`, volume and area come with their errors and bounds, for these are known of a
    surface between voxels; make it with ``preset="exact"`` for the best numbers, as the program does.

    Parameters
    ----------
    surface
        A :class:`Shroud`, anything with ``vertices`` and ``faces``, or the two as a tuple.
    distance_to
        Another surface, how far from which this one lies is to be measured too.
    threads
        Number of threads; all there are if not given.

    Returns
    -------
    dict
        The columns of ``shrouds measure`` by their names, in the unit of the coordinates to the power
        that each has; None where a number has no meaning, as the volume of an open mesh; and ``notes``.

    Examples
    --------
    A ball of radius 10 in voxels of half a millimetre:

    >>> import numpy as np, shrouds
    >>> z, y, x = np.ogrid[-12:13, -12:13, -12:13]
    >>> ball = shrouds.shroud(x**2 + y**2 + z**2 < 100, spacing=0.5, preset="exact")
    >>> found = shrouds.measure(ball)
    >>> round(found["volume"]), round(found["area"]), found["genus"]
    (521, 313, 0)
    """
    other = None if distance_to is None else mesh_of(distance_to)
    if isinstance(surface, Shroud):
        return dict(json.loads(surface._kept().measure(surface._mesh(), other, threads)))
    return dict(json.loads(mesh_of(surface).measure(other, threads)))


def components(surface: Surface) -> list[tuple[NDArray[np.float64], NDArray[np.uint32]]]:
    """The parts of a mesh that hang together, as vertices and faces of each, in the order of their first triangles.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> mask = np.zeros((9, 9, 9), bool)
    >>> mask[2, 2, 2] = mask[6, 6, 3:7] = True
    >>> [round(shrouds.measure(part)["volume"], 1) for part in shrouds.components(shrouds.shroud(mask))]
    [0.6, 3.9]
    """
    return [(part.arrays()[0], part.arrays()[1]) for part in mesh_of(surface).parts()]


def compare(
    values: ArrayLike | Volume,
    energies: Iterable[str],
    *,
    preset: Literal["fast", "default", "exact"] = "exact",
    threads: int | None = None,
    **options: Any,
) -> list[dict[str, Any]]:
    """Shroud a volume with one energy after the other.

    Parameters
    ----------
    values
        The volume, as for :func:`shroud`.
    energies
        Texts such as ``"bending"`` or ``"bending+0.3*variation"``.
    preset, threads, **options
        As for :func:`shroud`, ``energy`` excepted.

    Returns
    -------
    list of dict
        One for each energy, as the rows of ``shrouds compare --json``: ``energy``, ``status``,
        ``iterations``, ``seconds``, ``value`` (the energy before and after), ``volume``,
        ``volume_error`` (in percent of the voxels'), ``area``, ``roughness`` (in degrees),
        ``largest_move`` (in grid edges), ``at_bound``, ``wrong_side`` and ``problems``.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> mask = np.zeros((9, 9, 9), bool)
    >>> mask[3:6, 3:6, 2:7] = True
    >>> for row in shrouds.compare(mask, ["bending", "length"]):
    ...     print(row["energy"], row["wrong_side"])
    bending 0
    length 0
    """
    rows = []
    for energy in energies:
        made = shroud(values, energy=energy, preset=preset, threads=threads, **options)
        rows.append(_row(made))
    return rows


def _row(made: Shroud) -> dict[str, Any]:
    report = made.report
    solver, geometry, checks = report["solver"], report["geometry"], report["checks"]
    volume = geometry["volume"] if checks["boundary_edges"] == 0 else None
    of_voxels = geometry["voxel_volume"]
    error = None if volume is None or not of_voxels else 100.0 * (volume / of_voxels - 1.0)
    moves = np.abs(made.delta - 0.5)
    return {
        "energy": report["settings"]["energy"],
        "status": solver["status"],
        "iterations": solver["iterations"],
        "seconds": report["times"]["optimize"],
        "value": solver["energy"],
        "projected_step": solver["projected_step"],
        "volume": volume,
        "volume_error": error,
        "area": geometry["area"],
        "roughness": mesh_of(made).roughness(),
        "largest_move": float(moves.max(initial=0.0)),
        "at_bound": solver["at_bound"],
        "wrong_side": checks["wrong_side"],
        "problems": checks["problems"],
    }


def read_mesh(
    path: str | os.PathLike[str],
) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """Read a mesh file: PLY, STL or OBJ.

    Returns
    -------
    vertices : float64, shape (n, 3)
    faces : uint32, shape (m, 3)
        Polygons become fans of triangles; corners of STL at the same place become one vertex.

    Raises
    ------
    OSError
        When the file cannot be read or is damaged.
    ValueError
        When its name does not end as that of a known format.
    """
    vertices, faces, _ = _native.Mesh.read(os.fspath(path)).arrays()
    return vertices, faces
