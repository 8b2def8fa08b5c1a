"""General coders of meshes, and what comes back from them.

Each takes points in units of the index, triangles and the normals of the surface, and gives, for each number
of quantisation bits, the bits per vertex and the root mean square of how far the vertices moved along the
normals: measured on what is decoded, not computed from the step.
"""

import DracoPy
import meshoptimizer
import numpy as np
import zstandard
from scipy.spatial import cKDTree

BITS = range(7, 17)


def draco(points, triangles, normals):
    """Draco's edgebreaker at its slowest and smallest level."""
    curve = []
    for bits in BITS:
        data = DracoPy.encode(points, triangles, quantization_bits=bits, compression_level=10)
        back = np.asarray(DracoPy.decode(data).points, float).reshape(-1, 3)
        curve.append((8 * len(data) / len(points), moved(points, normals, back)))
    return curve


def meshopt(points, triangles, normals):
    """The buffers of meshoptimizer (EXT_meshopt_compression), and zstd after them, as its author has it."""
    indices = triangles.astype(np.uint32).ravel()
    order = np.zeros_like(indices)
    meshoptimizer.optimize_vertex_cache(order, indices, vertex_count=len(points))
    low, extent = points.min(0), np.ptp(points, axis=0).max()
    curve = []
    for bits in BITS:
        step = extent / (2**bits - 1)
        # A vertex has a multiple of four bytes.
        whole = np.zeros((len(points), 4), np.uint16)
        whole[:, :3] = np.rint((points - low) / step)
        used, fetched = order.copy(), np.zeros_like(whole)
        count = meshoptimizer.optimize_vertex_fetch(fetched, used, whole)
        vertices = meshoptimizer.encode_vertex_buffer(fetched[:count])
        faces = meshoptimizer.encode_index_buffer(used, vertex_count=count)
        data = zstandard.ZstdCompressor(level=19).compress(vertices + faces)
        decoded = meshoptimizer.decode_vertex_buffer(count, 8, vertices).view(np.uint16)
        back = decoded.reshape(count, 4)[:, :3] * step + low
        curve.append((8 * len(data) / len(points), moved(points, normals, back)))
    return curve


def moved(points, normals, back):
    """How far vertices that came back in another order are from the nearest of those that went in."""
    nearest = cKDTree(points).query(back)[1]
    along = np.einsum("ij,ij->i", back - points[nearest], normals[nearest])
    return float(np.sqrt(np.mean(along**2)))


def bits_at(curve, error):
    """Bits per vertex at an error, between the measured ones by the logarithm of the error."""
    bits, errors = np.array(curve).T
    if not errors.min() <= error <= errors.max():
        return None
    return float(np.interp(-np.log(error), -np.log(errors), bits))
