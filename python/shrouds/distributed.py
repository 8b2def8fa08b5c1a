"""Surfaces of volumes of any size, chunk by chunk, on the workers of Dask.

>>> from dask.distributed import Client                                   # doctest: +SKIP
>>> import shrouds.distributed                                            # doctest: +SKIP
>>> shrouds.distributed.mesh("neurons.zarr", "meshes", Client())          # doctest: +SKIP

A label array in a Zarr or OME-Zarr store goes in; out come meshes as Neuroglancer's precomputed format has them, or
PLY files. Each task sees one chunk and what lies around it; what it finds goes to a folder that all workers share, in
files that appear whole or not at all. So a task whose worker was killed is done again by another, a run that was
broken off is continued by the same call, and the bytes that come out are the same in any case. The surface
does not depend on the size of the chunks or the number of workers, either (see ``docs/scale.md``).

Needs the packages ``zarr`` and ``distributed``.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ._native import ChunkRun, Volume, __version__, write_info

if TYPE_CHECKING:
    from dask.distributed import Client

__all__ = ["Source", "find_labels", "mesh"]

#: How often a task is tried again whose worker failed.
RETRIES = 5
#: Nanometres in the units of OME-Zarr.
_NANOMETRES = {
    "angstrom": 0.1,
    "nanometer": 1.0,
    "micrometer": 1e3,
    "millimeter": 1e6,
    "centimeter": 1e7,
    "meter": 1e9,
}

Index = tuple[int, int, int]


@dataclass(frozen=True)
class Source:
    """A label array in a store, indexed [z, y, x] behind what ``leading`` fixes.

    ``spacing`` and ``origin`` are along x, y, z; ``unit`` is that of a length.
    """

    path: str
    array: str
    shape: Index
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    unit: str
    leading: tuple[int, ...] = ()

    @classmethod
    def open(cls, path: str | os.PathLike[str], level: int = 0) -> Source:
        """The array in a Zarr store, or one level of an OME-Zarr image, 0 being the finest.

        Axes before the last three must have length 1.
        """
        import zarr

        node: Any = zarr.open(str(path), mode="r")
        scale, shift, unit, name = [1.0] * 3, [0.0] * 3, "unknown", ""
        if isinstance(node, zarr.Group):
            attributes: dict[str, Any] = dict(node.attrs)
            images = attributes.get("ome", attributes).get("multiscales")
            if not images:
                raise ValueError(f"{path}: a group without multiscales; name the array in it")
            image = images[0]
            if not 0 <= level < len(image["datasets"]):
                raise ValueError(f"{path}: level {level} of {len(image['datasets'])}")
            dataset = image["datasets"][level]
            name = dataset["path"]
            axes = image.get("axes") or []
            if [axis.get("name") for axis in axes[-3:]] not in ([], ["z", "y", "x"]):
                raise ValueError(f"{path}: the last axes are not z, y, x")
            unit = next((axis.get("unit", unit) for axis in axes[-1:]), unit)
            own = dataset.get("coordinateTransformations", [])
            for step in [*own, *image.get("coordinateTransformations", [])]:
                if step["type"] == "scale":
                    scale = [a * b for a, b in zip(scale, step["scale"][-3:], strict=True)]
                    shift = [a * b for a, b in zip(shift, step["scale"][-3:], strict=True)]
                elif step["type"] == "translation":
                    shift = [a + b for a, b in zip(shift, step["translation"][-3:], strict=True)]
            node = node[name]
        if node.ndim < 3 or any(n != 1 for n in node.shape[:-3]):
            raise ValueError(f"{path}: an array of shape {node.shape} is not one volume")
        z, y, x = node.shape[-3:]
        (sz, sy, sx), (oz, oy, ox) = scale, shift
        leading = (0,) * (node.ndim - 3)
        return cls(str(path), name, (z, y, x), (sx, sy, sz), (ox, oy, oz), unit, leading)

    def read(self, ranges: Iterable[tuple[int, int]]) -> np.ndarray[Any, Any]:
        """The voxels between the first index and before the last one along x, y, z, indexed [z, y, x]."""
        import zarr

        node: Any = zarr.open(self.path, mode="r")
        array = node[self.array] if self.array else node
        x, y, z = (slice(*ends) for ends in ranges)
        return np.ascontiguousarray(array[(*self.leading, z, y, x)])

    def identity(self) -> str:
        """A text that tells the array from others: its metadata and those of its files that change with it."""
        folder = Path(self.path, self.array)
        known = [folder / name for name in ("zarr.json", ".zarray", ".zattrs")]
        texts = [file.read_text() for file in known if file.is_file()]
        return "\n".join([str(folder.resolve()), *texts])


@dataclass(frozen=True)
class _Job:
    """The work on one label: all that a task needs to know."""

    source: Source
    label: int
    folder: str
    chunk: int
    affine: tuple[tuple[float, float, float, float], ...]
    settings: tuple[tuple[str, str], ...]
    threads: int
    #: How often the lattice is halved.
    level: int = 0

    def run(self) -> ChunkRun:
        run = self._finest()
        for _ in range(self.level):
            run = run.coarser()
        return run

    def levels(self) -> list[_Job]:
        """The work on the lattice itself and on halved ones, until one chunk holds all."""
        return [replace(self, level=level) for level in range(self._finest().levels)]

    def _finest(self) -> ChunkRun:
        identity = json.dumps(
            [__version__, self.source.identity(), self.label, self.chunk, self.affine, self.settings]
        )
        z, y, x = self.source.shape
        return ChunkRun(
            self.folder,
            hashlib.sha256(identity.encode()).hexdigest(),
            (x, y, z),
            self.affine,
            self.chunk,
            list(self.settings),
            self.threads,
        )


def _labels_of(source: Source, ranges: list[tuple[int, int]]) -> list[int]:
    return [int(label) for label in np.unique(source.read(ranges)) if label]


def _put_voxels(jobs: list[_Job], chunk: Index) -> None:
    missing = [(job, run) for job in jobs if not (run := job.run()).has_voxels(chunk)]
    if missing:
        values = missing[0][0].source.read(missing[0][1].voxels(chunk))
        for job, run in missing:
            volume = Volume(values, job.affine, [job.label], None, job.threads)
            run.put_voxels(chunk, volume)


def _take_finer(job: _Job, chunk: Index) -> None:
    job.run().take_finer(replace(job, level=job.level - 1).run(), chunk)


def _relax(job: _Job, number: int, chunk: Index) -> None:
    job.run().relax(number, chunk)


def _finish(job: _Job, number: int) -> tuple[int, int]:
    return job.run().finish(number)


def _write_piece(job: _Job, chunk: Index) -> None:
    job.run().write_piece(chunk, False)


def _join(job: _Job, path: str) -> None:
    job.run().join(path, False)


def _write_part(job: _Job, folder: str, chunk: Index) -> None:
    job.run().write_part(chunk, folder, False)


def _write_fragments(job: _Job, bits: int, chunk: Index) -> None:
    job.run().write_fragments(chunk, bits)


def _join_levels(jobs: list[_Job], folder: str) -> None:
    finest, *coarser = [job.run() for job in jobs]
    finest.join_levels(coarser, folder, str(jobs[0].label))


def _write_fragment(job: _Job, folder: str, chunk: Index) -> str | None:
    """Writes the mesh of a chunk as a fragment of its label; the name of the fragment, if there are triangles."""
    run = job.run()
    vertices, faces = run.mesh(chunk)
    if not len(faces):
        return None
    places = "_".join(f"{start}-{end}" for start, end in run.voxels(chunk))
    name = f"{job.label}:0:{places}"
    count = struct.pack("<I", len(vertices))
    _write(Path(folder, name), count + vertices.astype("<f4").tobytes() + faces.astype("<u4").tobytes())
    return name


def _write(path: Path, data: bytes) -> None:
    """Writes a file that appears whole or not at all."""
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=".shrouds-", suffix=".part", delete=False) as file:
        try:
            file.write(data)
        except BaseException:
            os.unlink(file.name)
            raise
    os.chmod(file.name, 0o644)
    os.replace(file.name, path)


def _all(client: Client, task: Any, chunks: Iterable[Any], *before: Any) -> list[Any]:
    """What a task gives for every chunk, all of which are done then."""
    futures = [client.submit(task, *before, chunk, pure=False, retries=RETRIES) for chunk in chunks]
    return list(client.gather(futures))


def find_labels(source: Source, client: Client, chunk: int = 256) -> list[int]:
    """The labels of an array but 0, in order."""

    def boxes() -> Iterator[list[tuple[int, int]]]:
        steps = [range(0, count, chunk) for count in reversed(source.shape)]
        for z in steps[2]:
            for y in steps[1]:
                for x in steps[0]:
                    starts = zip((x, y, z), reversed(source.shape), strict=True)
                    yield [(start, min(start + chunk, end)) for start, end in starts]

    found = _all(client, _labels_of, boxes(), source)
    return sorted({label for some in found for label in some})


def mesh(
    source: Source | str | os.PathLike[str],
    output: str | os.PathLike[str],
    client: Client,
    *,
    labels: Iterable[int] | None = None,
    chunk: int = 256,
    format: Literal["precomputed", "draco", "ply", "parts"] = "precomputed",
    levels: int | None = None,
    bits: Literal[10, 16] = 16,
    work: str | os.PathLike[str] | None = None,
    threads: int = 1,
    **settings: Any,
) -> dict[int, tuple[int, int]]:
    """Writes the surface of every label, or of some, and returns how many vertices and triangles each has.

    Parameters
    ----------
    source
        The label array: the path of a Zarr or OME-Zarr store, or a :class:`Source`.
    output
        A folder. With ``format="precomputed"`` a layer for Neuroglancer and ``cloud-volume``, with one legacy mesh of
        single resolution for each label, positions in nanometres as floats, the corner of the first voxel at the
        origin of the layer as Neuroglancer has it. With ``"draco"`` the same layer with meshes of several
        resolutions, coded by Draco: a tenth of the bytes, and what is far is read coarse. With ``"ply"`` a file
        ``LABEL.ply`` each; with ``"parts"`` a folder ``LABEL`` each, with a PLY file for every chunk. PLY has the
        coordinates of the image, its unit.
    client
        Of ``dask.distributed``. All workers must see the folders under the same names.
    labels
        Default all but 0.
    chunk
        Voxels along an edge of a chunk, a multiple of 128.
    levels
        For ``"draco"`` the number of resolutions, each the surface of half as many voxels along each axis as the one
        before; default until one chunk holds all, and 1 for the finest alone.
    bits
        For ``"draco"`` those of each coordinate within its chunk. Vertices move by up to half a step, which is
        ``chunk / (2**bits - 1)`` voxels.
    work
        A folder for what is found on the way; default ``OUTPUT.work``. It is removed when all is done.
    threads
        Threads for each task.
    settings
        Those of :func:`shrouds.shroud` by their names, with the presets ``fast`` and ``default``.
    """
    if not isinstance(source, Source):
        source = Source.open(source)
    if format not in ("precomputed", "draco", "ply", "parts"):
        known = '"precomputed", "draco", "ply" or "parts"'
        raise ValueError(f"format is {format!r}, but must be {known}")
    if levels is not None and levels < 1:
        raise ValueError(f"levels is {levels}, but must be 1 or more")
    wanted = find_labels(source, client, chunk) if labels is None else sorted(set(labels))
    output, work = Path(output), Path(work if work is not None else f"{output}.work")
    output.mkdir(parents=True, exist_ok=True)
    work.mkdir(parents=True, exist_ok=True)
    placed = _in_nanometres(source) if format in ("precomputed", "draco") else source
    names = tuple(sorted((name, str(value)) for name, value in settings.items() if value is not None))
    jobs = [
        _Job(source, label, str(work / str(label)), chunk, _affine(placed), names, threads)
        for label in wanted
    ]
    if not jobs:
        return {}
    # Settings that are wrong show here, before any task.
    chunks = [job.run().chunks() for job in jobs][0]
    if format in ("precomputed", "draco"):
        x, y, z = reversed(source.shape)
        write_info(str(output), (x, y, z), _affine(placed), bits if format == "draco" else None)
    _all(client, _put_voxels, chunks, jobs)
    found = {}
    for job in jobs:
        found[job.label] = _relax_all(client, job)
        if format == "draco":
            _write_levels(client, job.levels()[:levels], bits, output / "mesh")
        else:
            _write_label(client, job, chunks, output, format)
    for job in jobs:
        job.run().remove()
    work.rmdir()
    return found


def _relax_all(client: Client, job: _Job) -> tuple[int, int]:
    """Makes all passes; the number of vertices and of triangles."""
    run, counts = job.run(), (0, 0)
    for number in range(run.passes):
        _all(client, _relax, run.chunks(), job, number)
        (counts,) = _all(client, _finish, [number], job)
    return counts


def _write_label(
    client: Client, job: _Job, chunks: list[Index], output: Path, format: str
) -> None:
    if format == "ply":
        _all(client, _write_piece, chunks, job)
        _all(client, _join, [str(output / f"{job.label}.ply")], job)
    elif format == "parts":
        folder = output / str(job.label)
        folder.mkdir(exist_ok=True)
        _all(client, _write_part, chunks, job, str(folder))
    else:
        written = _all(client, _write_fragment, chunks, job, str(output / "mesh"))
        names = [name for name in written if name]
        # With this file the mesh is there.
        _write(output / "mesh" / f"{job.label}:0", json.dumps({"fragments": names}).encode())


def _write_levels(client: Client, jobs: list[_Job], bits: int, folder: Path) -> None:
    """Writes the mesh of a label in all resolutions, of which the finest has its passes behind it."""
    for job in jobs:
        # The folder of a level is made here, before tasks look for it.
        chunks = job.run().chunks()
        if job.level:
            _all(client, _take_finer, chunks, job)
            _relax_all(client, job)
        _all(client, _write_fragments, chunks, job, bits)
    _all(client, _join_levels, [str(folder)], jobs)


def _affine(source: Source) -> tuple[tuple[float, float, float, float], ...]:
    rows = []
    for axis, (spacing, origin) in enumerate(zip(source.spacing, source.origin, strict=True)):
        row = [0.0] * 3
        row[axis] = spacing
        rows.append((*row, origin))
    return tuple((a, b, c, d) for a, b, c, d in rows)


def _in_nanometres(source: Source) -> Source:
    """The lattice in Neuroglancer's coordinates, where voxel 0 reaches from 0 to 1."""
    spacing = _resolution(source)
    x, y, z = (0.5 * step for step in spacing)
    return replace(source, spacing=spacing, origin=(x, y, z), unit="nanometer")


def _resolution(source: Source) -> tuple[float, float, float]:
    factor = _NANOMETRES.get(source.unit, 1.0)
    x, y, z = (factor * step for step in source.spacing)
    return x, y, z
