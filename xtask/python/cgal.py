"""Turns a mesh of the package libcgal-demo into a file: python cgal.py LIBCGAL-DEMO.deb OUT/bust.ply"""

import sys
from pathlib import Path

from meshes import inside, read_off, write_ply

MESHES = {"bust.ply": "mannequin-devil.off", "femur.ply": "femur.off", "man.ply": "man.off"}


def main(package, out):
    data = inside(package, b"", f"/meshes/{MESHES[Path(out).name]}")
    write_ply(out, *read_off(data))


if __name__ == "__main__":
    main(*sys.argv[1:])
