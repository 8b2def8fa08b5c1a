"""The tables of bit planes, and of general coders of meshes at the same error."""

import json
import subprocess

import trimesh
from compression_volumes import HALF, STATUES, VOLUMES, made
from markdown import table
from mesh_coders import bits_at, draco, meshopt

PLANES = (1, 2, 4, 8)
# The error of the paper's statue and half of it, and one that prints without steps.
COMPARED = ("bunny128", "figure")


def tables(options):
    """Bits and errors of the planes, and the general coders where ours has one, two and four planes."""
    meshes = [name for name in VOLUMES if name in ("bunny128", "figure")]
    makers = {name: VOLUMES[name] for name in [*meshes, "brain"]} | STATUES
    rows = {name: measured(options, name, path) for name, path in made(options, makers).items()}
    compared = [name for name in COMPARED if name in rows]
    return {
        "compression-geometry": planes(rows),
        "compression-planes-speed": speeds(rows),
        "compression-meshes": peers(options, {name: rows[name] for name in compared}),
    }


def measured(options, name, path):
    """What the example `geometry` says of the surface through the true crossings."""
    surface = options.folder / f"{name}.true.ply"
    if name == "brain":
        source = [path.with_suffix(".values.npy"), str(HALF)]
    else:
        source = ["--like", path.with_suffix(".like.npy"), path.with_suffix(".ply")]
    command = [options.geometry, "--true-surface", surface, *source]
    done = subprocess.run(command, capture_output=True, check=True)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return {
        "shrouds": {line["preset"]: line for line in lines if "preset" in line},
        "planes": {line["planes"]: line for line in lines if "planes" in line},
        "surface": surface,
    }


def planes(rows):
    lines = []
    for name, row in rows.items():
        by_preset = row["shrouds"]
        cells = [f"{by_preset['Default']['vertices']:,.0f}"]
        cells.append(" / ".join(decimals(by_preset[preset]["normal"]) for preset in by_preset))
        for count in PLANES:
            line = row["planes"][count]
            kilobits = line["total_per_100k_triangles"] / 1000
            errors = f"{decimals(line['normal'])} ({decimals(line['predicted'])})"
            cells.append(f"{kilobits:.3g}, {errors}")
        lines.append([name, *cells])
    bits = [f"{count} bit{'s' if count > 1 else ''}: K bits, error" for count in PLANES]
    return table(["", "vertices", "0 bits: error, `fast` / `default` / `exact`", *bits], lines)


def decimals(error):
    return f"{error:.4f}" if error < 0.02 else f"{error:.3f}"


def speeds(rows):
    lines = []
    for name, row in rows.items():
        cells = [f"{row['planes'][count]['decode_us']:.2f}" for count in PLANES]
        lines.append([name, f"{row['planes'][8]['encode_us']:.2f}", *cells])
    head = ["µs per vertex and plane", "coding 8", *(f"decoding {count}" for count in PLANES)]
    return table(head, lines)


def peers(options, rows):
    lines = []
    for name, row in rows.items():
        mesh = trimesh.load(row["surface"], process=False)
        arrays = (mesh.vertices.view(float), mesh.faces.view(int), mesh.vertex_normals.view(float))
        curves = [coder(*arrays) for coder in (draco, meshopt)]
        for count in (1, 2, 4):
            line = row["planes"][count]
            ours = line["total_per_100k_triangles"] / 50_000
            cells = [name, f"{decimals(line['normal'])} ({count} bit{'s' if count > 1 else ''})"]
            cells.append(f"{ours:.3f}")
            for curve in curves:
                bits = bits_at(curve, line["normal"])
                cells += [f"{bits:.2f}", f"{bits / ours:.1f}"] if bits else ["", ""]
            lines.append(cells)
    head = ["", "error, voxels", "Shrouds, bits per vertex", "Draco", "times ours"]
    return table([*head, "meshoptimizer, then zstd", "times ours"], lines)
