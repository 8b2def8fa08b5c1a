//! Volume files: in a path, out values x fastest on a grid with its world frame.

mod decode;
mod nifti;
mod nifti_affine;
mod npy;
mod nrrd;
mod values;

use std::path::Path;

use shrouds::volume::Filler;
use shrouds::{Grid, Occupancy, Select};

use crate::error::Error;
use crate::stream::{Progress, Stream};
use crate::volume::decode::Elements;

pub use npy::write_npy;
pub use values::Values;

/// The values of a volume file on their lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// The lattice, with the index-to-world map of the file.
    pub grid: Grid,
    /// One value per lattice point, x fastest, then y, then z.
    pub values: Values,
    /// What the world coordinates mean.
    pub frame: Frame,
}

impl Volume {
    /// The volume of all lattice points whose value `select` chooses.
    ///
    /// # Errors
    /// [`shrouds::Error::NotANumber`] when a value is not a number.
    pub fn occupancy(&self, select: &Select) -> Result<Occupancy, shrouds::Error> {
        self.values.occupancy(self.grid.clone(), select)
    }
}

/// The meaning of world coordinates, as the file tells it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// `RAS` or `LPS` (the directions in which x, y, z grow in a patient), another name that the
    /// file gives, or `index` when the file places the lattice nowhere.
    pub name: String,
    /// Unit of length: `mm`, `m`, `um`, another name that the file gives, or `unknown`.
    pub unit: String,
    /// Which part of the file, or `options`, gave the index-to-world map.
    pub source: &'static str,
}

impl Frame {
    fn new(name: impl Into<String>, unit: impl Into<String>, source: &'static str) -> Self {
        Self { name: name.into(), unit: unit.into(), source }
    }
}

/// Order of the axes in files that do not name them (NPY).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axes {
    /// The array is indexed `[z, y, x]`.
    #[default]
    Zyx,
    /// The array is indexed `[x, y, z]`.
    Xyz,
}

/// How to read a volume file.
#[derive(Clone, Copy, Default)]
pub struct VolumeOptions<'a> {
    /// Order of the axes of an NPY array; other formats name their axes. Default `[z, y, x]`.
    pub axes: Axes,
    /// Distance between lattice points along x, y, z. Given, it replaces the whole frame of the
    /// file but its unit: first point at the origin, axes along those of the world. Default: what
    /// the file says; 1 for NPY, which says nothing.
    pub spacing: Option<[f64; 3]>,
    /// Called while the file is read, at least every few megabytes. Default: nothing.
    pub progress: Option<Progress<'a>>,
}

impl std::fmt::Debug for VolumeOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VolumeOptions")
            .field("axes", &self.axes)
            .field("spacing", &self.spacing)
            .field("progress", &self.progress.is_some())
            .finish()
    }
}

/// A volume file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum VolumeFormat {
    /// NumPy array, `.npy`.
    Npy,
    /// NIfTI-1 or NIfTI-2 in one file, `.nii`.
    Nifti,
    /// The same, compressed, `.nii.gz`.
    NiftiGz,
    /// NRRD with its header attached, `.nrrd`.
    Nrrd,
}

/// The volume format that the extension of `path` names, in upper or lower case.
///
/// # Errors
/// [`Error::Extension`] when it names none.
pub fn volume_format(path: impl AsRef<Path>) -> Result<VolumeFormat, Error> {
    let path = path.as_ref();
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let formats = [
        (".npy", VolumeFormat::Npy),
        (".nii", VolumeFormat::Nifti),
        (".nii.gz", VolumeFormat::NiftiGz),
        (".nrrd", VolumeFormat::Nrrd),
    ];
    let known = formats.iter().find(|(extension, _)| name.ends_with(extension));
    known.map(|(_, format)| *format).ok_or_else(|| {
        let known = match name.rsplit('.').next() {
            Some("hdr" | "img" | "gz") => {
                "NIfTI is read from one file, .nii or .nii.gz: convert the pair to that"
            }
            Some("nhdr") => "NRRD is read with its header attached: convert it to .nrrd",
            _ => "volumes are read from .npy, .nii, .nii.gz and .nrrd",
        };
        Error::Extension { path: path.into(), kind: "volume", known }
    })
}

/// Reads a volume: NPY, NIfTI or NRRD, by the extension of `path`.
///
/// # Errors
/// [`Error::Extension`] for an unknown extension, [`Error::Io`] when the file cannot be read,
/// [`Error::Content`] when it is of another kind than its extension says, [`Error::Header`],
/// [`Error::Truncated`] and [`Error::Gzip`] when it is damaged, [`Error::Unsupported`] when it is
/// sound but not a three-dimensional array of real numbers, [`Error::Lattice`] when its dimensions
/// or its frame make no lattice.
pub fn read_volume(path: impl AsRef<Path>, options: &VolumeOptions) -> Result<Volume, Error> {
    let Unread { grid, frame, elements, z_fastest, scaling } = open(path.as_ref(), options)?;
    let values = elements.values()?;
    let values = match scaling {
        Some((slope, shift)) => values.scaled(slope, shift),
        None => values,
    };
    let values = if z_fastest { values.with_axes_reversed(grid.dims()) } else { values };
    Ok(Volume { grid, values, frame })
}

/// Reads a volume as [`read_volume`] does, but keeps of every value only whether `select` chooses
/// it: an eighth of a byte.
///
/// # Errors
/// As for [`read_volume`]; [`Error::Values`] when a value is not a number.
pub fn read_occupancy(
    path: impl AsRef<Path>,
    options: &VolumeOptions,
    select: &Select,
) -> Result<(Occupancy, Frame), Error> {
    let path = path.as_ref();
    let Unread { grid, frame, elements, z_fastest, scaling } = open(path, options)?;
    let filler = if z_fastest { Filler::z_fastest } else { Filler::new };
    let mut filler = filler(grid, select.clone());
    elements.fill(&mut filler, scaling)?;
    let volume = filler.finish().map_err(|cause| Error::Values { path: path.into(), cause })?;
    Ok((volume, frame))
}

/// A volume file whose header has been read.
struct Unread<'a> {
    grid: Grid,
    frame: Frame,
    elements: Elements<'a>,
    /// Elements come z fastest, not x fastest.
    z_fastest: bool,
    /// Slope and shift from elements to values, if they change anything.
    scaling: Option<(f64, f64)>,
}

fn open<'a>(path: &'a Path, options: &VolumeOptions<'a>) -> Result<Unread<'a>, Error> {
    let format = volume_format(path)?;
    let stream = Stream::open(path, options.progress)?;
    match format {
        VolumeFormat::Npy => npy::open(stream, options),
        VolumeFormat::Nifti => nifti::open(stream, options),
        VolumeFormat::NiftiGz => nifti::open_compressed(stream, options),
        VolumeFormat::Nrrd => nrrd::open(stream, options),
    }
}

/// The lattice with the affine of the file, or with the spacing that the caller gave instead.
fn lattice(
    path: &Path,
    dims: [usize; 3],
    affine: [[f64; 4]; 3],
    frame: Frame,
    options: &VolumeOptions,
) -> Result<(Grid, Frame), Error> {
    let result = match options.spacing {
        Some(spacing) => Grid::new(dims, spacing)
            .map(|grid| (grid, Frame { name: "index".into(), source: "options", ..frame })),
        None => Grid::with_affine(dims, affine).map(|grid| (grid, frame)),
    };
    result.map_err(|cause| Error::Lattice { path: path.into(), cause })
}

/// An affine with these columns and this origin.
fn affine_of(columns: [[f64; 3]; 3], origin: [f64; 3]) -> [[f64; 4]; 3] {
    std::array::from_fn(|r| [columns[0][r], columns[1][r], columns[2][r], origin[r]])
}

/// The columns of axes along those of the world.
fn diagonal(spacing: [f64; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|c| std::array::from_fn(|r| if r == c { spacing[c] } else { 0.0 }))
}
