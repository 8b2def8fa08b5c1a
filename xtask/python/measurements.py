"""Makes the tables of docs/measurements.md.

`cargo xtask measurements` builds what this needs and calls it. The example `measurements` of the
library measures shrouds of bodies whose area and volume are known; the peers measure the same volumes
here.
"""

import argparse
import csv
import datetime
import io
import re
import subprocess
from functools import partial
from pathlib import Path

import numpy as np
import SimpleITK
from scipy.optimize import minimize
from skimage.measure import marching_cubes, mesh_surface_area
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkMassProperties, vtkSurfaceNets3D

try:
    from radiomics.shape import RadiomicsShape
except ImportError:
    RadiomicsShape = None

# A little more than is promised, 95 %: other bodies differ from those of the fit.
SHARE = 0.96
TARGETS = {5: (1, 1.5), 10: (0.3, 0.4), 20: (0.1, 0.15), 50: (0.05, 0.05)}


def main():
    parser = argparse.ArgumentParser()
    for name in ("tool", "folder", "document"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="few bodies, print only")
    parser.add_argument(
        "--again", action="store_true", help="from the measurements of the last time"
    )
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    few, again = options.quick, options.again
    text = options.document.read_text()
    for name, lines in tables(
        partial(measured, options.tool, options.folder, again), options.folder, few
    ):
        print(f"\n{name}\n\n{lines}", flush=True)
        mark = re.compile(
            rf"(<!-- measurements {name} -->\n).*?(\n<!-- /measurements {name} -->)", re.DOTALL
        )
        text, count = mark.subn(lambda m, lines=lines: f"{m[1]}\n{lines}\n{m[2]}", text)
        if count != 1:
            raise SystemExit(f"{options.document} has no place for the table {name}")
    if not few:
        options.document.write_text(text)


def tables(measured, folder, few):
    rows = measured("accuracy", 2 if few else 10)
    yield "accuracy", accuracy(rows)
    yield "ways", ways(rows)
    yield "curvature", curvature(rows)
    yield "edges", edges(measured("edges"))
    calibration = measured("calibration", 60 if few else 300)
    laws = {what: fitted(calibration, what) for what in ("volume", "area")}
    yield "laws", law_table(laws, calibration)
    yield "coverage", coverage(laws, measured("judged", 40 if few else 200))
    yield "peers", peers(measured("peers", folder), folder)


def measured(tool, folder, again, what, *arguments):
    """The lines of the example, numbers as such; they stay in the folder."""
    path = folder / f"{what}.csv"
    if not (again and path.exists()):
        command = [tool, what, *map(str, arguments)]
        path.write_bytes(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    out = path.read_text()
    return [
        {name: number(value) for name, value in row.items()}
        for row in csv.DictReader(io.StringIO(out))
    ]


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def table(head, lines):
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *lines]
    day = datetime.date.today().isoformat()
    return f"*{day}*\n\n" + "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def errors(rows, measure, what):
    """In percent."""
    found = np.array([row[measure] for row in rows])
    return 100 * (found / np.array([row[f"true_{what}"] for row in rows]) - 1)


def chosen(rows, **wanted):
    return [row for row in rows if all(row[name] == value for name, value in wanted.items())]


def groups(rows, *names):
    """Rows alike in some columns, in the order of the first of each."""
    keys = dict.fromkeys(tuple(row[name] for name in names) for row in rows)
    return {key: chosen(rows, **dict(zip(names, key))) for key in keys}


def accuracy(rows):
    """The best way against its targets: mean and largest error over the positions."""
    lines = []
    for (spacing, radius, body), group in groups(
        chosen(rows, preset="Exact", mesh="Primal"), "spacing", "radius", "body"
    ).items():
        line = [body, f"{radius:.0f}", f"1×1×{spacing:.0f}"]
        for what, target in zip(("area", "volume"), TARGETS[radius]):
            found = errors(group, f"smooth_{what}", what)
            largest, target = np.abs(found).max(), target * spacing
            met = "" if largest <= target else " ✗"
            line += [f"{found.mean():+.3f}", f"{largest:.3f}{met}", f"{target:g}"]
        counted = errors(group, "voxel_volume", "volume")
        lines.append([*line, f"{np.abs(counted).max():.3f}"])
    head = ["body", "radius", "spacing", "area: mean", "largest", "target"]
    return table([*head, "volume: mean", "largest", "target", "voxel count: largest"], lines)


def ways(rows):
    """Smooth and plain estimate, presets and meshes: the largest error over bodies and positions."""
    lines = []
    for (preset, mesh), group in groups(chosen(rows, spacing=1.0), "preset", "mesh").items():
        for kind, prefix in (("smooth", "smooth_"), ("triangles", "")):
            line = [preset.lower(), mesh.lower(), kind]
            for what in ("area", "volume"):
                for radius in TARGETS:
                    found = errors(chosen(group, radius=radius), prefix + what, what)
                    line.append(f"{np.abs(found).max():.2f}")
            lines.append(line)
    head = [f"{what} {radius}" for what in ("area", "volume") for radius in TARGETS]
    return table(["preset", "mesh", "estimate", *head], lines)


def curvature(rows):
    lines = []
    for (preset, mesh, body, radius), group in groups(
        chosen(rows, spacing=1.0), "preset", "mesh", "body", "radius"
    ).items():
        if preset != "Exact" and radius != 20 or radius == 50:
            continue
        line = [body, f"{radius:.0f}", preset.lower(), mesh.lower()]
        for name in (
            "curvature_median",
            "curvature_95",
            "mesh_curvature_median",
            "mesh_curvature_95",
        ):
            known = [row[name] for row in group if row[name] != ""]
            line.append(f"{100 * max(known):.1f}" if known else "")
        for sign in ("positive", "negative"):
            known = [row for row in group if row[f"true_{sign}"] not in ("", 0)]
            line.append(f"{np.abs(errors(known, sign, sign)).max():.2f}" if known else "")
        lines.append(line)
    head = ["body", "radius", "preset", "mesh", "network: median", "95 %", "mesh: median", "95 %"]
    return table([*head, "positive area", "negative area"], lines)


def edges(rows):
    lines = []
    for (body, preset), group in groups(rows, "body", "preset").items():
        line = [body, preset.lower()]
        for name, what in (
            ("area", "area"),
            ("smooth_area", "area"),
            ("volume", "volume"),
            ("smooth_volume", "volume"),
        ):
            line.append(f"{errors(group, name, what).mean():+.2f}")
        lines.append(line)
    return table(
        ["body", "preset", "area: triangles", "smooth", "volume: triangles", "smooth"], lines
    )


def sizes(rows):
    """Logarithms of h/r, of the ratio of the spacings and of area/h²."""
    column = {
        name: np.array([row[name] for row in rows])
        for name in ("voxel", "ratio", "smooth_area", "smooth_volume")
    }
    size = column["voxel"] * column["smooth_area"] / (3 * column["smooth_volume"])
    places = column["smooth_area"] / column["voxel"] ** 2
    return np.log(size), np.log(column["ratio"]), np.log(places)


def fitted(rows, what):
    """Constant and two powers of the law that `SHARE` of the errors stay below, by quantile regression."""
    size, ratio, places = sizes(rows)
    found = np.log(np.abs(errors(rows, f"smooth_{what}", what)) / 100 + 1e-9) + places / 2

    def loss(law):
        rest = found - law @ [np.ones_like(size), size, ratio]
        return np.where(rest > 0, SHARE * rest, (SHARE - 1) * rest).mean()

    starts = ([0, 2, 1], [0, 1.5, 0.5], [-1, 2.5, 1], [-2, 2, 0])
    exact = {"maxiter": 4000, "xatol": 1e-5, "fatol": 1e-9}
    tried = [minimize(loss, start, method="Nelder-Mead", options=exact) for start in starts]
    law = min(tried, key=lambda one: one.fun).x
    return [float(np.exp(law[0])), float(law[1]), float(law[2])]


def law_table(laws, rows):
    size, _, _ = sizes(rows)
    reach = f"{np.exp(-size.max()):.1f} to {np.exp(-size.min()):.1f}"
    lines = [[what, *(f"{x:.3f}" for x in law), len(rows), reach] for what, law in laws.items()]
    return table(["measure", "c", "p", "s", "bodies", "r/h"], lines)


def coverage(laws, rows):
    """How often the error that the library states holds the truth of other bodies, and how wide it is."""
    lines = []
    groups_of = {"all": rows, **{body: group for (body,), group in groups(rows, "body").items()}}
    for body, group in groups_of.items():
        line = [body, len(group)]
        for what in ("volume", "area"):
            stated = np.array([row[f"{what}_error"] / row[f"smooth_{what}"] for row in group])
            size, ratio, places = sizes(group)
            factor, *powers = laws[what]
            fit = factor * np.exp(np.array([*powers, -0.5]) @ [size, ratio, places])
            if np.abs(stated / fit - 1).max() > 0.01 and body == "all":
                print(f"the constants of {what} in uncertainty.rs are not those of this fit")
            found = np.abs(errors(group, f"smooth_{what}", what)) / 100
            bounds = [
                row[f"{what}_low"] <= row[f"true_{what}"] <= row[f"{what}_high"] for row in group
            ]
            line += [
                f"{100 * (found <= stated).mean():.1f}",
                f"{np.median(stated / found):.1f}",
                f"{100 * np.mean(bounds):.0f}",
            ]
        lines.append(line)
    head = [
        "body",
        "count",
        "volume: held, %",
        "error / true error, median",
        "within the bounds, %",
    ]
    return table(
        [*head, "area: held, %", "error / true error, median", "within the bounds, %"], lines
    )


def peers(rows, folder):
    """Error of the area by others, on the very same volumes."""
    lines = []
    names = ["voxel faces", "scikit-image", "VTK flying edges", "VTK surface nets"]
    if RadiomicsShape:
        names.append("pyradiomics")
    for row in rows:
        spacing = np.array([1, 1, row["spacing"]])
        path = folder / f"{row['body']}-{row['radius']:.0f}-{row['spacing']:.0f}.npy"
        volume = np.load(path)
        found = {
            "shrouds": row["smooth_area"],
            "voxel faces": faces(volume, spacing),
            "scikit-image": skimage_area(volume, spacing),
            "VTK flying edges": vtk_area(volume, spacing, vtkFlyingEdges3D, 0.5),
            "VTK surface nets": vtk_area(volume, spacing, vtkSurfaceNets3D, 1),
        }
        if RadiomicsShape:
            found["pyradiomics"] = radiomics_area(volume, spacing)
        cells = [
            f"{100 * (found[name] / row['true_area'] - 1):+.2f}" for name in ["shrouds", *names]
        ]
        lines.append([row["body"], f"{row['radius']:.0f}", f"1×1×{row['spacing']:.0f}", *cells])
    return table(["body", "radius", "spacing", "shrouds", *names], lines)


def faces(volume, spacing):
    """Area of the faces between inside and outside voxels; axes are z, y, x."""
    padded = np.pad(volume.astype(np.int8), 1)
    areas = [spacing[0] * spacing[1], spacing[0] * spacing[2], spacing[1] * spacing[2]]
    return sum(area * np.abs(np.diff(padded, axis=axis)).sum() for axis, area in enumerate(areas))


def skimage_area(volume, spacing):
    vertices, triangles, _, _ = marching_cubes(
        volume.astype(float), 0.5, spacing=tuple(spacing[::-1])
    )
    return mesh_surface_area(vertices, triangles)


def vtk_area(volume, spacing, filter_of, value):
    image = vtkImageData()
    image.SetDimensions(*volume.shape[::-1])
    image.SetSpacing(*spacing)
    values = np.ascontiguousarray(volume, dtype=np.uint8).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(values))
    work = filter_of()
    work.SetInputData(image)
    work.SetValue(0, value)
    if filter_of is vtkSurfaceNets3D:
        work.SetOutputMeshTypeToTriangles()
    mass = vtkMassProperties()
    mass.SetInputConnection(work.GetOutputPort())
    return mass.GetSurfaceArea()


def radiomics_area(volume, spacing):
    mask = SimpleITK.GetImageFromArray(volume.astype(np.uint8))
    mask.SetSpacing(tuple(map(float, spacing)))
    return RadiomicsShape(mask, mask, label=1).getSurfaceAreaFeatureValue()


if __name__ == "__main__":
    main()
