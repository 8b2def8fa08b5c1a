//! Volume files: in a path, out values x fastest on a grid with its world frame.
//!
//! Every format reads its header into an `Unread`: the lattice, the frame, and the values in slabs
//! that are still to be read. What is done with the slabs is the same for all of them.

mod contents;
mod data;
mod decode;
mod file_names;
mod files;
mod layers;
mod metaimage;
mod metaimage_frame;
mod dicom;
mod nifti;
mod nifti_affine;
mod nifti_warnings;
mod nifti_write;
mod npy;
mod npz;
mod nrrd;
mod nrrd_axes;
mod nrrd_frame;
mod nrrd_header;
mod nrrd_segments;
mod nrrd_space;
mod nrrd_write;
mod options;
mod raw;
mod tiff;
mod values;
mod vti;
mod vti_data;
mod vti_write;
mod write;
mod zarr;

use std::path::Path;

use shrouds::volume::Filler;
use shrouds::{Grid, Occupancy, Select};

use crate::error::Error;
use crate::stream::Stream;

pub use contents::{Contents, Segment};
pub use decode::ElementType;
pub use files::volume_files;
pub use layers::read_layers;
pub use npy::write_npy;
pub use options::{Axes, VolumeOptions};
pub use raw::RawLayout;
pub use values::Values;
pub use write::{write_labels, write_volume, written_format, written_label_format};

/// The values of a volume file on their lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// The lattice, with the index-to-world map of the file.
    pub grid: Grid,
    /// One value per lattice point, x fastest, then y, then z.
    pub values: Values,
    /// What the world coordinates mean.
    pub frame: Frame,
    /// What else the file holds.
    pub contents: Contents,
}

/// The lattice points of a volume file that were selected.
#[derive(Debug, Clone, PartialEq)]
pub struct Selected {
    /// The selected points, with the lattice.
    pub occupancy: Occupancy,
    /// What the world coordinates mean.
    pub frame: Frame,
    /// What else the file holds.
    pub contents: Contents,
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

/// A volume file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum VolumeFormat {
    /// NumPy array, `.npy`.
    Npy,
    /// NumPy archive, `.npz`.
    Npz,
    /// NIfTI-1 or NIfTI-2 in one file, `.nii`.
    Nifti,
    /// The same, compressed, `.nii.gz`.
    NiftiGz,
    /// NIfTI-1 or NIfTI-2 as a header `.hdr` and data `.img`, each perhaps with `.gz` behind.
    NiftiPair,
    /// NRRD, `.nrrd`, or its header alone, `.nhdr`.
    Nrrd,
    /// MetaImage, `.mha`, or its header alone, `.mhd`.
    MetaImage,
    /// Voxels and nothing else, `.raw` or `.bin`.
    Raw,
    /// DICOM segmentation, `.dcm`.
    Dicom,
    /// Zarr or OME-Zarr in a folder, `.zarr` or any with its metadata in it.
    Zarr,
    /// TIFF, `.tif` or `.tiff`, or a folder of such files, one per slice.
    Tiff,
    /// VTK image data, `.vti`.
    Vti,
}

/// The volume format that the extension of `path` names, in upper or lower case, or that a folder
/// without such a name holds.
///
/// # Errors
/// [`Error::Extension`] when it names none.
pub fn volume_format(path: impl AsRef<Path>) -> Result<VolumeFormat, Error> {
    let path = path.as_ref();
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let formats = [
        (".npy", VolumeFormat::Npy),
        (".npz", VolumeFormat::Npz),
        (".nii", VolumeFormat::Nifti),
        (".nii.gz", VolumeFormat::NiftiGz),
        (".hdr", VolumeFormat::NiftiPair),
        (".img", VolumeFormat::NiftiPair),
        (".hdr.gz", VolumeFormat::NiftiPair),
        (".img.gz", VolumeFormat::NiftiPair),
        (".nrrd", VolumeFormat::Nrrd),
        (".nhdr", VolumeFormat::Nrrd),
        (".mha", VolumeFormat::MetaImage),
        (".mhd", VolumeFormat::MetaImage),
        (".raw", VolumeFormat::Raw),
        (".bin", VolumeFormat::Raw),
        (".dcm", VolumeFormat::Dicom),
        (".zarr", VolumeFormat::Zarr),
        (".tif", VolumeFormat::Tiff),
        (".tiff", VolumeFormat::Tiff),
        (".vti", VolumeFormat::Vti),
    ];
    if zarr::is_zarr(path) {
        return Ok(VolumeFormat::Zarr);
    }
    let known = formats.iter().find(|(extension, _)| name.ends_with(extension));
    if known.is_none() && tiff::holds_slices(path) {
        return Ok(VolumeFormat::Tiff);
    }
    known.map(|(_, format)| *format).ok_or_else(|| {
        let known = "volumes are read from .nii, .nii.gz, .hdr with .img, .nrrd, .nhdr, .mha, .mhd, .dcm, \
            .npy, .npz, .vti, .tif, .raw, and folders of .tif or of Zarr";
        Error::Extension { path: path.into(), kind: "volume", known }
    })
}

/// Reads a volume in the format that the extension of `path` names.
///
/// # Errors
/// [`Error::Extension`] for an unknown extension, [`Error::Io`] when the file cannot be read,
/// [`Error::Content`] when it is of another kind than its extension says, [`Error::Header`],
/// [`Error::Truncated`] and [`Error::Compressed`] when it is damaged, [`Error::Unsupported`] when it
/// is sound but not a three-dimensional array of real numbers, [`Error::Choice`] when it holds several
/// volumes and the options do not name one of them, [`Error::Layout`] when a raw file comes without a
/// layout or with one that does not fit, [`Error::Lattice`] when its dimensions or its
/// frame make no lattice.
pub fn read_volume(path: impl AsRef<Path>, options: &VolumeOptions) -> Result<Volume, Error> {
    let path = path.as_ref();
    let Unread { grid, frame, contents, mut slabs, z_fastest, scaling } = open(path, options)?;
    if contents.layers > 1 && options.layer.is_none() {
        return Err(no_layer(path, &contents));
    }
    let mut values: Option<Values> = None;
    while let Some(slab) = slabs.next()? {
        let slab = match scaling {
            Some((slope, shift)) => slab.scaled(slope, shift),
            None => slab,
        };
        match &mut values {
            Some(values) => values.append(slab),
            None => {
                let more = slabs.held().saturating_sub(slab.len());
                let first = values.insert(slab);
                if !first.reserve(more) {
                    let what = format!(
                        "a volume of {grid_points} voxels, more than memory can hold,",
                        grid_points = grid.point_count()
                    );
                    return Err(Error::unsupported(path, what, "crop or downsample it first"));
                }
            }
        }
    }
    let values = values.unwrap_or(Values::U8(Vec::new()));
    let values = if z_fastest { values.with_axes_reversed(grid.dims()) } else { values };
    Ok(Volume { grid, values, frame, contents })
}

/// Reads a volume as [`read_volume`] does, but keeps of every value only whether `select` chooses
/// it: an eighth of a byte. Of several layers of segments, unless the options name one, the points
/// that are chosen in any of them.
///
/// # Errors
/// As for [`read_volume`]; [`Error::Values`] when a value is not a number.
pub fn read_occupancy(
    path: impl AsRef<Path>,
    options: &VolumeOptions,
    select: &Select,
) -> Result<Selected, Error> {
    let path = path.as_ref();
    let first = open(path, options)?;
    let layers = first.contents.layers;
    if layers == 1 || options.layer.is_some() {
        return fill(path, first, select);
    }
    // Segments of a series lie in its first layer, or in none.
    if !first.contents.has_layers_of_segments() {
        return Err(no_layer(path, &first.contents));
    }
    let mut all = fill(path, first, select)?;
    for layer in 1..layers {
        let unread = open(path, &VolumeOptions { layer: Some(layer), ..*options })?;
        all.occupancy.unite(&fill(path, unread, select)?.occupancy);
    }
    Ok(all)
}

/// Reads what a volume file says of itself: lattice, frame and contents, no values.
///
/// # Errors
/// As for [`read_volume`], of what the header alone can tell.
pub fn read_contents(
    path: impl AsRef<Path>,
    options: &VolumeOptions,
) -> Result<(Grid, Frame, Contents), Error> {
    let Unread { grid, frame, contents, .. } = open(path.as_ref(), options)?;
    Ok((grid, frame, contents))
}

/// A volume file whose header has been read.
struct Unread<'a> {
    grid: Grid,
    frame: Frame,
    contents: Contents,
    /// The values of the layer that the options name, or of the first.
    slabs: Box<dyn Slabs + 'a>,
    /// Values come z fastest, not x fastest.
    z_fastest: bool,
    /// Slope and shift from stored values to those that are meant, if they change anything.
    scaling: Option<(f64, f64)>,
}

/// The values of a lattice, read piece by piece.
///
/// What a header promises is no reason to take memory: pieces grow with the bytes that are there.
trait Slabs {
    /// The next values in the order of the file, whole rows of its fastest axis and at most a few
    /// megabytes or one slice; `None` after the last, when all checksums are right. Every piece is
    /// of the same type.
    fn next(&mut self) -> Result<Option<Values>, Error>;

    /// Values that are certainly there and worth making room for at once.
    fn held(&self) -> usize {
        0
    }
}

/// Puts all values of a lattice on their sides.
fn fill(path: &Path, unread: Unread, select: &Select) -> Result<Selected, Error> {
    let Unread { grid, frame, contents, mut slabs, z_fastest, scaling } = unread;
    let filler = if z_fastest { Filler::z_fastest } else { Filler::new };
    let mut filler = filler(grid, select.clone());
    while let Some(slab) = slabs.next()? {
        match scaling {
            Some((slope, shift)) => slab.scaled(slope, shift).push_to(&mut filler),
            None => slab.push_to(&mut filler),
        }
    }
    let volume = filler.finish().map_err(|cause| Error::Values { path: path.into(), cause })?;
    Ok(Selected { occupancy: volume, frame, contents })
}

fn open<'a>(path: &'a Path, options: &VolumeOptions<'a>) -> Result<Unread<'a>, Error> {
    let format = volume_format(path)?;
    let stream = || Stream::open(path, options.progress);
    let unread = match format {
        VolumeFormat::Npy => npy::open(stream()?, options),
        VolumeFormat::Npz => npz::open(path, options),
        VolumeFormat::Nifti => nifti::open(stream()?, options),
        VolumeFormat::NiftiGz => nifti::open_compressed(stream()?, options),
        VolumeFormat::NiftiPair => nifti::open_pair(path, options),
        VolumeFormat::Nrrd => nrrd::open(stream()?, options),
        VolumeFormat::MetaImage => metaimage::open(stream()?, options),
        VolumeFormat::Raw => raw::open(stream()?, options),
        VolumeFormat::Dicom => dicom::open(stream()?, options),
        VolumeFormat::Zarr => zarr::open(path, options),
        VolumeFormat::Tiff => tiff::open(path, options),
        VolumeFormat::Vti => vti::open(path, options),
    }?;
    let Contents { layers, levels, .. } = unread.contents;
    if options.level >= levels {
        return Err(Error::Choice { path: path.into(), choices: numbered("level", levels) });
    }
    match options.layer {
        Some(layer) if layer >= layers => Err(no_layer(path, &unread.contents)),
        _ => Ok(unread),
    }
}

/// That the options name no layer of the file.
fn no_layer(path: &Path, contents: &Contents) -> Error {
    Error::Choice { path: path.into(), choices: numbered("frame", contents.layers) }
}

fn numbered(what: &str, count: usize) -> String {
    if count == 1 { format!("{what} 0 only") } else { format!("{what}s 0 to {}", count - 1) }
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

/// A step across the plane of two others, as long as the shorter of them: that between the slices of
/// an image.
fn normal_step(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let length = |a: [f64; 3]| a.iter().map(|x| x * x).sum::<f64>().sqrt();
    let normal: [f64; 3] = std::array::from_fn(|r| {
        let (s, t) = ((r + 1) % 3, (r + 2) % 3);
        u[s] * v[t] - u[t] * v[s]
    });
    let step = length(u).min(length(v)) / length(normal);
    normal.map(|x| x * step)
}
