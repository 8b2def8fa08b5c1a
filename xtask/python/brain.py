"""Makes a brain mask: python brain.py NILEARN.whl OUT.nii.gz

Inside is where grey and white matter together are more likely than not, in the ICBM 152 maps that
the nilearn package carries. Each map is divided by its own maximum; the mask has the maps' frame.
"""

import gzip
import sys
import zipfile

import nibabel
import numpy as np

FOLDER = "nilearn/datasets/data/mni_icbm152_{}_tal_nlin_sym_09a_converted.nii.gz"


def main(wheel, out):
    with zipfile.ZipFile(wheel) as archive:
        maps = [
            nibabel.Nifti1Image.from_bytes(gzip.decompress(archive.read(FOLDER.format(tissue))))
            for tissue in ("gm", "wm")
        ]
    grey, white = (np.asanyarray(image.dataobj).astype(np.float32) for image in maps)
    mask = grey / grey.max() + white / white.max() > 0.5
    nibabel.save(nibabel.Nifti1Image(mask.astype(np.uint8), maps[0].affine), out)


if __name__ == "__main__":
    main(*sys.argv[1:])
