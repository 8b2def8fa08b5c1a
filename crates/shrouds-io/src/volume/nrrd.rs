//! NRRD with its header attached, raw or gzip.
//!
//! Format: teem's "Definition of NRRD File Format", versions 1 to 5. The header is lines of text, a
//! blank line ends it, the first axis is the fastest.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::decode::{Element, Elements, Endian};
use crate::volume::{Contents, Frame, Unread, VolumeOptions, affine_of, diagonal, lattice};

/// Longest line and most lines that are read: 3D Slicer keeps tables of segments in its headers.
const MAX_LINE: u64 = 1 << 20;
const MAX_LINES: usize = 1 << 16;

/// Fields by name, in lower case, with their values.
type Fields = BTreeMap<String, String>;

pub(super) fn open<'a>(
    mut stream: Stream<'a>,
    options: &VolumeOptions,
) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    let fields = read_fields(&mut stream)?;
    let dims = dimensions(path, &fields)?;
    let element = element(path, &fields)?;
    let endian = endian(path, &fields, element)?;
    let gzip = is_gzip(path, &fields)?;
    let (affine, frame) = placement(path, &fields)?;
    let (grid, frame) = lattice(path, dims, affine, frame, options)?;
    let stream = if gzip { stream.unpacked() } else { stream };
    let slabs = Box::new(Elements::new(stream, element, endian, grid.point_count(), dims[0]));
    let contents = Contents::default();
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling: None })
}

fn read_fields(stream: &mut Stream) -> Result<Fields, Error> {
    let path = stream.path;
    let magic = stream.line(MAX_LINE)?.unwrap_or_default();
    if !magic.starts_with("NRRD000") {
        let advice = "check the extension, or write it again as .nrrd";
        return Err(Error::Content { path: path.into(), expected: "an NRRD volume", advice });
    }
    let mut fields = Fields::new();
    for _ in 0..MAX_LINES {
        let Some(line) = stream.line(MAX_LINE)? else { break };
        if line.is_empty() {
            return check_attached(path, &fields).map(|()| fields);
        }
        // Comments start with #; "key:=value" pairs are the user's own and mean nothing here.
        if line.starts_with('#') {
            continue;
        }
        match line.split_once(':') {
            Some((_, value)) if value.starts_with('=') => {}
            Some((name, value)) => {
                fields.insert(name.trim().to_lowercase(), value.trim().to_string());
            }
            None => return Err(Error::header(path, format!("the line '{line:.60}' has no field"))),
        }
    }
    // A detached header may end with the file instead of a blank line.
    check_attached(path, &fields)?;
    Err(Error::header(path, "the blank line that ends it is missing"))
}

fn check_attached(path: &Path, fields: &Fields) -> Result<(), Error> {
    if fields.contains_key("data file") || fields.contains_key("datafile") {
        let what = "an NRRD header whose data is in another file";
        return Err(Error::unsupported(path, what, "write header and data to one .nrrd file"));
    }
    let skips = ["byte skip", "byteskip", "line skip", "lineskip"];
    if skips.iter().filter_map(|name| fields.get(*name)).any(|skip| skip != "0") {
        let what = "NRRD data that does not follow its header (byte skip, line skip)";
        return Err(Error::unsupported(path, what, "write it again without a skip"));
    }
    Ok(())
}

fn field<'f>(path: &Path, fields: &'f Fields, name: &str) -> Result<&'f str, Error> {
    let value = fields.get(name).map(String::as_str);
    value.ok_or_else(|| Error::header(path, format!("the field '{name}' is missing")))
}

fn dimensions(path: &Path, fields: &Fields) -> Result<[usize; 3], Error> {
    let sizes = field(path, fields, "sizes")?;
    let dimension = field(path, fields, "dimension")?;
    if dimension != "3" {
        let what = format!("an NRRD of {dimension:.20} dimensions (sizes {sizes:.60})");
        let advice = "extract one volume of three dimensions (overlapping segments: one layer)";
        return Err(Error::unsupported(path, what, advice));
    }
    let lengths: Option<Vec<usize>> = sizes.split_whitespace().map(|n| n.parse().ok()).collect();
    lengths.and_then(|lengths| lengths.try_into().ok()).ok_or_else(|| {
        Error::header(path, format!("the sizes '{sizes:.60}' are not three numbers"))
    })
}

fn element(path: &Path, fields: &Fields) -> Result<Element, Error> {
    let name = field(path, fields, "type")?.to_lowercase();
    Ok(match name.as_str() {
        "signed char" | "char" | "int8" | "int8_t" => Element::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Element::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
            Element::I16
        }
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => Element::U16,
        "int" | "signed int" | "int32" | "int32_t" => Element::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => Element::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => Element::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            Element::U64
        }
        "float" => Element::F32,
        "double" => Element::F64,
        _ => {
            let advice = "convert it to an integer or float type";
            return Err(Error::unsupported(path, format!("the NRRD type '{name:.60}'"), advice));
        }
    })
}

fn endian(path: &Path, fields: &Fields, element: Element) -> Result<Endian, Error> {
    if element.size() == 1 {
        return Ok(Endian::Little);
    }
    match field(path, fields, "endian")?.to_lowercase().as_str() {
        "little" => Ok(Endian::Little),
        "big" => Ok(Endian::Big),
        other => Err(Error::header(path, format!("endian is '{other:.60}', not little or big"))),
    }
}

fn is_gzip(path: &Path, fields: &Fields) -> Result<bool, Error> {
    match field(path, fields, "encoding")?.to_lowercase().as_str() {
        "raw" => Ok(false),
        "gzip" | "gz" => Ok(true),
        other => {
            let advice = "write it with encoding raw or gzip";
            Err(Error::unsupported(path, format!("the NRRD encoding '{other:.60}'"), advice))
        }
    }
}

/// Index-to-world map and frame: space directions with their origin, else spacings, else 1.
fn placement(path: &Path, fields: &Fields) -> Result<([[f64; 4]; 3], Frame), Error> {
    let name = match fields.get("space").map(|name| name.to_lowercase()).as_deref() {
        Some("left-posterior-superior" | "lps") => "LPS".into(),
        Some("right-anterior-superior" | "ras") => "RAS".into(),
        Some("left-anterior-superior" | "las") => "LAS".into(),
        Some(other) => other.to_string(),
        None if fields.contains_key("space directions") => "unnamed".into(),
        None => "index".into(),
    };
    let unit = ["space units", "units"].iter().find_map(|field| first_quoted(fields.get(*field)?));
    let patient = ["LPS", "RAS", "LAS"].contains(&name.as_str());
    let unit = unit.unwrap_or(if patient { "mm" } else { "unknown" });
    if let Some(directions) = fields.get("space directions") {
        let columns = vectors(directions).and_then(|columns| columns.try_into().ok());
        let columns = columns.ok_or_else(|| {
            let problem = format!("the space directions '{directions:.80}' are not three vectors");
            Error::header(path, problem)
        })?;
        let origin = match fields.get("space origin") {
            None => [0.0; 3],
            Some(text) => match vectors(text).as_deref() {
                Some([origin]) => *origin,
                _ => return Err(Error::header(path, format!("space origin is '{text:.60}'"))),
            },
        };
        return Ok((affine_of(columns, origin), Frame::new(name, unit, "space directions")));
    }
    let Some(text) = fields.get("spacings") else {
        let affine = affine_of(diagonal([1.0; 3]), [0.0; 3]);
        return Ok((affine, Frame::new(name, unit, "none")));
    };
    let spacings: Option<Vec<f64>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
    let spacings: Option<[f64; 3]> = spacings.and_then(|spacings| spacings.try_into().ok());
    let spacings = spacings
        .ok_or_else(|| Error::header(path, format!("the spacings '{text:.60}' are not three")))?;
    Ok((affine_of(diagonal(spacings), [0.0; 3]), Frame::new(name, unit, "spacings")))
}

/// The vectors of a text such as `(1,0,0) (0,1,0)`; `None` if there is anything else in it.
fn vectors(text: &str) -> Option<Vec<[f64; 3]>> {
    let parts = text.split(')').map(str::trim).filter(|part| !part.is_empty());
    parts
        .map(|part| {
            let numbers = part.strip_prefix('(')?.split(',').map(|n| n.trim().parse().ok());
            numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
        })
        .collect()
}

/// The first text between quotes that is not empty.
fn first_quoted(text: &str) -> Option<&str> {
    text.split('"').skip(1).step_by(2).map(str::trim).find(|unit| !unit.is_empty())
}
