"""Containment regions over a level floor against formulas, voxel for voxel."""

import json

import nibabel
import numpy as np
from scipy.ndimage import distance_transform_edt

FLOOR, ARRAY, SPEED, SPACING = 430.0, 60.0, 3.1, np.array([50.0, 60.0, 40.0])
SCENE = """
[sea]
from = [-1500, -1800]
to = [1500, 1800]
depth = 520
spacing = [50, 60, 40]
[floor.flat]
depth = 430
[target]
speed = 3.1
[[platform]]
time = 0
position = [-130, 70]
depth = 60
course = 37
[[platform]]
time = 600
position = [410, 530]
depth = 60
course = 37
"""
CONTACTS = [
    {"time": 0, "bearing": 63.3, "half_width": 4.1, "path": "bounce"},
    {"time": 97, "bearing": 71.9, "half_width": 3.3, "path": "direct"},
    {"time": 211, "bearing": 68.7, "half_width": 5.9, "path": "either", "range": [310.5, 1203.7]},
]


def angle(points, contact, mirrored):
    """Degrees between the array's axis and the way from it to points, or to their images below the floor."""
    share = contact["time"] / 600
    array = np.array([-130 + share * 540, 70 + share * 460, -ARRAY])
    course = np.radians(37)
    axis = np.array([np.sin(course), np.cos(course), 0.0])
    points = points.copy()
    if mirrored:
        points[..., 2] = -2 * FLOOR - points[..., 2]
    way = points - array
    distance = np.hypot(way[..., 0], way[..., 1])
    return np.degrees(np.arccos((way @ axis) / np.linalg.norm(way, axis=-1))), distance


def agrees(points, contact):
    found = np.zeros(points.shape[:-1], bool)
    for path, mirrored in (("direct", False), ("bounce", True)):
        degrees, distance = angle(points, contact, mirrored)
        if contact["path"] in (path, "either"):
            found |= np.abs(degrees - contact["bearing"]) <= contact["half_width"]
    low, high = contact.get("range", (0, np.inf))
    return found & (distance >= low) & (distance <= high)


def test_regions_over_a_level_floor(shrouds, tmp_path):
    text = SCENE
    for contact in CONTACTS:
        text += "[[contact]]\n"
        text += "".join(f"{name} = {json.dumps(value)}\n" for name, value in contact.items())
    (tmp_path / "scene.toml").write_text(text)
    shrouds("contain", tmp_path / "scene.toml", "--output", tmp_path / "out", "--preset", "fast")
    region, before = None, 0
    for number, contact in enumerate(CONTACTS, 1):
        image = nibabel.load(tmp_path / "out" / f"region-{number:03}.nii.gz")
        found = np.asarray(image.dataobj) != 0
        index = np.moveaxis(np.indices(found.shape), 0, -1)
        points = index @ image.affine[:3, :3].T + image.affine[:3, 3]
        assert np.allclose(np.abs(np.diag(image.affine)[:3]), SPACING)
        water = points[..., 2] >= -FLOOR
        if region is None:
            region = water
        else:
            reach = SPEED * (contact["time"] - before)
            region = water & (distance_transform_edt(~region, sampling=SPACING) <= reach)
        region = region & agrees(points, contact)
        before = contact["time"]
        assert 0 < region.sum() < water.sum()
        assert np.array_equal(found, region), (number, (found ^ region).sum(), region.sum())
