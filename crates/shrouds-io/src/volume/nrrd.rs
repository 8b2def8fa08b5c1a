//! NRRD: header attached or detached; raw, gzip, text or hexadecimal; 3D Slicer's segments.
//!
//! Format: teem's "Definition of NRRD File Format", versions 1 to 5. The header is lines of text, a
//! blank line ends it, the first axis is the fastest.

use std::path::Path;

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::data::{Data, Layers, Packing};
use crate::volume::decode::{Element, Endian};
use crate::volume::nrrd_axes::Axes;
use crate::volume::nrrd_frame::placement;
use crate::volume::nrrd_header::Header;
use crate::volume::nrrd_segments::segments;
use crate::volume::{Contents, Unread, VolumeOptions, lattice};

pub(super) fn open<'a>(
    mut stream: Stream<'a>,
    options: &VolumeOptions<'a>,
) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    let mut header = Header::read(&mut stream)?;
    let axes = Axes::new(path, &mut header)?;
    let (affine, frame) = placement(path, &mut header, &axes)?;
    let (grid, frame) = lattice(path, axes.dims(), affine, frame, options)?;
    let layers = axes.layers(path)?;
    let chosen = options.layer.filter(|layer| *layer < layers.count).unwrap_or(0);
    let data = data(path, &header, axes.dims()[0], Layers { chosen, ..layers })?;
    let files = header.data_files(path, &axes.sizes)?;
    let slabs = match files.clone() {
        None => data.attached(stream)?,
        Some(files) => data.detached(path, files, options.progress)?,
    };
    let segments = segments(&mut header, layers.count);
    let warnings = header.warnings;
    let (layers, files) = (layers.count, files.unwrap_or_default());
    let contents = Contents { layers, segments, warnings, files, ..Contents::default() };
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling: None })
}

fn data(path: &Path, header: &Header, row: usize, layers: Layers) -> Result<Data, Error> {
    let element = element(path, header)?;
    let packing = packing(path, header)?;
    let endian = match packing {
        Packing::Decimal => Endian::Little,
        _ => endian(path, header, element)?,
    };
    let skip = |name: &str, least: i64| {
        let text = header.get(name).unwrap_or("0");
        let skip = text.parse().ok().filter(|skip: &i64| *skip >= least);
        skip.ok_or_else(|| Error::header(path, format!("the {name} is '{text:.40}'")))
    };
    let (line_skip, byte_skip) =
        (skip("line skip", 0)?.unsigned_abs(), skip("byte skip", i64::MIN)?);
    Ok(Data { element, endian, packing, line_skip, byte_skip, row, layers })
}

fn element(path: &Path, header: &Header) -> Result<Element, Error> {
    let name = header.need(path, "type")?.to_lowercase();
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

fn endian(path: &Path, header: &Header, element: Element) -> Result<Endian, Error> {
    if element.size() == 1 {
        return Ok(Endian::Little);
    }
    match header.need(path, "endian")?.to_lowercase().as_str() {
        "little" => Ok(Endian::Little),
        "big" => Ok(Endian::Big),
        other => Err(Error::header(path, format!("endian is '{other:.60}', not little or big"))),
    }
}

fn packing(path: &Path, header: &Header) -> Result<Packing, Error> {
    match header.need(path, "encoding")?.to_lowercase().as_str() {
        "raw" => Ok(Packing::Raw),
        "gzip" | "gz" => Ok(Packing::Gzip),
        "ascii" | "text" | "txt" => Ok(Packing::Decimal),
        "hex" => Ok(Packing::Hexadecimal),
        other => {
            let advice = "write it with encoding raw or gzip";
            Err(Error::unsupported(path, format!("the NRRD encoding '{other:.60}'"), advice))
        }
    }
}
