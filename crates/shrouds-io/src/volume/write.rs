//! Volumes to files: 0 outside, 1 inside, `uint8`.

use std::io::{self, Write};
use std::path::Path;

use shrouds::Occupancy;

use crate::error::Error;
use crate::volume::{Frame, VolumeFormat, nifti_write, npy, nrrd_write, volume_format, vti_write};

/// Writes a volume in the format that the extension of `path` names: `uint8`, 1 inside, 0 outside.
///
/// The affine of the grid and `frame`, which says what it means, go with it as far as the format
/// has a place for them:
///
/// | format | what is kept |
/// |---|---|
/// | `.npy` | nothing: indexed `[z, y, x]`, C order |
/// | `.nrrd` | the affine, the unit and the names of spaces that NRRD knows (`RAS`, `LPS`, `LAS`, …) |
/// | `.nii`, `.nii.gz` | the affine, turned to RAS if it is LPS or LAS, in single precision; the units m, mm, um (cm and nm as those); of `index` frames that begin at 0, the spacings; other names are lost |
/// | `.vti` | the affine |
///
/// # Errors
/// [`Error::Extension`] when no volume is written in that format, [`Error::UnwritableVolume`] when
/// the format cannot hold the lattice: more than 32 767 points along an axis in NIfTI-1, axes that
/// are not at right angles in VTI; those of
/// [`write_atomically`](crate::write_atomically).
pub fn write_volume(
    path: impl AsRef<Path>,
    volume: &Occupancy,
    frame: &Frame,
) -> Result<(), Error> {
    let path = path.as_ref();
    match written_format(path)? {
        VolumeFormat::Nrrd => nrrd_write::write(path, volume, frame),
        VolumeFormat::Nifti => nifti_write::write(path, volume, frame, false),
        VolumeFormat::NiftiGz => nifti_write::write(path, volume, frame, true),
        VolumeFormat::Vti => vti_write::write(path, volume),
        _ => npy::write_npy(path, volume),
    }
}

/// The format that the extension of `path` names, if volumes are written in it.
///
/// # Errors
/// [`Error::Extension`] when they are not.
pub fn written_format(path: impl AsRef<Path>) -> Result<VolumeFormat, Error> {
    use VolumeFormat::{Nifti, NiftiGz, Npy, Nrrd, Vti};
    let path = path.as_ref();
    match volume_format(path) {
        Ok(format @ (Npy | Nrrd | Nifti | NiftiGz | Vti)) => Ok(format),
        _ => {
            let known = "volumes are written as .nii, .nii.gz, .nrrd, .npy and .vti";
            Err(Error::Extension { path: path.into(), kind: "volume", known })
        }
    }
}

/// One byte per lattice point, x fastest.
pub(super) fn write_bytes(volume: &Occupancy, writer: &mut dyn Write) -> io::Result<()> {
    let [nx, ny, nz] = volume.grid().dims();
    let mut row = vec![0; nx];
    for (j, k) in (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))) {
        for (bytes, word) in row.chunks_mut(64).zip(volume.row(j, k)) {
            for (i, byte) in bytes.iter_mut().enumerate() {
                *byte = (word >> i & 1) as u8;
            }
        }
        writer.write_all(&row)?;
    }
    Ok(())
}
