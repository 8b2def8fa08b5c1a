"""Packs a mesh with Draco and measures what comes back: python draco.py MESH.ply

The mesh is the one of `TRUE_SURFACE` (crates/shrouds-codec/examples/geometry.rs), in units of the index,
with normals. For each number of quantisation bits: bits per vertex, and the root mean square of how far the
vertices moved along the normals of the surface. Needs DracoPy, trimesh and scipy from PyPI.
"""

import sys

import DracoPy
import numpy as np
import trimesh
from scipy.spatial import cKDTree


def main(path):
    mesh = trimesh.load(path, process=False)
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    normals = np.asarray(mesh.vertex_normals)
    tree = cKDTree(points)
    for bits in range(7, 17):
        data = DracoPy.encode(points, faces, quantization_bits=bits, compression_level=10)
        back = np.asarray(DracoPy.decode(data).points, dtype=float).reshape(-1, 3)
        # Draco renumbers the vertices.
        nearest = tree.query(back)[1]
        moved = np.einsum("ij,ij->i", back - points[nearest], normals[nearest])
        rms = np.sqrt(np.mean(moved**2))
        print(f"{bits} bits: {8 * len(data) / len(points):.3f} bits/vertex, {rms:.5f}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
