//! Zarr arrays in a folder, versions 2 and 3, and OME-Zarr images of them.
//!
//! The folder may be that of an image, of one of its label images, of one of its resolutions, or of
//! any array. Chunks that are not there have the fill value, as the format wants it; damaged ones are
//! errors.

mod blosc;
mod chunks;
mod codec;
mod element;
mod metadata;
mod node;
mod ome;
mod slabs;

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::volume::zarr::metadata::Array;
use crate::volume::zarr::node::Node;
use crate::volume::zarr::ome::{Image, Placement, label_names};
use crate::volume::zarr::slabs::{Layout, Rows};
use crate::volume::{
    Axes, Contents, Frame, Segment, Unread, VolumeOptions, affine_of, diagonal, lattice,
};

/// The name by which the image is chosen where there are labels too.
const IMAGE: &str = "image";
/// Most nodes of a folder that are looked at and named.
const MOST_NODES: usize = 1000;

/// Whether a path is a folder that holds Zarr metadata.
pub(super) fn is_zarr(path: &Path) -> bool {
    let files = ["zarr.json", ".zarray", ".zgroup", ".zattrs"];
    path.is_dir() && files.iter().any(|file| path.join(file).is_file())
}

/// The array that the options choose, and what else there is.
struct Found {
    array: Array,
    placement: Placement,
    segments: Vec<Segment>,
    levels: usize,
    /// The array is placed by an image.
    is_placed: bool,
}

pub(super) fn open<'a>(path: &'a Path, options: &VolumeOptions<'a>) -> Result<Unread<'a>, Error> {
    std::fs::metadata(path).map_err(|cause| Error::open(path, cause))?;
    let Some(node) = Node::read(path)? else {
        let advice =
            "name a folder with zarr.json, .zgroup or .zarray in it; unpack archives first";
        return Err(Error::Content { path: path.into(), expected: "a Zarr folder", advice });
    };
    let mut contents = Contents::default();
    let chosen = choose(node, options, &mut contents)?;
    let found = find(&chosen, options)?;
    let Found { array, placement, segments, levels, is_placed } = found;
    contents.layers = placement.layout.layers(&array.shape);
    contents.levels = levels;
    contents.segments = segments;
    contents.warnings.extend(placement.warnings);
    let frame = if is_placed {
        Frame::new("unnamed", placement.unit, "multiscales")
    } else {
        Frame::new("index", "unknown", "none")
    };
    let dims = placement.layout.dims(&array.shape);
    let affine = affine_of(diagonal(placement.spacing), placement.origin);
    let (grid, frame) = lattice(&array.file, dims, affine, frame, options)?;
    let layer = options.layer.filter(|layer| *layer < contents.layers).unwrap_or(0);
    let slabs = Box::new(Rows::new(array, placement.layout, layer, options.progress));
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling: None })
}

/// The node that the options choose: of an image with labels those, of a plain group one member.
fn choose(node: Node, options: &VolumeOptions, contents: &mut Contents) -> Result<Node, Error> {
    if node.is_array() {
        return Ok(node);
    }
    let (names, folder) = match Image::of(&node) {
        Some(image) if image.is_label() => return Ok(node),
        Some(_) => (label_names(&node.folder)?, node.folder.join("labels")),
        None => (members(&node.folder)?, node.folder.clone()),
    };
    let is_image = Image::of(&node).is_some();
    if names.is_empty() && is_image {
        return Ok(node);
    }
    contents.arrays = names.clone();
    if is_image && !names.iter().any(|name| name == IMAGE) {
        contents.arrays.push(IMAGE.into());
    }
    let chosen = match (options.array, &names[..]) {
        (Some(name), _) if names.iter().any(|other| other == name) => name,
        (Some(IMAGE), _) if is_image => return Ok(node),
        (None, [only]) => {
            if is_image {
                contents.warnings.push(format!(
                    "The image has labels: '{only}' is read. Array '{IMAGE}' is the image itself."
                ));
            }
            only
        }
        (None, []) => {
            let advice = "name the folder of an image or of an array";
            return Err(Error::unsupported(&node.folder, "a Zarr group without either", advice));
        }
        _ => {
            let choices = format!("the arrays {}", contents.arrays.join(", "));
            return Err(Error::Choice { path: node.folder, choices });
        }
    };
    let folder = folder.join(chosen);
    Node::read(&folder)?.ok_or_else(|| {
        Error::header(
            &node.file,
            format!("it names '{chosen}', but there is no such array or group"),
        )
    })
}

/// The array of a node: itself, or the resolution of the image that the options choose.
fn find(node: &Node, options: &VolumeOptions) -> Result<Found, Error> {
    if let Some(array) = Array::of(node)? {
        return match parent_of(&array)? {
            Some((parent, level)) => placed(&parent, array, level, 1),
            None => {
                let placement = plain(&array, options.axes)?;
                let (segments, levels, is_placed) = (Vec::new(), 1, false);
                Ok(Found { array, placement, segments, levels, is_placed })
            }
        };
    }
    let Some(image) = Image::of(node) else {
        let advice = "name the folder of an image or of an array within it";
        return Err(Error::unsupported(&node.folder, "a Zarr group", advice));
    };
    let levels = image.levels()?;
    // A level that is not there is refused once it is known how many there are.
    let level = options.level.min(levels.len() - 1);
    let folder = node.folder.join(levels[level]);
    let array = Node::read(&folder)?.map(|node| Array::of(&node)).transpose()?.flatten();
    let array = array.ok_or_else(|| {
        Error::header(&node.file, format!("its resolution '{}' is no array", levels[level]))
    })?;
    placed(node, array, level, levels.len())
}

fn placed(node: &Node, array: Array, level: usize, levels: usize) -> Result<Found, Error> {
    let image = Image::of(node);
    let image = image.ok_or_else(|| Error::header(&node.file, "it describes no image"))?;
    let placement = image.placement(level, &array.shape)?;
    Ok(Found { array, placement, segments: image.segments(), levels, is_placed: true })
}

/// The image that an array is a resolution of, and which one.
fn parent_of(array: &Array) -> Result<Option<(Node, usize)>, Error> {
    // The folder may have been named from within.
    let Ok(folder) = array.folder.canonicalize() else { return Ok(None) };
    let (Some(parent), Some(name)) = (folder.parent(), folder.file_name()) else { return Ok(None) };
    let Some(node) = Node::read(parent)? else { return Ok(None) };
    let levels = Image::of(&node).map(|image| image.levels()).transpose()?.unwrap_or_default();
    let level = levels.iter().position(|level| Path::new(level) == Path::new(name));
    Ok(level.map(|level| (node, level)))
}

/// An array that nothing places: its axes are those it names, else those of the options.
fn plain(array: &Array, axes: Axes) -> Result<Placement, Error> {
    let rank = array.shape.len();
    let named = ["x", "y", "z"].map(|axis| {
        array.names.iter().position(|name| name.eq_ignore_ascii_case(axis)).filter(|n| *n < rank)
    });
    let spatial = match (rank, axes) {
        (0 | 1, _) => {
            let what = format!("an array of {rank} axes");
            return Err(Error::unsupported(&array.file, what, "give one of two or three axes"));
        }
        _ if named[0].is_some() && named[1].is_some() => named,
        (2, Axes::Zyx) => [Some(1), Some(0), None],
        (2, Axes::Xyz) => [Some(0), Some(1), None],
        (_, Axes::Zyx) => [Some(rank - 1), Some(rank - 2), Some(rank - 3)],
        (_, Axes::Xyz) => [Some(0), Some(1), Some(2)],
    };
    let others = (0..rank).filter(|axis| !spatial.contains(&Some(*axis))).collect();
    Ok(Placement {
        layout: Layout { spatial, others },
        spacing: [1.0; 3],
        origin: [0.0; 3],
        unit: "unknown".into(),
        warnings: Vec::new(),
    })
}

/// Names of the arrays and images right in a group, sorted.
fn members(folder: &Path) -> Result<Vec<String>, Error> {
    let entries = std::fs::read_dir(folder).map_err(|cause| Error::open(folder, cause))?;
    let mut names: Vec<(String, PathBuf)> = Vec::new();
    for entry in entries {
        let path = entry.map_err(|cause| Error::open(folder, cause))?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        if let Some(name) = name.filter(|_| is_zarr(&path)) {
            names.push((name, path));
        }
    }
    names.sort();
    let mut members = Vec::new();
    for (name, path) in names.into_iter().take(MOST_NODES) {
        if Node::read(&path)?.is_some_and(|node| node.is_array() || Image::of(&node).is_some()) {
            members.push(name);
        }
    }
    Ok(members)
}
