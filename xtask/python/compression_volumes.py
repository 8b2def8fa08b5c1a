"""The volumes that `compression.py` packs: statues fitted to a lattice, brains and a skull.

All come from the packages of `cargo xtask data --all`.
"""

import io
import subprocess
import tarfile

import nibabel
import numpy as np
from meshes import inside, read_off, write_ply

MAPS = "nilearn/nilearn/datasets/data/mni_icbm152_{}_tal_nlin_sym_09a_converted.nii.gz"
# Hounsfield units above which tissue is bone, as InVesalius has it.
BONE = 226
# Between the bytes of maps of tissue that mean one half or less, and those that mean more.
HALF = 127.5


def from_package(options, package, ending):
    """The bytes of a file in a package that `cargo xtask data --all` fetched."""
    for archive in (options.data / "packages").glob(f"{package}_*.deb"):
        found = inside(str(archive), b"", ending)
        if found is not None:
            return found
    raise FileNotFoundError(f"{ending} of the package {package}")


def fitted(options, path, mesh, dims, stretched):
    """The voxels inside a mesh that stands upright (y to z) and fills a lattice but for two voxels."""
    points, triangles = read_off(from_package(options, "libcgal-demo", f"/meshes/{mesh}"))
    points = points[:, [0, 2, 1]]
    low, high, dims = points.min(0), points.max(0), np.array(dims)
    scale = (dims - 5) / (high - low)
    scale = scale if stretched else scale.min()
    # Off the lattice points by something without a meaning.
    points = (points - (low + high) / 2) * scale + (dims - 1) / 2 + [0.01317, 0.02711, 0.00733]
    ply, like = path.with_suffix(".ply"), path.with_suffix(".like.npy")
    write_ply(ply, points, triangles)
    np.save(like, np.zeros(dims[::-1], np.uint8))
    command = [options.program, "voxelize", ply, "--like", like, "-o", path, "--quiet"]
    subprocess.run(command, check=True)


def brain(options, path, parts):
    """Where maps of tissue say more than one half together, and beside it what they say."""
    total = sum(
        np.asarray(nibabel.load(options.data / MAPS.format(part)).dataobj, float) for part in parts
    )
    total = np.ascontiguousarray(total.T)
    np.save(path.with_suffix(".values.npy"), total)
    np.save(path, (total > HALF).astype(np.uint8))


def skull(options, path):
    """Bone in the computed tomography of a head."""
    project = from_package(options, "invesalius-examples", "/Cranium.inv3")
    with tarfile.open(fileobj=io.BytesIO(project)) as archive:
        name = next(name for name in archive.getnames() if name.endswith("matrix.dat"))
        values = np.frombuffer(archive.extractfile(name).read(), "<i2").reshape(108, 256, 256)
    np.save(path, (values > BONE).astype(np.uint8))


FIGURE = (100, 300, 100)

VOLUMES = {
    "bunny128": lambda o, path: fitted(o, path, "bunny00.off", (128, 128, 128), False),
    "bunny256": lambda o, path: fitted(o, path, "bunny00.off", (256, 256, 256), False),
    "figure": lambda o, path: fitted(o, path, "armadillo.off", FIGURE, True),
    "brain": lambda o, path: brain(o, path, ["gm", "wm"]),
    "grey matter": lambda o, path: brain(o, path, ["gm"]),
    "skull": skull,
}

# More figures like the paper's statue: what one of them shows need not hold for another.
STATUES = {
    "bust": lambda o, path: fitted(o, path, "mannequin-devil.off", FIGURE, True),
    "man": lambda o, path: fitted(o, path, "man.off", FIGURE, True),
    "lion's head": lambda o, path: fitted(o, path, "lion-head.off", FIGURE, True),
}


def made(options, makers):
    """The files of those volumes whose packages are there."""
    paths = {}
    for name, make in makers.items():
        path = options.folder / f"{name}.npy"
        try:
            make(options, path)
            paths[name] = path
        except FileNotFoundError as missing:
            print(f"without {name}: {missing}")
    return paths
