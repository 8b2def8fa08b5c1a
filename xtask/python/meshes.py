"""Meshes in archives, and as PLY."""

import numpy as np
from unpack import members


def inside(name, data, ending):
    """The bytes of a file in an archive, or in an archive within it."""
    for path, read in members(name, data):
        if path.endswith(ending):
            return read()
        if path.endswith((".tar.gz", ".tgz")):
            found = inside(path, read(), ending)
            if found is not None:
                return found
    return None


def read_off(data):
    """The vertices and triangles of an OFF file."""
    lines = (line.split("#")[0] for line in data.decode().splitlines())
    words = " ".join(lines).split()
    vertices, faces = int(words[1]), int(words[2])
    points = np.array(words[4 : 4 + 3 * vertices], float).reshape(-1, 3)
    at, triangles = 4 + 3 * vertices, []
    for _ in range(faces):
        count = int(words[at])
        corners = [int(word) for word in words[at + 1 : at + 1 + count]]
        triangles += [(corners[0], corners[n], corners[n + 1]) for n in range(1, count - 1)]
        at += 1 + count
    return points, np.array(triangles)


def write_ply(path, points, triangles):
    """A binary PLY of doubles."""
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    with open(path, "wb") as file:
        file.write(header.encode() + np.asarray(points, "<f8").tobytes() + faces.tobytes())
