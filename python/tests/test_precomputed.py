"""Neuroglancer layers with Draco-coded meshes of several resolutions, as others read them."""

import needs

needs.packages("zarr", "dask", "distributed", "cloudvolume", "DracoPy", "igneous", "trimesh")

import itertools
import json
import struct

import DracoPy
import numpy as np
import pytest
import shrouds
import trimesh
import zarr
from cloudvolume import CloudVolume
from igneous.task_creation import (
    create_mesh_manifest_tasks,
    create_sharded_multires_mesh_from_unsharded_tasks,
    create_unsharded_multires_mesh_tasks,
)
from scipy.spatial import cKDTree
from shrouds import distributed
from surfaces import corners, whole

#: What a chunk of the store is in nanometres.
SPACING = np.array([10.0, 10.0, 40.0])
LABELS = [7, 2**40 + 3]


@pytest.fixture(scope="module", params=[16, 10])
def layer(request, cluster, store, tmp_path_factory):
    """A layer with so many bits."""
    path = tmp_path_factory.mktemp("layer") / "layer"
    options = {"chunk": 128, "format": "draco", "bits": request.param}
    found = distributed.mesh(store, path, cluster[1], **options)
    assert sorted(found) == LABELS and not path.with_suffix(".work").exists()
    return path, request.param


class Manifest:
    """The file LABEL.index, read as the specification has it."""

    def __init__(self, path):
        data = path.read_bytes()
        self.chunk_shape, self.origin = np.frombuffer(data, "<f4", 6).reshape(2, 3)
        (count,) = struct.unpack_from("<I", data, 24)
        place = 28

        def take(kind, *shape):
            nonlocal place
            number = int(np.prod(shape))
            values = np.frombuffer(data, kind, number, place).reshape(shape)
            place += 4 * number
            return values

        self.scales, self.offsets = take("<f4", count), take("<f4", count, 3)
        counts = take("<u4", count)
        self.levels = [(take("<u4", 3, n).T, take("<u4", n)) for n in map(int, counts)]
        assert place == len(data)


def fragments(path, label, bits):
    """Level, place, box, positions in voxels and faces of every fragment, decoded by Google's Draco."""
    manifest = Manifest(path / "mesh" / f"{label}.index")
    data = (path / "mesh" / str(label)).read_bytes()
    start = 0
    for level, (places, sizes) in enumerate(manifest.levels):
        for place, size in zip(places, sizes, strict=True):
            edge = manifest.chunk_shape * 2.0**level
            low = manifest.origin + manifest.offsets[level] + edge * place
            if size:
                mesh = DracoPy.decode(data[start : start + size])
                assert mesh.points.min() >= 0 and mesh.points.max() < 2**bits
                positions = low + edge * mesh.points.astype(float) / (2**bits - 1)
                yield level, tuple(place), (low, low + edge), positions, mesh.faces
            start += size
    assert start == len(data)


def test_the_finest_level_is_the_surface_within_half_a_step(layer, array):
    path, bits = layer
    volume = CloudVolume(f"file://{path}", progress=False)
    step = 128 / (2**bits - 1)
    for label in LABELS:
        read = volume.mesh.get(label)[label]
        vertices, faces = whole(array, label, tuple(SPACING), tuple(SPACING / 2))
        assert len(read.faces) == len(faces)
        # Of a surface in one tile another program places the vertices; of those in many it is the same.
        near, _ = cKDTree(vertices / SPACING).query(read.vertices / SPACING)
        limit = np.sqrt(3) * step / 2 + 1e-4 if label == 7 else 0.5
        assert near.max() <= limit, (label, near.max())
        if label == 7:
            assert near.max() > 0, "positions are whole numbers"


@pytest.mark.parametrize("label", LABELS)
def test_fragments_are_as_the_format_demands(layer, label):
    path, bits = layer
    manifest = Manifest(path / "mesh" / f"{label}.index")
    assert len(manifest.levels) == 2 and list(manifest.scales) == [1, 2]
    assert (manifest.chunk_shape == 128).all()
    for level, (places, _) in enumerate(manifest.levels):
        codes = [sum((int(x) >> n & 1) << (3 * n + d) for n in range(20) for d, x in enumerate(p)) for p in places]
        assert codes == sorted(set(codes)), "Z-curve order"
        if level:
            parents = {tuple(place // 2) for place in manifest.levels[level - 1][0]}
            assert parents <= {tuple(place) for place in places}, "a cube around each finer one"
    seen = set()
    for level, _, (low, high), positions, faces in fragments(path, label, bits):
        seen.add(level)
        step = (high - low) / (2**bits - 1)
        # No triangle passes a plane between the cubes of the level before.
        places = (positions - (low + high) / 2) / step
        sides = np.where(np.abs(places) < 1, 0, np.sign(places))[faces]
        assert (sides.max(1) * sides.min(1) >= 0).all()
        if level == 0:
            assert (np.abs((high - low) - 128) == 0).all()
    assert seen == {0, 1}


@pytest.mark.parametrize("label", LABELS)
def test_there_are_no_cracks_within_a_level(layer, label):
    path, bits = layer
    found = sorted(fragments(path, label, bits), key=lambda one: one[0])
    for level, group in itertools.groupby(found, key=lambda one: one[0]):
        points, faces, count = [], [], 0
        for _, _, _, positions, triangles in group:
            points.append(positions)
            faces.append(triangles + count)
            count += len(positions)
        mesh = trimesh.Trimesh(np.concatenate(points), np.concatenate(faces), process=False)
        # Vertices of two fragments are one where their numbers say the same place.
        mesh.merge_vertices(digits_vertex=6)
        # Where 10 bits bring two vertices together a triangle becomes a line: then edges still come in pairs.
        low, high = np.sort(mesh.edges, axis=1).astype(np.int64).T
        _, counts = np.unique((low << 32 | high)[low != high], return_counts=True)
        assert (counts % 2 == 0).all(), (level, bits)
        if bits == 16:
            assert mesh.is_watertight and mesh.is_winding_consistent, level


def test_the_second_level_is_the_surface_of_half_as_many_voxels(layer, array):
    path, bits = layer
    if bits == 10:
        pytest.skip("one number of bits is enough")
    inside = array == 7
    padded = np.pad(inside, [(0, n % 2) for n in inside.shape])
    z, y, x = (n // 2 for n in padded.shape)
    halved = padded.reshape(z, 2, y, 2, x, 2).sum((1, 3, 5)) >= 2
    made = shrouds.shroud(halved, spacing=tuple(2 * SPACING), origin=tuple(SPACING / 2))
    parts = [one[3] for one in fragments(path, 7, bits) if one[0] == 1]
    read = np.concatenate(parts)
    near, _ = cKDTree(made.vertices / SPACING).query(read)
    assert len(made.vertices) > 75_000, "more than one tile"
    # Half a step of twice the size.
    assert near.max() <= np.sqrt(3) * 128 / (2**bits - 1) + 1e-4


def test_a_rod_of_one_voxel_is_there_at_every_level(cluster, tmp_path):
    values = np.zeros((40, 50, 600), np.uint8)
    values[20, 25, 3:590] = 4
    # One that touches the border has cubes before the first voxel.
    values[:2, :2, :300] = 9
    zarr.save_array(str(tmp_path / "rods.zarr"), values)
    options = {"chunk": 128, "format": "draco"}
    distributed.mesh(tmp_path / "rods.zarr", tmp_path / "layer", cluster[1], **options)
    for label, ends in ((4, [3, 589]), (9, [0, 299])):
        extents = {}
        for level, _, _, positions, _ in fragments(tmp_path / "layer", label, 16):
            low, high = extents.get(level, (np.inf, -np.inf))
            extents[level] = (min(low, positions[:, 0].min()), max(high, positions[:, 0].max()))
        assert sorted(extents) == [0, 1, 2, 3]
        for level, found in extents.items():
            assert np.abs(np.subtract(found, ends)).max() <= 2**level, (label, level)


def test_one_level_alone(cluster, store, tmp_path):
    options = {"labels": [7], "chunk": 128, "format": "draco", "levels": 1}
    distributed.mesh(store, tmp_path / "a", cluster[1], **options)
    assert len(Manifest(tmp_path / "a" / "mesh" / "7.index").levels) == 1
    assert {one[0] for one in fragments(tmp_path / "a", 7, 16)} == {0}
    info = json.loads((tmp_path / "a" / "mesh" / "info").read_text())
    assert info["@type"] == "neuroglancer_multilod_draco"
    for wrong in ({"bits": 12}, {"levels": 0}):
        with pytest.raises(ValueError, match="must be"):
            distributed.mesh(store, tmp_path / "b", cluster[1], **{**options, **wrong})


def test_igneous_reads_what_is_written_by_fragments(cluster, store, array, tmp_path):
    layer = tmp_path / "layer"
    distributed.mesh(store, layer, cluster[1], labels=[7], chunk=128)
    manifest = layer / "mesh" / "7:0"
    ours = json.loads(manifest.read_text())["fragments"]
    manifest.unlink()
    for task in create_mesh_manifest_tasks(f"file://{layer}"):
        task()
    assert sorted(json.loads(manifest.read_text())["fragments"]) == sorted(ours)
    for task in create_unsharded_multires_mesh_tasks(f"file://{layer}", magnitude=1):
        if task.keywords["prefix"] in (7, "7", "7:"):
            task()
    read = CloudVolume(f"file://{layer}", progress=False).mesh.get(7)[7]
    vertices, faces = whole(array, 7, tuple(SPACING), tuple(SPACING / 2))
    near, _ = cKDTree(vertices / SPACING).query(read.vertices / SPACING)
    assert near.max() < 0.02 and abs(len(read.faces) - len(faces)) < 0.01 * len(faces)


def test_igneous_reads_what_is_written_by_levels(layer, array, tmp_path):
    path, bits = layer
    (tmp_path / "mesh").mkdir()
    for name in ("info", "mesh/info"):
        (tmp_path / name).write_bytes((path / name).read_bytes())
    source, target = f"file://{path}", f"file://{tmp_path}"
    tasks = create_sharded_multires_mesh_from_unsharded_tasks(
        source, target, mesh_dir="mesh", vertex_quantization_bits=16
    )
    for task in tasks:
        task()
    read = CloudVolume(target, progress=False).mesh.get(7)[7]
    vertices, faces = whole(array, 7, tuple(SPACING), tuple(SPACING / 2))
    near, _ = cKDTree(vertices / SPACING).query(read.vertices / SPACING)
    # Triangles that 10 bits make lines of are left out.
    share = len(read.faces) / len(faces)
    assert near.max() < 128 / (2**bits - 1) + 0.02 and share > (0.999 if bits == 16 else 0.9)
