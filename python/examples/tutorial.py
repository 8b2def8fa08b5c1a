"""From a segmentation to a picture and to numbers.

    python tutorial.py [FOLDER]

It needs ``pip install nibabel pyvista``. Everything is written to FOLDER, or to the folder it is run in.
"""

# %% A segmentation
# With data of your own this step is the path of a file. Here it is a kidney of sorts (label 1) with a tumour (label 2)
# in voxels of 0.8 × 0.8 × 2 mm, saved as other software would: with an affine that places it in the patient.

import sys
from pathlib import Path

import nibabel
import numpy as np

import shrouds

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
spacing = np.array([0.8, 0.8, 2.0])
x, y, z = np.moveaxis(np.indices((100, 75, 60)), 0, -1).dot(np.diag(spacing)).transpose(3, 0, 1, 2)
x, y, z = x - 45, y - 30, z - 59
kidney = ((x + 0.005 * z**2) / 21) ** 2 + (y / 19) ** 2 + (z / 50) ** 2 < 1
tumour = (x - 7) ** 2 + (y + 3) ** 2 + (z - 14) ** 2 < 10**2
labels = np.where(tumour, 2, np.where(kidney, 1, 0)).astype(np.uint8)
affine = np.diag([*spacing, 1.0])
affine[:3, 3] = (-45, -30, -59)
image = nibabel.Nifti1Image(labels, affine)
image.header.set_xyzt_units("mm")
nibabel.save(image, folder / "labels.nii.gz")

# %% Its surface
# `read_volume` keeps the place of the voxels in the patient, and `shroud` puts the mesh there. `label` says which
# voxels are inside: the organ is both labels. An array of nibabel would do as well:
# `shrouds.shroud(np.asarray(image.dataobj), affine=image.affine, axes="xyz", label=(1, 2))`.

volume = shrouds.read_volume(folder / "labels.nii.gz")
print(f"{volume.values.shape} voxels, {volume.frame}, lengths in {volume.unit}")
surfaces = {
    "kidney": shrouds.shroud(volume, label=(1, 2)),
    "tumour": shrouds.shroud(volume, label=2),
}
for name, made in surfaces.items():
    print(name, made)

# %% What is certain
# No voxel centre is on the wrong side, and the mesh is a closed manifold: the report says what was found.

for name, made in surfaces.items():
    checks = made.report["checks"]
    print(f"{name}: {checks['wrong_side']} voxels on the wrong side, problems: {checks['problems']}")
    assert checks["ok"]

# %% A picture
# `to_pyvista` has the normals, so that the surface is shaded as smooth as it is.

import pyvista

plotter = pyvista.Plotter(off_screen=True, window_size=(900, 900))
plotter.add_mesh(surfaces["kidney"].to_pyvista(), color="#d98a7e", opacity=0.45, smooth_shading=True)
plotter.add_mesh(surfaces["tumour"].to_pyvista(), color="#e8c15a", smooth_shading=True)
plotter.add_axes()
plotter.camera_position = [(90, -200, 70), (-4, 0, 0), (0, 0, 1)]
plotter.screenshot(folder / "tutorial.png")

# %% Numbers
# Volume and area come with their errors. The preset `exact` goes all the way to the optimum.

measured = shrouds.measure(shrouds.shroud(volume, label=2, preset="exact"))
print(f"tumour: {measured['volume'] / 1000:.2f} ± {measured['volume_error'] / 1000:.2f} ml,", end=" ")
print(f"{measured['area'] / 100:.1f} cm², largest thickness {measured['thickness_maximum']:.1f} mm")
print(f"a ball of radius 10 mm: {4 / 3 * np.pi * 10**3 / 1000:.2f} ml, {4 * np.pi * 10**2 / 100:.1f} cm²")

# %% Files
# Any format that other programs read; `pack` takes the voxels themselves into a few hundred bytes.

surfaces["kidney"].save(folder / "kidney.ply")
packed = shrouds.pack(volume, label=1)
print(f"{len(packed)} bytes hold the {int((volume.values == 1).sum())} voxels of the kidney")
assert np.array_equal(shrouds.unpack(packed).values, volume.values == 1)
