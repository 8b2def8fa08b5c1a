//! Volumes to files: 0 outside, 1 inside, `uint8`; or labels.

use std::io::{self, Write};
use std::path::Path;

use shrouds::{Grid, Occupancy};

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
    let write = |writer: &mut dyn Write| write_bytes(volume, writer);
    let data = Data { grid: volume.grid(), element: Element::ALL[0], write: &write };
    match written_format(path)? {
        VolumeFormat::Vti => vti_write::write(path, volume),
        format => data.write_as(format, path, frame),
    }
}

/// Writes labels, one per lattice point, x fastest, in the format that the extension of `path` names:
/// `.npy`, `.nrrd`, `.nii` or `.nii.gz`. The type is the first of `uint8`, `uint16`, `int32` and `int64`
/// that holds them all; for the rest see [`write_volume`].
///
/// # Errors
/// As [`write_volume`].
pub fn write_labels(
    path: impl AsRef<Path>,
    grid: &Grid,
    labels: impl Iterator<Item = i64> + Clone,
    frame: &Frame,
) -> Result<(), Error> {
    let path = path.as_ref();
    let format = written_label_format(path)?;
    let range = labels.clone().fold([0, 0], |[low, high], label| [label.min(low), label.max(high)]);
    let element = Element::that_holds(range);
    let write = |writer: &mut dyn Write| {
        let mut labels = labels.clone();
        labels.try_for_each(|label| writer.write_all(&label.to_le_bytes()[..element.width]))
    };
    Data { grid, element, write: &write }.write_as(format, path, frame)
}

/// The format that the extension of `path` names, if labels are written in it.
///
/// # Errors
/// [`Error::Extension`] when they are not.
pub fn written_label_format(path: impl AsRef<Path>) -> Result<VolumeFormat, Error> {
    let path = path.as_ref();
    match written_format(path) {
        Ok(format) if format != VolumeFormat::Vti => Ok(format),
        _ => {
            let known = "labels are written as .nii, .nii.gz, .nrrd and .npy";
            Err(Error::Extension { path: path.into(), kind: "volume", known })
        }
    }
}

/// A type of values as the formats call it, the lowest byte first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub(super) npy: &'static str,
    pub(super) nrrd: &'static str,
    pub(super) nifti: i16,
    /// Bytes of a value.
    pub(super) width: usize,
    /// The values it holds.
    range: [i64; 2],
}

impl Element {
    const ALL: [Self; 4] = [
        Self { npy: "|u1", nrrd: "unsigned char", nifti: 2, width: 1, range: [0, 255] },
        Self { npy: "<u2", nrrd: "unsigned short", nifti: 512, width: 2, range: [0, 65_535] },
        Self {
            npy: "<i4",
            nrrd: "int",
            nifti: 8,
            width: 4,
            range: [i32::MIN as i64, i32::MAX as i64],
        },
        Self { npy: "<i8", nrrd: "long long", nifti: 1024, width: 8, range: [i64::MIN, i64::MAX] },
    ];

    fn that_holds([low, high]: [i64; 2]) -> Self {
        let holds = |element: &&Self| element.range[0] <= low && high <= element.range[1];
        *Self::ALL.iter().find(holds).unwrap_or(&Self::ALL[3])
    }
}

/// Values on a lattice, on their way into a file.
pub(super) struct Data<'a> {
    pub(super) grid: &'a Grid,
    pub(super) element: Element,
    /// Writes the values, x fastest.
    pub(super) write: &'a dyn Fn(&mut dyn Write) -> io::Result<()>,
}

impl Data<'_> {
    fn write_as(&self, format: VolumeFormat, path: &Path, frame: &Frame) -> Result<(), Error> {
        match format {
            VolumeFormat::Nrrd => nrrd_write::write(path, self, frame),
            VolumeFormat::Nifti => nifti_write::write(path, self, frame, false),
            VolumeFormat::NiftiGz => nifti_write::write(path, self, frame, true),
            _ => npy::write(path, self),
        }
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
