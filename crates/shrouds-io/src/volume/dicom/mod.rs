//! DICOM segmentations: Segmentation Storage and Label Map Segmentation Storage.
//!
//! Every frame is one slice of one segment, in any order, and empty ones are left out. Segments that
//! overlap cannot share a lattice of labels, so they are packed into as few layers as the order of
//! their numbers allows. What that takes is one bit per pixel of each frame.
//!
//! Standard: DICOM PS3.3 A.51, C.8.20 and C.7.6.16; PS3.5 8.2 and annexes A and G.

mod elements;
mod frames;
mod geometry;
mod layers;

use std::collections::BTreeSet;
use std::path::Path;

use shrouds::Grid;

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::dicom::elements::{Dataset, Reader, UNDEFINED, tag};
use crate::volume::dicom::frames::{Coding, Stored};
use crate::volume::dicom::geometry::{Plane, Stack, stack};
use crate::volume::dicom::layers::{Frame as SegmentFrame, LabelSlices, pack};
use crate::volume::{Contents, Frame, Segment, Unread, VolumeOptions, lattice};

const SEGMENTATION: &str = "1.2.840.10008.5.1.4.1.1.66.4";
const LABEL_MAP: &str = "1.2.840.10008.5.1.4.1.1.66.7";

/// Start of the names of all classes, and what others there are.
const STORAGE: &str = "1.2.840.10008.5.1.4.1.1.";
const CLASSES: [(&str, &str); 8] = [
    ("2", "a slice of a CT series"),
    ("2.1", "a CT image"),
    ("4", "a slice of an MR series"),
    ("4.1", "an MR image"),
    ("128", "a slice of a PET series"),
    ("66.5", "a surface segmentation"),
    ("481.2", "a radiotherapy dose"),
    ("481.3", "a radiotherapy structure set"),
];

/// What pixels mean.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// A segment each frame, one bit a pixel.
    Binary,
    /// A segment each frame, one byte a pixel, this much for a pixel that is wholly inside.
    Fractional(usize),
    /// The numbers of the segments, of this many bits.
    LabelMap(usize),
}

pub(super) fn open<'a>(stream: Stream<'a>, options: &VolumeOptions) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    let mut reader = Reader::new(stream)?;
    let meta = reader.meta()?;
    if let Some(class) = meta.text(tag::MEDIA_CLASS) {
        check_class(path, &class)?;
    }
    let syntax = meta.text(tag::TRANSFER_SYNTAX).unwrap_or_default();
    let (coding, mut reader) = Coding::new(reader, &syntax)?;
    let (header, length) = reader.before_pixels()?;
    check_class(path, &header.text(tag::SOP_CLASS).unwrap_or_default())?;
    let kind = kind(path, &header)?;
    let number = |tag, name: &str| {
        let number = header.number(tag).filter(|number| *number > 0);
        number.ok_or_else(|| Error::header(path, format!("it has no valid number of {name}")))
    };
    let (rows, columns) = (number(tag::ROWS, "rows")?, number(tag::COLUMNS, "columns")?);
    let (stack, owners) = placed_frames(path, &header, kind)?;
    let mut warnings = stack.warnings;
    if header.text(tag::FRAMES).is_none() {
        warnings.push("It has no number of frames: the first was read as the only one.".into());
    }
    let dims = [columns, rows, stack.slices];
    let frame = Frame::new("LPS", "mm", "plane positions");
    let (grid, frame) = lattice(path, dims, stack.affine, frame, options)?;

    let bits = match kind {
        Kind::Binary => 1,
        Kind::Fractional(_) => 8,
        Kind::LabelMap(bits) => bits,
    };
    let stored = Stored { frames: owners.len(), pixels: rows * columns, bits };
    let pixels = stored.read(&mut reader, coding, (length != UNDEFINED).then_some(length))?;
    reader.stream.finish()?;
    let mut contents = Contents { warnings, ..Contents::default() };
    contents.segments = names(&header);
    let maximum = match kind {
        Kind::LabelMap(_) => {
            let slabs = LabelSlices::of_label_map(path, dims, stack.slice_of, stored, pixels)?;
            return Ok(unread(grid, frame, contents, slabs));
        }
        Kind::Binary => None,
        Kind::Fractional(maximum) => Some(maximum),
    };
    if let Some(maximum) = maximum {
        contents.warnings.push(format!(
            "The segments are fractional: voxels of at least half of {maximum} are inside."
        ));
    }
    let frames = owners.into_iter().zip(stack.slice_of).zip(stored.masks(pixels, maximum));
    let frames =
        frames.map(|((segment, slice), mask)| SegmentFrame { segment, slice, mask }).collect();
    let packed = pack(path, frames)?;
    contents.layers = packed.layers;
    contents.segments = segments(contents.segments, &packed.layer_of);
    let slabs = LabelSlices::of_segments(dims, packed, options.layer.unwrap_or(0));
    Ok(unread(grid, frame, contents, slabs))
}

fn unread<'a>(grid: Grid, frame: Frame, contents: Contents, slabs: LabelSlices) -> Unread<'a> {
    Unread { grid, frame, contents, slabs: Box::new(slabs), z_fastest: false, scaling: None }
}

/// That the file holds a segmentation.
fn check_class(path: &Path, class: &str) -> Result<(), Error> {
    if class == SEGMENTATION || class == LABEL_MAP {
        return Ok(());
    }
    let name = class.strip_prefix(STORAGE).unwrap_or_default();
    let name = CLASSES.iter().find(|(class, _)| *class == name);
    let name = name.map_or("a DICOM object that is no segmentation", |(_, name)| name);
    let advice = "name a segmentation object (modality SEG), or convert it to NRRD or NIfTI";
    Err(Error::unsupported(path, format!("{name} (class {class})"), advice))
}

fn kind(path: &Path, header: &Dataset) -> Result<Kind, Error> {
    if header.number(tag::TOTAL_COLUMNS).is_some() {
        let what = "a segmentation of a tiled slide";
        return Err(Error::unsupported(path, what, "convert it to OME-Zarr or TIFF"));
    }
    let name = header.text(tag::SEGMENTATION_TYPE).unwrap_or_default();
    let bits = header.number(tag::BITS_ALLOCATED);
    match (name.as_str(), bits) {
        ("BINARY", Some(1)) => Ok(Kind::Binary),
        ("FRACTIONAL", Some(8)) => {
            Ok(Kind::Fractional(header.number(tag::MAXIMUM_FRACTIONAL_VALUE).unwrap_or(255).max(1)))
        }
        ("LABELMAP", Some(8)) => Ok(Kind::LabelMap(8)),
        ("LABELMAP", Some(16)) => Ok(Kind::LabelMap(16)),
        ("BINARY" | "FRACTIONAL" | "LABELMAP", bits) => {
            let bits = bits.map_or("an unknown number of".into(), |bits| bits.to_string());
            Err(Error::header(path, format!("a {name} segmentation has {bits} bits a pixel")))
        }
        _ => Err(Error::header(path, format!("the segmentation type is '{name}'"))),
    }
}

/// The lattice, and the segment number of each frame (0 in label maps).
fn placed_frames(path: &Path, header: &Dataset, kind: Kind) -> Result<(Stack, Vec<usize>), Error> {
    let nothing = Dataset::default();
    let shared = header.item(tag::SHARED_GROUPS).unwrap_or(&nothing);
    let mut groups = header.items(tag::FRAME_GROUPS);
    match header.text(tag::FRAMES) {
        // As in images of one frame, which do not count it.
        None => groups = &groups[..groups.len().min(1)],
        Some(count) if count.parse() == Ok(groups.len()) => {}
        Some(count) => {
            let problem = format!("it has {count} frames, and places {} of them", groups.len());
            return Err(Error::header(path, problem));
        }
    }
    if groups.is_empty() {
        return Err(Error::header(path, "it places no frame"));
    }
    let mut owners = Vec::new();
    for own in groups {
        let id = [own, shared].into_iter().find_map(|g| g.item(tag::SEGMENT_IDENTIFICATION));
        let owner = id.and_then(|id| id.number(tag::REFERENCED_SEGMENT));
        owners.push(match (kind, owner) {
            (Kind::LabelMap(_), _) => 0,
            (_, Some(owner @ 1..=0xffff)) => owner,
            _ => return Err(Error::header(path, "a frame belongs to no segment")),
        });
    }
    let planes: Result<Vec<Plane>, Error> =
        groups.iter().map(|own| Plane::new(path, own, shared)).collect();
    Ok((stack(path, &planes?)?, owners))
}

/// The segments that the file names, all in the first layer.
fn names(header: &Dataset) -> Vec<Segment> {
    let segment = |item: &Dataset| {
        let label = item.number(tag::SEGMENT_NUMBER)? as i128;
        let name = item.text(tag::SEGMENT_LABEL).unwrap_or_default();
        Some(Segment { name, label, layer: 0 })
    };
    header.items(tag::SEGMENT_SEQUENCE).iter().filter_map(segment).collect()
}

/// The segments in their layers; those without a frame stay in the first, those without a name
/// come last.
fn segments(mut segments: Vec<Segment>, layer_of: &[(usize, usize)]) -> Vec<Segment> {
    for segment in &mut segments {
        let found = layer_of.binary_search_by_key(&segment.label, |(label, _)| *label as i128);
        segment.layer = found.map_or(0, |n| layer_of[n].1);
    }
    let named: BTreeSet<i128> = segments.iter().map(|segment| segment.label).collect();
    let unnamed = layer_of.iter().map(|&(label, layer)| (label as i128, layer));
    let unnamed = unnamed.filter(|(label, _)| !named.contains(label));
    segments.extend(unnamed.map(|(label, layer)| Segment { name: String::new(), label, layer }));
    segments
}
