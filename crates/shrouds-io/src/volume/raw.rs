//! Raw voxels, `.raw` and `.bin`: what the file does not say comes with the call, or from a file of
//! JSON beside it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::data::{Data, Layers, Packing};
use crate::volume::decode::{ElementType, Endian};
use crate::volume::{Contents, Frame, Unread, VolumeOptions, affine_of, diagonal, lattice};

/// Longest file of JSON that is read.
const MAX_JSON: u64 = 1 << 16;

/// How voxels lie in a file that does not say so itself: x fastest, then y, then z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawLayout {
    /// Lattice points along x, y, z.
    pub dims: [usize; 3],
    /// Type of the voxels.
    pub element: ElementType,
    /// Whether the first byte of a voxel is its highest.
    pub big_endian: bool,
    /// Bytes before the first voxel.
    pub offset: u64,
}

/// A layout with what a file of JSON tells of the frame.
struct Described {
    layout: RawLayout,
    spacing: [f64; 3],
    origin: [f64; 3],
    unit: String,
    source: &'static str,
}

pub(super) fn open<'a>(
    stream: Stream<'a>,
    options: &VolumeOptions<'a>,
) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    let mut files = Vec::new();
    let Described { layout, spacing, origin, unit, source } = match options.raw {
        Some(layout) => {
            let (spacing, origin, unit) = ([1.0; 3], [0.0; 3], "unknown".into());
            Described { layout, spacing, origin, unit, source: "none" }
        }
        None => {
            let json = json_beside(path)?;
            files.push(json.clone());
            read_json(&json)?
        }
    };
    let name = if source == "none" { "index" } else { "unnamed" };
    let affine = affine_of(diagonal(spacing), origin);
    let (grid, frame) =
        lattice(path, layout.dims, affine, Frame::new(name, unit, source), options)?;
    if let Some(length) = stream.remaining() {
        check_length(path, &layout, grid.point_count(), length)?;
    }
    let endian = if layout.big_endian { Endian::Big } else { Endian::Little };
    let byte_skip = i64::try_from(layout.offset)
        .map_err(|_| Error::header(path, format!("the offset is {}", layout.offset)))?;
    let layers = Layers { inner: grid.point_count(), count: 1, outer: 1, chosen: 0 };
    let data = Data {
        element: layout.element,
        endian,
        packing: Packing::Raw,
        line_skip: 0,
        byte_skip,
        row: layout.dims[0],
        layers,
    };
    let slabs = data.attached(stream)?;
    Ok(Unread {
        grid,
        frame,
        contents: Contents { files, ..Contents::default() },
        slabs,
        z_fastest: false,
        scaling: None,
    })
}

/// Nothing in the file contradicts a wrong layout but its length: it must fit.
fn check_length(path: &Path, layout: &RawLayout, points: usize, length: u64) -> Result<(), Error> {
    let RawLayout { dims, element, offset, .. } = *layout;
    let bytes = |element: ElementType| points as u128 * element.size() as u128;
    let needed = bytes(element) + u128::from(offset);
    if needed == u128::from(length) {
        return Ok(());
    }
    let fits = |wanted: &ElementType| bytes(*wanted) + u128::from(offset) == u128::from(length);
    let mut readings: Vec<String> = ElementType::ALL
        .iter()
        .filter(|wanted| fits(wanted))
        .map(|wanted| format!("type {}", wanted.name()))
        .collect();
    if let Some(before) = u128::from(length).checked_sub(bytes(element)) {
        readings.push(format!("offset {before}"));
    }
    let slice = (dims[0] * dims[1] * element.size()) as u64;
    match length.checked_sub(offset) {
        Some(rest) if rest > 0 && rest.is_multiple_of(slice) => {
            readings.push(format!("dims {}, {}, {}", dims[0], dims[1], rest / slice));
        }
        _ => {}
    }
    let fitting = match readings.len() {
        0 => "no type or offset makes them fit".into(),
        _ => format!("these would fit: {}", readings.join("; ")),
    };
    let [x, y, z] = dims;
    Err(Error::Layout {
        path: path.into(),
        problem: format!(
            "{x} × {y} × {z} voxels of type {} from byte {offset} on are {needed} bytes, but the file \
             has {length}: {fitting}",
            element.name()
        ),
    })
}

/// The file of JSON that has the layout: `NAME.raw.json` or `NAME.json`.
fn json_beside(path: &Path) -> Result<PathBuf, Error> {
    let mut name = path.as_os_str().to_owned();
    name.push(".json");
    let candidates = [PathBuf::from(name), path.with_extension("json")];
    let Some(json) = candidates.into_iter().find(|candidate| candidate.is_file()) else {
        let header = ["mhd", "nhdr"].map(|extension| path.with_extension(extension));
        let problem = match header.iter().find(|header| header.is_file()) {
            Some(header) => format!("a raw file does not say how to read it; read {}", header.display()),
            None => "a raw file does not say how to read it: give dimensions and type, or put them into \
                     a file of the same name and .json, {\"dims\": [x, y, z], \"type\": \"uint8\"}, or \
                     read the .mhd or .nhdr file that belongs to it"
                .into(),
        };
        return Err(Error::Layout { path: path.into(), problem });
    };
    Ok(json)
}

fn read_json(json: &Path) -> Result<Described, Error> {
    let mut text = String::new();
    let read = File::open(json).and_then(|file| file.take(MAX_JSON).read_to_string(&mut text));
    read.map_err(|cause| Error::open(json, cause))?;
    let value: Value = serde_json::from_str(&text)
        .map_err(|cause| Error::header(json, format!("it is not JSON ({cause})")))?;
    describe(&value).map_err(|problem| Error::header(json, problem))
}

fn describe(value: &Value) -> Result<Described, String> {
    let fields = value.as_object().ok_or("it is not an object of fields")?;
    let known = ["dims", "type", "endian", "offset", "spacing", "origin", "unit"];
    if let Some(name) = fields.keys().find(|name| !known.contains(&name.as_str())) {
        return Err(format!("the field '{name:.40}' is none of {}", known.join(", ")));
    }
    let dims: Option<Vec<usize>> = fields.get("dims").and_then(Value::as_array).and_then(|dims| {
        dims.iter().map(|n| n.as_u64().and_then(|n| usize::try_from(n).ok())).collect()
    });
    let dims = dims.and_then(|dims| dims.try_into().ok());
    let dims = dims.ok_or("the field 'dims' is not a list of three whole numbers")?;
    let name = fields.get("type").and_then(Value::as_str).ok_or("the field 'type' is missing")?;
    let element = ElementType::from_name(name).ok_or_else(|| {
        let names: Vec<&str> = ElementType::ALL.iter().map(|element| element.name()).collect();
        format!("the type '{name:.40}' is none of {}", names.join(", "))
    })?;
    let big_endian = match fields.get("endian").map(Value::as_str) {
        None | Some(Some("little")) => false,
        Some(Some("big")) => true,
        Some(_) => return Err("the field 'endian' is neither little nor big".into()),
    };
    let offset = match fields.get("offset") {
        None => 0,
        Some(offset) => offset.as_u64().ok_or("the field 'offset' is not a number of bytes")?,
    };
    let unit = match fields.get("unit") {
        None => "unknown",
        Some(unit) => unit.as_str().ok_or("the field 'unit' is not a text")?,
    };
    let placed = ["spacing", "origin"].iter().any(|name| fields.contains_key(*name));
    Ok(Described {
        layout: RawLayout { dims, element, big_endian, offset },
        spacing: numbers(fields, "spacing", 1.0)?,
        origin: numbers(fields, "origin", 0.0)?,
        unit: unit.into(),
        source: if placed { "sidecar" } else { "none" },
    })
}

fn numbers(fields: &Map<String, Value>, name: &str, default: f64) -> Result<[f64; 3], String> {
    let Some(value) = fields.get(name) else { return Ok([default; 3]) };
    let numbers: Option<Vec<f64>> =
        value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("the field '{name}' is not a list of three numbers"))
}
