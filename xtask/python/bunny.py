"""Turns the npm package `bunny` into a mesh file: python bunny.py BUNNY.tgz OUT.ply"""

import json
import re
import sys
import tarfile

import numpy as np
from meshes import write_ply


def main(package, out):
    with tarfile.open(package) as archive:
        text = archive.extractfile("package/index.js").read().decode()
    positions, cells = (
        np.array(json.loads(re.search(rf"exports\.{name}=(\[\[.*?\]\])", text)[1]))
        for name in ("positions", "cells")
    )
    write_ply(out, positions, cells)


if __name__ == "__main__":
    main(*sys.argv[1:])
