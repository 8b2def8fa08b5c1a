"""The main call: a volume in, its shroud out."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Axes, Inside, Label, Spacing, Volume, inside
from ._curves import Curves, Progress

if TYPE_CHECKING:
    import pyvista
    import trimesh


Parameter = Literal["uniform", "chord", "centripetal", "affine", "foley"]
Profile = Literal["fast", "dense"]


class Shroud:
    """An optimal separating surface, as :func:`shroud` makes it.

    It unpacks to its mesh: ``vertices, faces = shrouds.shroud(mask)``.
    """

    vertices: NDArray[np.floating[Any]]
    """Positions in world coordinates x, y, z, shape (n, 3): float32, or float64 where the lattice lies so
    far from the origin that 32 bits would move a vertex by more than a ten-thousandth of a voxel."""
    faces: NDArray[np.uint32]
    """Vertices of the triangles, counter-clockwise seen from outside, shape (m, 3)."""
    normals: NDArray[np.float32]
    """Unit normals of the vertices, pointing outside, shape (n, 3)."""
    delta: NDArray[np.float64]
    """Where each vertex lies on its grid edge: 1 at the inside end, 0 at the outside end. Those of the
    primal surface, whichever mesh was made."""

    def __init__(self, inside: Inside, seconds: float, parts: tuple[Any, ...]) -> None:
        self.vertices, self.faces, self.normals, self.delta, made = parts
        self._made: _native.Made | None = made
        self._status: str = made.status
        self._said = {
            "selection": inside.selection,
            "frame": inside.frame,
            "unit": inside.unit,
            "seconds": seconds,
        }
        self._spacing = inside.bits.min_spacing
        self._report: dict[str, Any] | None = None
        self._network: tuple[Curves, Curves, Curves] | None = None

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return iter((self.vertices, self.faces))

    def __repr__(self) -> str:
        return f"Shroud({len(self.vertices)} vertices, {len(self.faces)} faces)"

    def __getstate__(self) -> dict[str, Any]:
        _ = self.report
        return {**self.__dict__, "_made": None}

    @property
    def status(self) -> str:
        """How the optimisation ended: ``"converged"``, ``"preset done"`` after the steps of a preset, and so on."""
        return self._status

    def pack(self, bits: Literal[0, 1, 2, 4, 8] = 0, profile: Profile = "dense") -> bytes:
        """The bytes of a ``.shroud`` file: the voxels without loss, and so many bits of the place of every vertex.

        With 0 bits the surface is made anew from the voxels; :func:`unpack_shroud` does so in either case.
        """
        frame, unit = str(self._said["frame"]), str(self._said["unit"])
        return self._kept().pack(self.delta, bits, profile, frame, unit)

    def _kept(self) -> _native.Made:
        if self._made is None:
            raise RuntimeError(
                "a shroud that was pickled has left its voxels behind: "
                "ask for its network and its measures before, or measure (vertices, faces)"
            )
        return self._made

    @property
    def report(self) -> dict[str, Any]:
        """What ``shrouds mesh --json`` prints: ``input``, ``settings``, ``topology``, ``solver``,
        ``geometry``, ``checks``, ``times``, ``memory`` and ``version``.

        The mesh is checked against the voxels when it is first asked for: that no voxel is on the wrong
        side and that the mesh is a closed manifold of the right topology; :func:`check` looks for
        triangles that cross each other, too.
        """
        if self._report is None:
            text = self._kept().report(self._mesh(), self._said, None)
            self._report = dict(json.loads(text))
        return self._report

    @property
    def network(self) -> tuple[Curves, Curves, Curves]:
        """The planar curves in which the lattice planes across x, y and z cut the primal surface.

        Every vertex lies on exactly two of them. They number the vertices of the primal mesh.
        """
        if self._network is None:
            x, y, z = (Curves(*family) for family in self._kept().network())
            self._network = (x, y, z)
        return self._network

    def to_trimesh(self) -> trimesh.Trimesh:
        """A ``trimesh.Trimesh`` of the same vertices and faces, nothing merged."""
        import trimesh

        return trimesh.Trimesh(
            self.vertices, self.faces, vertex_normals=self.normals, process=False
        )

    def to_pyvista(self) -> pyvista.PolyData:
        """A ``pyvista.PolyData`` with the normals, and of a primal mesh ``delta``, as point data."""
        import pyvista

        # Its stubs ask for numbers of 64 bits, and it keeps those of 32.
        create: Any = pyvista.PolyData.from_regular_faces
        data = cast("pyvista.PolyData", create(self.vertices, self.faces))
        data.point_data.active_normals = self.normals
        if len(self.delta) == len(self.vertices):
            data.point_data["delta"] = self.delta
        return data

    def to_napari(self, name: str = "shroud") -> tuple[tuple[Any, ...], dict[str, Any], str]:
        """A layer for napari, ``viewer.add_layer(napari.layers.Layer.create(*made.to_napari()))``, with
        coordinates in napari's order z, y, x."""
        return (self.vertices[:, ::-1], self.faces), {"name": name}, "surface"

    def save(self, path: str | os.PathLike[str], attributes: Sequence[str] = ()) -> None:
        """Write the mesh to a file: ``.ply``, ``.stl``, ``.obj``, ``.glb``, ``.vtp`` or ``.3mf``.

        The file appears whole or not at all. ``attributes=["delta"]`` puts δ of every vertex of a primal
        mesh into PLY, GLB and VTP.

        Raises
        ------
        ValueError
            When the name does not end as that of a known format, or the format cannot hold the mesh.
        OSError
            When the file cannot be written.
        """
        numbers = {name: self._attribute(name) for name in attributes}
        frame, unit = str(self._said["frame"]), str(self._said["unit"])
        self._mesh().write(os.fspath(path), numbers, frame, unit, self._spacing)

    def _mesh(self) -> _native.Mesh:
        vertices = np.ascontiguousarray(self.vertices, np.float64)
        return _native.Mesh(vertices, self.faces, self.normals)

    def _attribute(self, name: str) -> NDArray[np.float32]:
        if name != "delta":
            raise ValueError(f"there is no attribute {name!r}: give delta")
        if len(self.delta) != len(self.vertices):
            raise ValueError("delta belongs to the vertices of a primal mesh, and this one is dual")
        return self.delta.astype(np.float32)


class NotConverged(RuntimeError):
    """The optimisation was to converge and did not."""

    shroud: Shroud
    """What there is."""

    def __init__(self, made: Shroud) -> None:
        super().__init__(
            f"the optimisation ended with status {made.status!r}: "
            "give more max_iterations or a larger tolerance, or leave strict out"
        )
        self.shroud = made


def shroud(
    values: ArrayLike | Volume,
    *,
    spacing: Spacing | None = None,
    origin: Sequence[float] | None = None,
    affine: ArrayLike | None = None,
    axes: Axes | None = None,
    label: Label | None = None,
    threshold: float | None = None,
    energy: str | None = None,
    parameter: Parameter | None = None,
    crease: float | None = None,
    rough: ArrayLike | Volume | None = None,
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
    strict: bool = False,
    threads: int | None = None,
    progress: Callable[[Progress], Any] | None = None,
) -> Shroud:
    """Make the smooth surface of a segmentation that keeps every voxel on its own side.

    Parameters
    ----------
    values
        An array of three dimensions of bool, integers or floats, in any memory order, read-only or
        memory-mapped; it is not copied. Or a :class:`Volume`, which knows its place.
    spacing
        Distance of the voxel centres along **x, y, z**, whatever the order of the axes, or one for all.
        1 if not given.
    origin
        Where the centre of the first voxel lies, x, y, z. 0 if not given.
    affine
        In place of both: shape (4, 4), the map from an index along x, y, z to the world, as nibabel has it.
    axes
        ``"zyx"`` if the array is indexed ``[z, y, x]``, as images are and as the program reads NumPy files:
        the default. ``"xyz"`` for arrays of nibabel.
    label
        Inside are the voxels with this whole number, or with one of several. All but 0 if not given.
    threshold
        Inside are the voxels with a value strictly above this.
    energy
        What the slice curves minimise: ``"bending"``, or a weighted sum such as ``"bending+0.3*variation"``.
        That which the preset is made for if not given.
    parameter
        Parametrisation of the measures that have one and are written without: ``energy="curvature"`` with
        ``parameter="foley"`` is ``"curvature(foley)"``.
    crease
        Edges stay sharp where a slice curve turns by much more than so many degrees (5.7, say), and faces
        become flat: for boxes and machine parts. Not with the preset ``exact``.
    rough
        Voxels at which the surface need not be smooth: an array of the same shape and order, all but 0, or a
        :class:`Volume` on the same lattice.
    preset
        How much work goes into the minimum: ``"fast"``, one step; ``"default"``, three; ``"exact"``, until it
        converges.
    solver
        ``"newton"`` (the default), or ``"sweeps"``, the paper's own method: slow.
    tolerance
        When to stop, above 0 and below 1; asks for the preset ``exact``.
    max_iterations
        Most steps or sweeps; 0 leaves the start as it is.
    start
        Where the vertices start: ``"blur"`` (the default), ``"midpoint"``, ``"inside"``, ``"outside"`` or
        ``"random:SEED"``.
    margin
        How near a vertex may come to an end of its grid edge, in edge lengths. 0.002 if not given.
    volume
        ``"keep"`` has every connected component enclose as many voxel volumes as voxels.
    faces
        How ambiguous cell faces are cut: ``"separate"`` (the default) or ``"join"`` the inside corners.
    border
        ``"closed"`` (the default): what lies beyond the array is outside. ``"open"``: the surface ends there.
    surface
        ``"primal"`` (the default), or ``"dual"`` for well-shaped triangles, for print and simulation.
    triangles
        ``"fitted"`` to the curves' normals (the default), or ``"fixed"``, the same for every place of the
        vertices.
    strict
        Go on until the optimisation converges, as ``preset="exact"`` does, and raise :class:`NotConverged`
        where it does not.
    threads
        Number of threads; all there are if not given. The result has the same bits for any number.
    progress
        Called with a :class:`Progress` after every iteration, more often on large surfaces, from the thread
        that called; where it returns False the work stops with what it has.

    Returns
    -------
    Shroud
        With ``vertices``, ``faces``, ``normals``, ``delta``, ``network``, ``report``. A volume with nothing
        inside gives one without vertices.

    Raises
    ------
    ValueError
        When the array is no volume, holds a NaN, or a setting is not possible. The message says what is.
    NotConverged
        Under ``strict``. It has the :class:`Shroud` that there is.

    Notes
    -----
    Other threads of Python run meanwhile; the array must not change before the call returns. Ctrl-C ends
    the call at once with KeyboardInterrupt; the work behind it notices a moment later.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> z, y, x = np.ogrid[-12:13, -12:13, -12:13]
    >>> ball = x**2 + y**2 + z**2 < 100
    >>> made = shrouds.shroud(ball, spacing=0.5, origin=(-6, -6, -6))
    >>> made
    Shroud(1830 vertices, 3656 faces)
    >>> radii = np.linalg.norm(made.vertices, axis=1)
    >>> bool(abs(radii.mean() - 5) < 0.1)
    True
    >>> vertices, faces = made
    >>> made.report["checks"]["wrong_side"]
    0

    With a progress bar of tqdm::

        with tqdm(total=1.0) as bar:
            shrouds.shroud(mask, progress=lambda now: bar.update((now.share or bar.n) - bar.n))
    """
    begin = time.perf_counter()
    points = inside(values, spacing, origin, affine, axes, label, threshold, threads)
    seconds = time.perf_counter() - begin
    if strict:
        if preset in ("fast", "default"):
            raise ValueError(f"{preset} stops before convergence: leave the preset or strict out")
        preset = preset if solver == "sweeps" else "exact"
    given = {
        "energy": _energy(energy, parameter),
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
    places = None if rough is None else _rough(rough, values, points, threads)
    made = _native.shroud(points.bits, named(given), places, threads, _teller(progress))
    result = Shroud(points, seconds, made)
    if strict and result.status not in ("converged", "empty"):
        raise NotConverged(result)
    return result


def named(given: Mapping[str, object]) -> list[tuple[str, str]]:
    """The settings that were given, as Rust takes them."""
    return [(name, str(value)) for name, value in given.items() if value is not None]


def _energy(energy: str | None, parameter: str | None) -> str | None:
    return energy if parameter is None else _native.energy_with(energy or "bending", parameter)


def _rough(
    rough: ArrayLike | Volume, values: ArrayLike | Volume, points: Inside, threads: int | None
) -> _native.Volume:
    """The voxels of a mask, on the lattice of the volume unless it has its own."""
    if isinstance(rough, Volume):
        return inside(rough, threads=threads).bits
    array = np.asarray(rough)
    if array.shape != np.shape(values):
        raise ValueError(f"rough has shape {array.shape}, but the volume {np.shape(values)}")
    affine = np.array(points.bits.affine)
    return inside(array, affine=affine, axes=points.axes, threads=threads).bits


def _teller(progress: Callable[[Progress], Any] | None) -> Callable[..., Any] | None:
    """The callback as Rust calls it."""
    if progress is None:
        return None
    return lambda *now: progress(Progress(*now))
