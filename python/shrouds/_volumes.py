"""Volumes out of volumes, meshes and files."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Axes, Selection, Spacing, Volume, in_z_y_x, index_to_world, inside, three
from ._surfaces import Surface, mesh_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


def read_volume(
    path: str | os.PathLike[str],
    *,
    axes: Axes = "zyx",
    frame: int | None = None,
    array: str | None = None,
    level: int = 0,
) -> Volume:
    """Read a volume file: NIfTI, NRRD, MetaImage, DICOM segmentation, OME-Zarr, TIFF, NPY, NPZ, VTI.

    Parameters
    ----------
    path
        The file, or a folder of TIFF slices or of Zarr.
    axes
        How NumPy files are indexed; other formats name their axes.
    frame
        Which volume of a file that holds several, such as the frames of a series, from 0.
    array
        Which array of a file that holds several, by its name.
    level
        Which resolution of an OME-Zarr image, from the finest, 0.

    Returns
    -------
    Volume
        Indexed ``[z, y, x]``, with the affine of the file. What is doubtful about its header is told as
        warnings.

    Raises
    ------
    OSError
        When the file cannot be read or is damaged.
    ValueError
        When its name does not end as that of a known format, or it holds several volumes.

    Examples
    --------
    >>> import numpy as np, shrouds, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(f"{folder}/mask.npy", np.ones((2, 3, 4), np.uint8))
    ...     volume = shrouds.read_volume(f"{folder}/mask.npy")
    >>> volume.values.shape, volume.frame
    ((2, 3, 4), 'index')
    """
    values, affine, name, unit, doubts = _native.read_volume(
        os.fspath(path), axes, frame, array, level
    )
    for doubt in doubts:
        warnings.warn(f"{os.fspath(path)}: {doubt}", stacklevel=2)
    return Volume(values, np.vstack([affine, (0.0, 0.0, 0.0, 1.0)]), "zyx", name, unit)


def combine(
    operation: Literal["union", "intersect", "subtract", "xor"],
    a: ArrayLike | Volume,
    b: ArrayLike | Volume,
) -> Volume:
    """Combine what is inside two volumes of the same lattice: all that is not 0.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> a, b = np.zeros((2, 3, 3, 3), bool)
    >>> a[:2] = b[1:] = True
    >>> int(shrouds.combine("subtract", a, b).values.sum())
    9
    """
    one, other = inside(a), inside(b)
    made = one.bits.combine(operation, other.bits)
    return Volume._of_bits(made, one.axes, one.frame, one.unit)


def offset(
    values: ArrayLike | Volume,
    by: float,
    *,
    border: Literal["closed", "open"] = "closed",
    keep_lattice: bool = False,
    threads: int | None = None,
    **selection: Unpack[Selection],
) -> Volume:
    """Grow a volume by a distance in world units, or shrink it by a negative one, exactly.

    Every voxel is added whose centre lies within the distance of that of an inside one, or removed that
    lies within it of an outside one. The lattice grows where that is needed, unless it is to be kept.
    ``selection`` is as for :func:`check`.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> point = np.zeros((3, 3, 3), bool)
    >>> point[1, 1, 1] = True
    >>> grown = shrouds.offset(point, 2.0)
    >>> grown.values.shape, int(grown.values.sum())
    ((5, 5, 5), 33)
    >>> grown.affine[:3, 3]
    array([-1., -1., -1.])
    """
    volume = inside(values, threads=threads, **selection)
    made = volume.bits.offset(float(by), border, keep_lattice, threads)
    return Volume._of_bits(made, volume.axes, volume.frame, volume.unit)


def voxelize(
    surface: Surface,
    *,
    size: int | None = None,
    spacing: Spacing | None = None,
    like: Volume | None = None,
    margin: int = 1,
    winding: Literal["non-zero", "positive", "odd"] = "non-zero",
    threads: int | None = None,
) -> Volume:
    """Find the voxels inside a mesh, by generalized winding numbers where it has holes.

    Parameters
    ----------
    surface
        A :class:`Shroud`, anything with ``vertices`` and ``faces``, or the two as a tuple.
    size, spacing, like
        One of them: so many voxels along the longest side of the mesh, margins included; so far apart; or
        the lattice of a volume.
    margin
        Voxels more on every side than the mesh needs; not with ``like``.
    winding
        Which winding numbers are inside: all but 0, those above 0, or the odd ones.
    threads
        Number of threads; all there are if not given.

    Returns
    -------
    Volume
        Of bool, indexed as ``like`` is, else ``[z, y, x]``. What is wrong with the mesh is told as warnings.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> mask = np.zeros((9, 9, 9), bool)
    >>> mask[3:6, 3:6, 2:7] = True
    >>> place = shrouds.Volume(mask, np.eye(4))
    >>> again = shrouds.voxelize(shrouds.shroud(place), like=place)
    >>> bool((again.values == mask).all())
    True
    """
    if sum(choice is not None for choice in (size, spacing, like)) != 1:
        raise ValueError("give one of size, spacing and like")
    mesh, frame, unit = mesh_of(surface), "unnamed", "unknown"
    axes: Axes = "zyx"
    if like is not None:
        nz, ny, nx = in_z_y_x(like.values, like.axes).shape
        affine, dims = index_to_world(None, None, like.affine), (nx, ny, nz)
        axes, frame, unit = like.axes, like.frame, like.unit
    else:
        steps = None if spacing is None else [float(step) for step in three(spacing, "spacing")]
        affine, dims = _native.lattice_for(mesh, steps, size or 0, margin)
    bits, notes = _native.Volume.voxelize(mesh, affine, dims, winding, threads)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return Volume._of_bits(bits, axes, frame, unit)
