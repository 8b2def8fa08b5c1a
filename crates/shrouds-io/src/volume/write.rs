//! Volumes to files: 0 outside, 1 inside, `uint8`.

use std::io::{self, Write};
use std::path::Path;

use shrouds::Occupancy;

use crate::error::Error;
use crate::volume::{Frame, VolumeFormat, npy, nrrd_write, volume_format};

/// Writes a volume in the format that the extension of `path` names: `uint8`, 1 inside, 0 outside.
///
/// The affine of the grid and `frame`, which says what it means, go with it as far as the format
/// has a place for them:
///
/// | format | what is kept |
/// |---|---|
/// | `.npy` | nothing: indexed `[z, y, x]`, C order |
/// | `.nrrd` | the affine, the unit and the names of spaces that NRRD knows (`RAS`, `LPS`, `LAS`, …) |
///
/// # Errors
/// [`Error::Extension`] when no volume is written in that format; those of
/// [`write_atomically`](crate::write_atomically).
pub fn write_volume(
    path: impl AsRef<Path>,
    volume: &Occupancy,
    frame: &Frame,
) -> Result<(), Error> {
    let path = path.as_ref();
    match volume_format(path) {
        Ok(VolumeFormat::Npy) => npy::write_npy(path, volume),
        Ok(VolumeFormat::Nrrd) => nrrd_write::write(path, volume, frame),
        _ => {
            let known = "volumes are written as .npy and .nrrd";
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
