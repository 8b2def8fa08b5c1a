"""Turns the npm package `bunny` into a mesh file: python bunny.py BUNNY.tgz OUT.ply"""

import json
import re
import sys
import tarfile

import numpy as np


def main(package, out):
    with tarfile.open(package) as archive:
        text = archive.extractfile("package/index.js").read().decode()
    positions, cells = (
        np.array(json.loads(re.search(rf"exports\.{name}=(\[\[.*?\]\])", text)[1]))
        for name in ("positions", "cells")
    )
    faces = np.empty(len(cells), [("count", "u1"), ("vertices", "<i4", 3)])
    faces["count"], faces["vertices"] = 3, cells
    header = f"""ply
format binary_little_endian 1.0
element vertex {len(positions)}
property float x
property float y
property float z
element face {len(cells)}
property list uchar int vertex_indices
end_header
"""
    with open(out, "wb") as file:
        file.write(header.encode() + positions.astype("<f4").tobytes() + faces.tobytes())


if __name__ == "__main__":
    main(*sys.argv[1:])
