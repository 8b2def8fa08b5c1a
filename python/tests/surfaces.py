"""What tells whether two surfaces are the same."""

import numpy as np
import shrouds


def corners(vertices, faces):
    """The corners of all triangles as bytes, the least one first, sorted."""
    places = np.ascontiguousarray(vertices[faces].astype("<f4"))
    triangles = places.view("S12")[..., 0]
    least = np.argsort(triangles, axis=1)[:, 0]
    order = (least[:, None] + np.arange(3)) % 3
    turned = np.ascontiguousarray(np.take_along_axis(triangles, order, axis=1))
    return np.sort(turned.view("S36")[:, 0])


def whole(array, label, spacing, origin=(0, 0, 0)):
    made = shrouds.shroud(array == label, spacing=spacing, origin=origin)
    return made.vertices, made.faces
