"""Measures how small volumes get and rewrites the tables of compression in docs/benchmarks.md.

`cargo xtask compression` builds what this needs and calls it; the volumes come from
`cargo xtask data --all`. Bytes are those of the payload, without header and check sums, for ours, and of
the whole output for the others. JBIG1 is there where `pbmtojbg` (Debian: jbigkit-bin) is.
"""

import argparse
import datetime
import gzip
import json
import lzma
import re
import shutil
import subprocess
from pathlib import Path

import compression_geometry
import compresso
import crackle
import nibabel
import numpy as np
import zstandard
from compression_volumes import VOLUMES, made
from markdown import table

AAL = "mricron-data/usr/share/mricron/templates/aal.nii.gz"


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "topology", "geometry", "data", "folder", "document"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    volumes = made(options, VOLUMES)
    rows = {name: measured(options, path) for name, path in volumes.items()}
    tables = {"compression-size": sizes(rows), "compression-speed": speeds(rows)}
    labels = options.data / AAL
    if labels.exists():
        tables["compression-labels"] = label_table(options, labels)
    tables |= compression_geometry.tables(options)
    stamp = f"*{datetime.date.today()}, CPU of one thread.*"
    text = options.document.read_text()
    for name, table in tables.items():
        print(f"{name}\n\n{table}\n")
        mark = re.compile(rf"(<!-- bench {name} -->\n).*?(\n<!-- /bench {name} -->)", re.S)
        assert mark.search(text), f"{options.document} has no place for {name}"
        text = mark.sub(lambda found: f"{found[1]}\n{stamp}\n\n{table}\n{found[2]}", text)
    options.document.write_text(text)


def measured(options, path):
    """What every coder makes of a volume."""
    line = json.loads(subprocess.run([options.topology, path], capture_output=True, check=True).stdout)
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
    done = subprocess.run([options.topology, "--each", path], capture_output=True, check=True)
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
