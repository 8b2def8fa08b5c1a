"""The Rust code below the package. Use what the package offers instead."""

from collections.abc import Callable
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ChunkRun",
    "Made",
    "MadeMaterials",
    "Mesh",
    "Volume",
    "__version__",
    "contact_area",
    "energy_with",
    "interfaces",
    "is_labels",
    "lattice_for",
    "pack_labels",
    "read_volume",
    "setting_names",
    "shroud",
    "unpack_labels",
    "unpack_shroud",
    "write_info",
]
__version__: str

_Affine = tuple[tuple[float, float, float, float], ...]
_Curves = tuple[NDArray[np.uint32], NDArray[np.int64], NDArray[np.bool_]]

_Index = tuple[int, int, int]

@final
class ChunkRun:
    def __new__(
        cls,
        folder: str,
        identity: str,
        dims: _Index,
        affine: _Affine,
        chunk: int,
        settings: list[tuple[str, str]],
        threads: int | None,
    ) -> ChunkRun: ...
    @property
    def passes(self) -> int: ...
    def chunks(self) -> list[_Index]: ...
    def voxels(self, chunk: _Index) -> list[tuple[int, int]]: ...
    def has_voxels(self, chunk: _Index) -> bool: ...
    def put_voxels(self, chunk: _Index, volume: Volume) -> None: ...
    def relax(self, pass_: int, chunk: _Index) -> None: ...
    def finish(self, pass_: int) -> tuple[int, int]: ...
    def mesh(self, chunk: _Index) -> tuple[NDArray[np.float64], NDArray[np.uint32]]: ...
    def write_piece(self, chunk: _Index, double: bool) -> None: ...
    def join(self, path: str, double: bool) -> None: ...
    def write_part(self, chunk: _Index, folder: str, double: bool) -> bool: ...
    @property
    def levels(self) -> int: ...
    def coarser(self) -> ChunkRun: ...
    def take_finer(self, finer: ChunkRun, chunk: _Index) -> None: ...
    def write_fragments(self, chunk: _Index, bits: int) -> None: ...
    def join_levels(self, coarser: list[ChunkRun], folder: str, label: str) -> int: ...
    def remove(self) -> None: ...

def write_info(folder: str, dims: _Index, affine: _Affine, bits: int | None) -> None: ...
@final
class Volume:
    def __new__(
        cls,
        values: NDArray[Any],
        affine: _Affine,
        labels: list[int] | None,
        threshold: float | None,
        threads: int | None,
    ) -> Volume: ...
    @property
    def affine(self) -> list[list[float]]: ...
    @property
    def min_spacing(self) -> float: ...
    def count(self) -> int: ...
    def cropped(self, margin: int) -> Volume: ...
    def components(self, faces: str) -> list[Volume]: ...
    def to_array(self) -> NDArray[np.bool_]: ...
    def combine(self, operation: str, other: Volume) -> Volume: ...
    def offset(
        self, by: float, border: str, keep_lattice: bool, threads: int | None
    ) -> Volume: ...
    def pack(
        self,
        profile: str,
        faces: str,
        border: str,
        frame: str,
        unit: str,
        threads: int | None,
    ) -> bytes: ...
    @staticmethod
    def unpack(bytes: bytes, threads: int | None) -> tuple[Volume, str, str]: ...
    @staticmethod
    def voxelize(
        mesh: Mesh,
        affine: _Affine,
        dims: tuple[int, int, int],
        winding: str,
        threads: int | None,
    ) -> tuple[Volume, list[str]]: ...

@final
class Mesh:
    def __new__(
        cls,
        vertices: NDArray[np.float64],
        faces: NDArray[np.uint32],
        normals: NDArray[np.float32] | None,
    ) -> Mesh: ...
    @staticmethod
    def read(path: str) -> Mesh: ...
    def arrays(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.uint32], NDArray[np.float32] | None]: ...
    def write(
        self,
        path: str,
        attributes: dict[str, NDArray[np.float32]],
        frame: str,
        unit: str,
        spacing: float,
    ) -> None: ...
    def measure(self, other: Mesh | None, threads: int | None) -> str: ...
    def parts(self) -> list[Mesh]: ...
    def roughness(self) -> float: ...
    def check(
        self,
        volume: Volume,
        border: str,
        faces: str,
        all_axes: bool,
        self_intersections: bool,
        threads: int | None,
    ) -> str: ...

@final
class Made:
    @property
    def status(self) -> str: ...
    def report(self, mesh: Mesh, said: dict[str, Any], threads: int | None) -> str: ...
    def measure(self, mesh: Mesh, other: Mesh | None, threads: int | None) -> str: ...
    def pack(
        self, delta: NDArray[np.float64], bits: int, profile: str, frame: str, unit: str
    ) -> bytes: ...
    def network(self) -> list[_Curves]: ...

_Shroud = tuple[
    NDArray[np.floating[Any]], NDArray[np.uint32], NDArray[np.float32], NDArray[np.float64], Made
]

def shroud(
    volume: Volume,
    given: list[tuple[str, str]],
    rough: Volume | None,
    threads: int | None,
    progress: Callable[..., Any] | None,
) -> _Shroud: ...
def energy_with(text: str, parameter: str) -> str: ...
def contact_area(
    one: Volume, other: Volume, given: list[tuple[str, str]], threads: int | None
) -> float: ...
def pack_labels(
    values: NDArray[Any], affine: _Affine, profile: str, frame: str, unit: str
) -> bytes: ...
def is_labels(bytes: bytes) -> bool: ...
def unpack_labels(bytes: bytes) -> tuple[NDArray[np.int64], list[list[float]], str, str]: ...
def unpack_shroud(
    bytes: bytes, given: list[tuple[str, str]], threads: int | None
) -> tuple[_Shroud, Volume, str, str]: ...
@final
class MadeMaterials:
    def report(self, said: dict[str, Any], threads: int | None) -> str: ...
    def write(self, path: str, frame: str, unit: str) -> None: ...

def interfaces(
    values: NDArray[Any], affine: _Affine, given: list[tuple[str, str]], threads: int | None
) -> tuple[
    NDArray[np.floating[Any]],
    NDArray[np.uint32],
    NDArray[np.int64],
    NDArray[np.uint32],
    MadeMaterials,
]: ...
def setting_names() -> list[str]: ...
def lattice_for(
    mesh: Mesh, spacing: list[float] | None, size: int, margin: int
) -> tuple[_Affine, tuple[int, int, int]]: ...
def read_volume(
    path: str, axes: str, frame: int | None, array: str | None, level: int
) -> tuple[NDArray[Any], _Affine, str, str, list[str]]: ...
