//! NumPy arrays, `.npy` versions 1 to 3.
//!
//! Format: NumPy Enhancement Proposal 1. The header is a Python dictionary of three entries.

use std::io::{self, Write};
use std::path::Path;

use shrouds::Occupancy;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::stream::Stream;
use crate::volume::decode::{Element, Elements, Endian};
use crate::volume::write::{Data, write_bytes};
use crate::volume::{Axes, Contents, Frame, Unread, VolumeOptions, affine_of, diagonal, lattice};

const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// Longest header that is read: NumPy itself stops at 10 000 bytes.
const MAX_HEADER: usize = 1 << 16;

pub(super) struct Header {
    element: Element,
    endian: Endian,
    fortran_order: bool,
    /// Without a batch or channel axis of length 1 beyond three axes.
    pub(super) shape: Vec<usize>,
}

pub(super) fn open<'a>(
    mut stream: Stream<'a>,
    options: &VolumeOptions,
) -> Result<Unread<'a>, Error> {
    let path = stream.path;
    let header = read_header(&mut stream)?;
    // Memory order is x fastest when the last axis in a C array, or the first in a Fortran array,
    // is x; else it is z fastest.
    let [a, b, c] = header.shape.as_slice().try_into().map_err(|_| {
        let what = format!("an array of shape {:?}", header.shape);
        let advice = "give an array of three dimensions: take one channel, or use array[None] for a single slice";
        Error::unsupported(path, what, advice)
    })?;
    let dims = if options.axes == Axes::Zyx { [c, b, a] } else { [a, b, c] };
    let x_fastest = header.fortran_order == (options.axes == Axes::Xyz);
    let frame = Frame::new("index", "unknown", "none");
    let affine = affine_of(diagonal([1.0; 3]), [0.0; 3]);
    let (grid, frame) = lattice(path, dims, affine, frame, options)?;
    let (element, endian, count) = (header.element, header.endian, grid.point_count());
    let row = if x_fastest { dims[0] } else { dims[2] };
    let slabs = Box::new(Elements::new(stream, element, endian, count, row));
    let contents = Contents::default();
    Ok(Unread { grid, frame, contents, slabs, z_fastest: !x_fastest, scaling: None })
}

/// Writes a volume as a `uint8` array of 0 and 1, indexed `[z, y, x]` in C order. The frame of the
/// grid is not part of the format and is lost.
///
/// # Errors
/// As for [`write_atomically`].
pub fn write_npy(path: impl AsRef<Path>, volume: &Occupancy) -> Result<(), Error> {
    write_array(path, "|u1", volume.grid().dims(), |writer| write_bytes(volume, writer))
}

/// Writes values as an array indexed `[z, y, x]` in C order.
pub(super) fn write(path: &Path, data: &Data) -> Result<(), Error> {
    write_array(path, data.element.npy, data.grid.dims(), |writer| (data.write)(writer))
}

/// Writes a header and the values that `write` writes.
fn write_array(
    path: impl AsRef<Path>,
    element: &str,
    [nx, ny, nz]: [usize; 3],
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    let mut header =
        format!("{{'descr': '{element}', 'fortran_order': False, 'shape': ({nz}, {ny}, {nx}), }}");
    // The data starts at a multiple of 64 bytes: 10 before the header, a line feed after it.
    let padding = 63 - (header.len() + 10) % 64;
    header.push_str(&" ".repeat(padding));
    header.push('\n');
    write_atomically(path, |writer| {
        writer.write_all(MAGIC)?;
        writer.write_all(&[1, 0])?;
        writer.write_all(&(header.len() as u16).to_le_bytes())?;
        writer.write_all(header.as_bytes())?;
        write(writer)
    })
}

pub(super) fn read_header(stream: &mut Stream) -> Result<Header, Error> {
    let path = stream.path;
    let damaged = |problem: &str| Error::header(path, problem);
    let mut start = [0; 8];
    let found = stream.fill(&mut start)?;
    if &start[..6] != MAGIC {
        let advice = "check the extension, or save it with numpy.save";
        return Err(Error::Content { path: path.into(), expected: "a NumPy array", advice });
    }
    let mut length = [0; 4];
    let width = match start[6] {
        1 => 2,
        2 | 3 => 4,
        _ if found < 8 => return Err(damaged("the file ends inside it")),
        version => return Err(damaged(&format!("the version is {version}, not 1, 2 or 3"))),
    };
    let complete = stream.fill(&mut length[..width])? == width;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_HEADER {
        return Err(damaged(&format!("its length is {length}, more than {MAX_HEADER}")));
    }
    let mut text = vec![0; length];
    if !complete || stream.fill(&mut text)? < length {
        return Err(damaged("the file ends inside it"));
    }
    parse_header(path, &String::from_utf8_lossy(&text))
}

fn parse_header(path: &Path, text: &str) -> Result<Header, Error> {
    let entry = |key: &str| {
        value_of(text, key).ok_or_else(|| Error::header(path, format!("it has no {key}")))
    };
    let (element, endian) = parse_type(path, entry("descr")?)?;
    let order = entry("fortran_order")?;
    let fortran_order = match order {
        _ if order.starts_with("True") => true,
        _ if order.starts_with("False") => false,
        _ => return Err(Error::header(path, "fortran_order is neither True nor False")),
    };
    let mut shape = parse_shape(path, entry("shape")?)?;
    while shape.len() > 3 && shape.last() == Some(&1) {
        shape.pop();
    }
    let surplus = shape.iter().take(shape.len().saturating_sub(3)).take_while(|n| **n == 1).count();
    shape.drain(..surplus);
    Ok(Header { element, endian, fortran_order, shape })
}

/// What follows `'key':` in the dictionary.
fn value_of<'t>(text: &'t str, key: &str) -> Option<&'t str> {
    let (_, rest) = text.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

fn parse_type(path: &Path, value: &str) -> Result<(Element, Endian), Error> {
    let advice = "save it as an array of one integer, float or bool type";
    let Some((name, _)) = value.strip_prefix('\'').and_then(|rest| rest.split_once('\'')) else {
        return Err(Error::unsupported(path, "an array of records", advice));
    };
    let endian = match name.chars().next() {
        Some('>') => Endian::Big,
        _ => Endian::Little,
    };
    let element = match name.trim_start_matches(['<', '>', '|', '=']) {
        "b1" => Element::Bool,
        "u1" => Element::U8,
        "i1" => Element::I8,
        "u2" => Element::U16,
        "i2" => Element::I16,
        "u4" => Element::U32,
        "i4" => Element::I32,
        "u8" => Element::U64,
        "i8" => Element::I64,
        "f2" => Element::F16,
        "f4" => Element::F32,
        "f8" => Element::F64,
        _ => return Err(Error::unsupported(path, format!("the NumPy type '{name}'"), advice)),
    };
    Ok((element, endian))
}

fn parse_shape(path: &Path, value: &str) -> Result<Vec<usize>, Error> {
    let damaged = || Error::header(path, "the shape is not a tuple of whole numbers");
    let inside = value.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let (inside, _) = inside.ok_or_else(damaged)?;
    let numbers = inside.split(',').map(str::trim).filter(|number| !number.is_empty());
    let shape: Result<_, _> = numbers.map(|number| number.trim_end_matches('L').parse()).collect();
    shape.map_err(|_| damaged())
}
