"""Measures how small volumes get and rewrites the tables of compression in docs/benchmarks.md.

`cargo xtask compression` builds what this needs and calls it; the volumes come from
`cargo xtask data --all`. Bytes are those of the payload, without header and check sums, for ours, and of
the whole output for the others. JBIG1 is there where `pbmtojbg` (Debian: jbigkit-bin) is.
"""

import argparse
import datetime
import gzip
import io
import json
import lzma
import re
import shutil
import subprocess
import tarfile
from pathlib import Path

import compresso
import crackle
import nibabel
import numpy as np
import zstandard
from unpack import members

MAPS = "nilearn/nilearn/datasets/data/mni_icbm152_{}_tal_nlin_sym_09a_converted.nii.gz"
AAL = "mricron-data/usr/share/mricron/templates/aal.nii.gz"
# Hounsfield units above which tissue is bone, as InVesalius has it.
BONE = 226


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "tool", "data", "folder", "document"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    volumes = {}
    for name, make in VOLUMES.items():
        path = options.folder / f"{name}.npy"
        try:
            make(options, path)
            volumes[name] = path
        except FileNotFoundError as missing:
            print(f"without {name}: {missing}")
    rows = {name: measured(options, path) for name, path in volumes.items()}
    tables = {"compression-size": sizes(rows), "compression-speed": speeds(rows)}
    labels = options.data / AAL
    if labels.exists():
        tables["compression-labels"] = label_table(options, labels)
    stamp = f"*{datetime.date.today()}, CPU of one thread.*"
    text = options.document.read_text()
    for name, table in tables.items():
        print(f"{name}\n\n{table}\n")
        mark = re.compile(rf"(<!-- bench {name} -->\n).*?(\n<!-- /bench {name} -->)", re.S)
        assert mark.search(text), f"{options.document} has no place for {name}"
        text = mark.sub(lambda found: f"{found[1]}\n{stamp}\n\n{table}\n{found[2]}", text)
    options.document.write_text(text)


def from_package(options, package, ending):
    """The bytes of a file in a package that `cargo xtask data --all` fetched."""
    for archive in (options.data / "packages").glob(f"{package}_*.deb"):
        found = inside(str(archive), b"", ending)
        if found is not None:
            return found
    raise FileNotFoundError(f"{ending} of the package {package}")


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


def fitted(options, path, mesh, dims, stretched):
    """The voxels inside a mesh that stands upright (y to z) and fills a lattice but for two voxels."""
    points, triangles = read_off(from_package(options, "libcgal-demo", f"/meshes/{mesh}"))
    points = points[:, [0, 2, 1]]
    low, high, dims = points.min(0), points.max(0), np.array(dims)
    scale = (dims - 5) / (high - low)
    scale = scale if stretched else scale.min()
    # Off the lattice points by something without a meaning.
    points = (points - (low + high) / 2) * scale + (dims - 1) / 2 + [0.01317, 0.02711, 0.00733]
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    ply, like = path.with_suffix(".ply"), path.with_suffix(".like.npy")
    ply.write_bytes(header.encode() + points.astype("<f8").tobytes() + faces.tobytes())
    np.save(like, np.zeros(dims[::-1], np.uint8))
    command = [options.program, "voxelize", ply, "--like", like, "-o", path, "--quiet"]
    subprocess.run(command, check=True)


def brain(options, path, parts):
    """Where maps of tissue say more than one half together."""
    total = sum(
        np.asarray(nibabel.load(options.data / MAPS.format(part)).dataobj, float) for part in parts
    )
    np.save(path, np.ascontiguousarray((total > 127.5).T.astype(np.uint8)))


def skull(options, path):
    """Bone in the computed tomography of a head."""
    project = from_package(options, "invesalius-examples", "/Cranium.inv3")
    with tarfile.open(fileobj=io.BytesIO(project)) as archive:
        name = next(name for name in archive.getnames() if name.endswith("matrix.dat"))
        values = np.frombuffer(archive.extractfile(name).read(), "<i2").reshape(108, 256, 256)
    np.save(path, (values > BONE).astype(np.uint8))


VOLUMES = {
    "bunny128": lambda o, path: fitted(o, path, "bunny00.off", (128, 128, 128), False),
    "bunny256": lambda o, path: fitted(o, path, "bunny00.off", (256, 256, 256), False),
    "figure": lambda o, path: fitted(o, path, "armadillo.off", (100, 300, 100), True),
    "brain": lambda o, path: brain(o, path, ["gm", "wm"]),
    "grey matter": lambda o, path: brain(o, path, ["gm"]),
    "skull": skull,
}


def measured(options, path):
    """What every coder makes of a volume."""
    line = json.loads(subprocess.run([options.tool, path], capture_output=True, check=True).stdout)
    volume = np.load(path)
    bits = np.packbits(volume, axis=2)
    line["gzip -9"] = len(gzip.compress(bits.tobytes(), 9))
    line["zstd -19"] = len(zstandard.ZstdCompressor(level=19).compress(bits.tobytes()))
    line["xz -9"] = len(lzma.compress(bits.tobytes(), preset=9))
    by_xyz = np.asfortranarray(volume.T)
    line["crackle, then xz"] = len(lzma.compress(crackle.compress(by_xyz, markov_model_order=5)))
    line["compresso, then xz"] = len(lzma.compress(compresso.compress(by_xyz)))
    if shutil.which("pbmtojbg"):
        depth, height, width = volume.shape
        image = b"P4\n%d %d\n" % (width, height * depth) + bits.tobytes()
        done = subprocess.run(["pbmtojbg", "-q"], input=image, capture_output=True, check=True)
        line["JBIG1"] = len(done.stdout)
    line["16 neighbours"] = line["sixteen"]
    for profile in ("fast", "dense"):
        line[f"`{profile}`"] = line[profile]["topology"]
    return line


CODERS = [
    "gzip -9", "zstd -19", "xz -9", "compresso, then xz", "crackle, then xz", "JBIG1",
    "16 neighbours", "`fast`", "`dense`",
]  # fmt: skip


def table(head, rows):
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def sizes(rows):
    """Bits per triangle, of which there are two for each vertex."""
    lines = [["vertices", *(f"{row['vertices']:,}" for row in rows.values())]]
    for coder in CODERS:
        cells = [
            f"{row[coder] * 8 / (2 * row['vertices']):.3f}" if coder in row else ""
            for row in rows.values()
        ]
        lines.append([coder, *cells])
    ratios = (f"{row['`dense`'] / row['sixteen']:.2f}" for row in rows.values())
    lines.append(["`dense` / 16 neighbours", *ratios])
    lines.append(["`dense`, bytes of the file", *(f"{r['dense']['file']:,}" for r in rows.values())])
    return table(["bits per triangle", *rows], lines)


def speeds(rows):
    lines = []
    for name, row in rows.items():
        voxels = np.prod(row["dims"]) / 1e6
        fast = [f"{voxels / seconds:.0f}" for seconds in row["fast"]["seconds"]]
        dense = [f"{1e6 * seconds / row['vertices']:.2f}" for seconds in row["dense"]["seconds"]]
        lines.append([name, *fast, *dense])
    head = ["", "`fast`: pack, Mvoxel/s", "unpack", "`dense`: pack, µs per vertex", "unpack"]
    return table(head, lines)


def label_table(options, path):
    """All labels of an atlas one by one, and together as a map."""
    done = subprocess.run([options.tool, "--each", path], capture_output=True, check=True)
    each = [json.loads(line) for line in done.stdout.splitlines()]
    worst = max(line["dense"]["topology"] / line["sixteen"] for line in each)
    values = np.asarray(nibabel.load(path).dataobj).astype(np.uint8, order="F")
    rows = [["gzip -9 of the bytes", f"{len(gzip.compress(values.tobytes('F'), 9)):,}"]]
    rows.append(["xz -9 of the bytes", f"{len(lzma.compress(values.tobytes('F'), preset=9)):,}"])
    rows.append(["compresso, then xz", f"{len(lzma.compress(compresso.compress(values))):,}"])
    small = crackle.compress(values, markov_model_order=5)
    rows.append(["crackle, then xz", f"{len(lzma.compress(small)):,}"])
    total = sum(line["sixteen"] for line in each)
    rows.append([f"{len(each)} labels one by one, 16 neighbours", f"{total:,}"])
    total = sum(line["dense"]["topology"] for line in each)
    worst = f"; at worst {worst:.2f} of the 16 neighbours"
    rows.append([f"{len(each)} labels one by one, `dense`{worst}", f"{total:,}"])
    for profile in ("fast", "dense"):
        packed = options.folder / "labels.shroud"
        command = [options.program, "pack", path, "--labels", "all", "--profile", profile]
        done = subprocess.run([*command, "-o", packed, "--json", "--quiet"], capture_output=True, check=True)
        report = json.loads(done.stdout)
        rows.append([f"label map, `{profile}`", f"{report['topology_bytes']:,}"])
    return table(["AAL, 181 × 217 × 181", "bytes"], rows)


if __name__ == "__main__":
    main()
