"""What a mesh that claims to separate a volume has to show, judged without any code of the program.

Volumes are boolean arrays indexed [i, j, k] along x, y, z. A lattice point is its index.
"""

import numpy as np


def sample_volume(dims=(13, 11, 9), seed=5):
    """A volume without symmetry: a slanted body, a rod that ends at the border, and noise."""
    i, j, k = np.meshgrid(*(np.arange(n) for n in dims), indexing="ij")
    body = ((i - 5.2) / 4.1) ** 2 + ((j - 4.4 - 0.2 * i) / 3.2) ** 2 + ((k - 4.1) / 2.6) ** 2 <= 1
    rod = (j == 2) & (k == 7) & (i >= 4)
    noise = np.random.default_rng(seed).random(dims) < 0.04
    return body | rod | noise


def to_index(affine, points):
    """World positions to lattice indices."""
    inverse = np.linalg.inv(affine)
    return points @ inverse[:3, :3].T + inverse[:3, 3]


def windings(points, triangles, dims):
    """How often the mesh, in index coordinates, winds around each lattice point.

    Outward triangles count positive. Lines along x carry the signed crossings; they run past the
    lattice points by a little in y and z, so that they meet no vertex and no edge.
    """
    points = points - np.array([0.0, 3.1e-7, 1.7e-7])
    steps = np.zeros((dims[0] + 1, dims[1], dims[2]), np.int32)
    corners = points[triangles]
    low = np.ceil(corners[:, :, 1:].min(1)).astype(np.int64)
    high = np.floor(corners[:, :, 1:].max(1)).astype(np.int64)
    low, high = np.maximum(low, 0), np.minimum(high, np.array(dims[1:]) - 1)
    reach = (high - low).max(0, initial=-1) + 1
    for dj in range(reach[0]):
        for dk in range(reach[1]):
            line = low + [dj, dk]
            near = np.flatnonzero((line <= high).all(1))
            hit, sign, x = _crossings(points, triangles[near], line[near])
            at = np.clip(np.ceil(x), 0, dims[0]).astype(np.int64)
            j, k = line[near][hit].T
            np.add.at(steps, (at, j, k), -sign)
    return steps.cumsum(0)[: dims[0]]


def _crossings(points, triangles, line):
    """Which triangles meet their line (y, z), on which side (sign of the normal's x) and where."""
    edges = [(1, 2), (2, 0), (0, 1)]  # opposite to each corner
    weights = [_side(points, triangles[:, a], triangles[:, b], line) for a, b in edges]
    weights = np.stack(weights, 1)
    hit = (weights > 0).all(1) | (weights < 0).all(1)
    weights = weights[hit]
    total = weights.sum(1)
    x = (weights * points[triangles[hit]][:, :, 0]).sum(1) / total
    return hit, np.sign(total).astype(np.int32), x


def _side(points, start, end, line):
    """Twice the area that the edge spans with the line; the same bits from both its triangles."""
    first, second = np.minimum(start, end), np.maximum(start, end)
    a, b = points[first, 1:] - line, points[second, 1:] - line
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.where(first == start, area, -area)


def wrong_side(affine, vertices, triangles, inside):
    """Number of lattice points that are not wound exactly once (inside) or never (outside)."""
    around = windings(to_index(affine, vertices), triangles, inside.shape)
    outward = 1 if np.linalg.det(affine[:3, :3]) > 0 else -1
    return int((around * outward != inside).sum())


def assert_separates(mesh, affine, inside):
    """`mesh` (a trimesh.Trimesh in world coordinates) is a closed surface around `inside`."""
    assert mesh.is_watertight, "every edge has two triangles"
    assert mesh.is_winding_consistent, "neighbours are wound alike"
    assert mesh.volume > 0, "normals point outwards"
    points = to_index(affine, np.asarray(mesh.vertices))
    occupied = np.argwhere(inside)
    low, high = occupied.min(0), occupied.max(0)
    rounding = 1e-4  # of files with 32-bit coordinates
    assert (points.min(0) <= low + rounding).all() and (points.min(0) >= low - 1 - rounding).all()
    assert (points.max(0) >= high - rounding).all() and (points.max(0) <= high + 1 + rounding).all()
    assert wrong_side(affine, np.asarray(mesh.vertices), np.asarray(mesh.faces), inside) == 0
