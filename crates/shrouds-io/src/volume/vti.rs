//! VTK image data, `.vti`: XML with arrays as text, base64 or raw bytes.
//!
//! Format: "VTK XML file formats" of the VTK documentation. Values stand at the points of the image
//! or in its cells; in either case they stand at the lattice points here, so that the lattice of
//! cells begins half a spacing beyond the origin.

use std::io::{self, BufReader};
use std::path::Path;
use std::str::FromStr;

use crate::error::Error;
use crate::pick::Pick;
use crate::stream::{Stream, open_file};
use crate::volume::decode::{Element, Elements, Endian};
use crate::volume::vti_data::{Base64, Lengths, UntilTag, behind_length, in_blocks};
use crate::volume::{Contents, Frame, Unread, VolumeOptions, affine_of, lattice};
use crate::xml::{Kind, Tag, Tags};

/// Where the values of an array stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Points,
    Cells,
}

/// Where the bytes of an array are, counted from the start of the file.
#[derive(Debug, Clone, Copy)]
enum Source {
    Ascii(u64),
    Inline(u64),
    /// Counted from the start of the appended data.
    Appended(u64),
}

/// An array of numbers.
struct Array {
    name: String,
    place: Place,
    type_name: String,
    components: usize,
    source: Option<Source>,
}

/// What the tags of a file say.
struct Header {
    lengths: Lengths,
    compressor: Option<String>,
    /// The place of the image in the world.
    image: Tag,
    /// First and last point along x, y, z of the one piece.
    extent: [i64; 6],
    arrays: Vec<Array>,
    /// Names of the arrays that the file calls its scalars, of points and of cells.
    scalars: [Option<String>; 2],
    /// Start of the appended data, and whether it is base64.
    appended: Option<(u64, bool)>,
}

pub(super) fn open<'a>(path: &'a Path, options: &VolumeOptions<'a>) -> Result<Unread<'a>, Error> {
    let header = read_header(path)?;
    let names = header.names();
    let array = header.choose(path, &names, options.array)?;
    let (dims, affine) = header.placement(path, array.place)?;
    let frame = Frame::new("unnamed", "unknown", "ImageData");
    let (grid, frame) = lattice(path, dims, affine, frame, options)?;
    let element = element(path, &array.type_name)?;
    let (points, components) = (grid.point_count(), array.components);
    let bytes = |count: &usize| count.checked_mul(element.size()).is_some();
    let Some(count) = points.checked_mul(components).filter(bytes) else {
        let problem = format!("{points} points of {components} components");
        return Err(Error::header(path, problem));
    };
    let (stream, endian) = header.stream(path, array, element, count, options)?;
    // The components of a point follow each other.
    let layer = options.layer.filter(|layer| *layer < components).unwrap_or(0);
    let [size, layer, period] = [1, layer, components].map(|n| (n * element.size()) as u64);
    let stream = if components == 1 {
        stream
    } else {
        stream.picked(Pick { period, from: layer, to: layer + size, periods: points as u64 })
    };
    let slabs = Box::new(Elements::new(stream, element, endian, points, dims[0]));
    let contents = Contents {
        layers: components,
        arrays: if names.len() > 1 { names } else { Vec::new() },
        ..Contents::default()
    };
    Ok(Unread { grid, frame, contents, slabs, z_fastest: false, scaling: None })
}

impl Header {
    /// What to call each array: its name, with its place before it where two have the same.
    fn names(&self) -> Vec<String> {
        let twice = |name: &str| self.arrays.iter().filter(|other| other.name == name).count() > 1;
        let name = |array: &Array| match array.place {
            Place::Points if twice(&array.name) => format!("PointData/{}", array.name),
            Place::Cells if twice(&array.name) => format!("CellData/{}", array.name),
            _ => array.name.clone(),
        };
        self.arrays.iter().map(name).collect()
    }

    /// The array of this name; else the only one, else the scalars of the points, else of the cells.
    fn choose(&self, path: &Path, names: &[String], wanted: Option<&str>) -> Result<&Array, Error> {
        let scalars = |place: Place| {
            let name = self.scalars[place as usize].as_ref()?;
            self.arrays.iter().find(|array| array.place == place && array.name == *name)
        };
        let array = match (wanted, self.arrays.as_slice()) {
            (_, []) => {
                let what = "VTK image data without any array of numbers";
                return Err(Error::unsupported(path, what, "write it with its point or cell data"));
            }
            (Some(wanted), all) => {
                names.iter().zip(all).find(|(name, _)| *name == wanted).map(|(_, array)| array)
            }
            (None, [only]) => Some(only),
            (None, _) => scalars(Place::Points).or_else(|| scalars(Place::Cells)),
        };
        array.ok_or_else(|| {
            let choices = format!("the arrays {}", names.join(", "));
            Error::Choice { path: path.into(), choices }
        })
    }

    /// Dimensions and index-to-world map of the points, or of the centres of the cells.
    fn placement(&self, path: &Path, place: Place) -> Result<([usize; 3], [[f64; 4]; 3]), Error> {
        let image = &self.image;
        let origin = numbers_or(path, image, "Origin", [0.0; 3])?;
        let spacing = numbers_or(path, image, "Spacing", [1.0; 3])?;
        let turn =
            numbers_or(path, image, "Direction", [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
        let columns =
            std::array::from_fn(|c| std::array::from_fn(|r| turn[3 * r + c] * spacing[c]));
        let (mut dims, mut start) = ([0; 3], [0.0; 3]);
        for axis in 0..3 {
            let (first, last) = (self.extent[2 * axis], self.extent[2 * axis + 1]);
            let length =
                last.checked_sub(first).filter(|length| *length >= 0).ok_or_else(|| {
                    Error::header(path, format!("the extent {:?} holds no points", self.extent))
                })?;
            // A flat image has one layer of cells, in its plane.
            let cells = place == Place::Cells && length > 0;
            dims[axis] = (length as usize).saturating_add(usize::from(!cells));
            start[axis] = first as f64 + if cells { 0.5 } else { 0.0 };
        }
        let affine: [[f64; 4]; 3] = affine_of(columns, origin);
        let corner = affine.map(|row| (0..3).map(|c| row[c] * start[c]).sum::<f64>() + row[3]);
        Ok((dims, affine_of(columns, corner)))
    }

    /// The bytes of an array, and their order.
    fn stream<'a>(
        &self,
        path: &'a Path,
        array: &Array,
        element: Element,
        count: usize,
        options: &VolumeOptions<'a>,
    ) -> Result<(Stream<'a>, Endian), Error> {
        let from = |start| Stream::open_range(path, start, u64::MAX, options.progress);
        let missing = || {
            Error::header(path, format!("the array '{:.60}' has no data that is found", array.name))
        };
        let stream = match (array.source.ok_or_else(missing)?, self.appended) {
            (Source::Ascii(start), _) => {
                let stream = from(start)?;
                let most = stream.most();
                let text = stream.through("text", most, UntilTag::new);
                let parse = move |number: &str| element.parse(number);
                return Ok((text.decimals(element.size(), parse), Endian::Little));
            }
            (Source::Inline(start), _) => decoded(from(start)?),
            (Source::Appended(_), None) => return Err(missing()),
            (Source::Appended(offset), Some((start, encoded))) => {
                let stream = from(start.saturating_add(offset))?;
                if encoded { decoded(stream) } else { stream }
            }
        };
        let expected = (count as u64).saturating_mul(element.size() as u64);
        let stream = match self.compressor.as_deref() {
            None => behind_length(stream, self.lengths, expected),
            Some("vtkZLibDataCompressor") => in_blocks(stream, self.lengths, expected),
            Some(other) => {
                let what = format!("VTK data compressed by {other:.40}");
                Err(Error::unsupported(path, what, "write it with zlib, or uncompressed"))
            }
        }?;
        Ok((stream, self.lengths.endian))
    }
}

/// From here on the bytes are base64.
fn decoded(stream: Stream) -> Stream {
    let most = stream.most();
    stream.through("base64", most, Base64::new)
}

fn read_header(path: &Path) -> Result<Header, Error> {
    let (file, _) = open_file(path)?;
    let mut tags = Tags::new(BufReader::new(file));
    let failed = |cause: io::Error| match cause.kind() {
        io::ErrorKind::InvalidData => Error::header(path, cause.to_string()),
        _ => Error::Io { path: path.into(), doing: "read it", cause, advice: "check the disk" },
    };
    let foreign = || Error::Content {
        path: path.into(),
        expected: "VTK image data",
        advice: "check the extension, or write it with vtkXMLImageDataWriter",
    };
    let file = tags.next().map_err(|_| foreign())?.filter(|tag| tag.name == "VTKFile");
    let file = file.filter(|tag| tag.get("type") == Some("ImageData")).ok_or_else(foreign)?;
    let mut header = Header {
        lengths: lengths(path, &file)?,
        compressor: file.get("compressor").filter(|name| !name.is_empty()).map(str::to_string),
        image: file,
        extent: [0; 6],
        arrays: Vec::new(),
        scalars: [None, None],
        appended: None,
    };
    let (mut place, mut pieces, mut ended) = (None, 0, 0);
    while let Some(tag) = tags.next().map_err(failed)? {
        match (tag.name.as_str(), tag.kind) {
            ("PointData" | "CellData", Kind::End) => place = None,
            ("Piece", Kind::End) => ended += 1,
            (_, Kind::End) => {}
            ("ImageData", _) => {
                header.extent = numbers(path, &tag, "WholeExtent")?;
                header.image = tag;
            }
            ("Piece", _) => {
                pieces += 1;
                header.extent = numbers(path, &tag, "Extent")?;
            }
            (name @ ("PointData" | "CellData"), kind) => {
                let here = if name == "PointData" { Place::Points } else { Place::Cells };
                header.scalars[here as usize] = tag.get("Scalars").map(str::to_string);
                place = Some(here).filter(|_| kind == Kind::Begin);
            }
            ("DataArray", _) => {
                if let Some(place) = place {
                    header.arrays.extend(array(path, &tag, place, tags.position())?);
                }
            }
            ("AppendedData", _) => {
                let encoded = tag.get("encoding") != Some("raw");
                if !tags.skip_past(b'_').map_err(failed)? {
                    return Err(Error::header(path, "the appended data is missing"));
                }
                header.appended = Some((tags.position(), encoded));
                // Raw bytes are no XML, and nothing follows them.
                break;
            }
            _ => {}
        }
    }
    if ended < pieces || pieces == 0 {
        return Err(Error::header(path, "the file ends before its piece does"));
    }
    if pieces == 1 {
        return Ok(header);
    }
    let what = format!("VTK image data in {pieces} pieces");
    Err(Error::unsupported(
        path,
        what,
        "write it as one piece, for example with vtkXMLImageDataWriter",
    ))
}

fn lengths(path: &Path, file: &Tag) -> Result<Lengths, Error> {
    let endian = match file.get("byte_order") {
        Some("BigEndian") => Endian::Big,
        Some("LittleEndian") | None => Endian::Little,
        Some(other) => return Err(Error::header(path, format!("byte_order is '{other:.40}'"))),
    };
    let wide = match file.get("header_type") {
        Some("UInt64") => true,
        Some("UInt32") | None => false,
        Some(other) => return Err(Error::header(path, format!("header_type is '{other:.40}'"))),
    };
    Ok(Lengths { endian, wide })
}

/// The array of a tag that ends at byte `position`; `None` if it holds no numbers of the image.
fn array(path: &Path, tag: &Tag, place: Place, position: u64) -> Result<Option<Array>, Error> {
    let name = tag.get("Name").unwrap_or("unnamed").to_string();
    let type_name = tag.get("type").unwrap_or_default().to_string();
    if type_name == "String" || name == "vtkGhostType" {
        return Ok(None);
    }
    let components = match tag.get("NumberOfComponents") {
        None => 1,
        Some(text) => text.trim().parse().ok().filter(|n| *n > 0).ok_or_else(|| {
            Error::header(path, format!("the array '{name:.60}' has '{text:.20}' components"))
        })?,
    };
    let source = match tag.get("format") {
        Some("appended") => {
            let offset = tag.get("offset").and_then(|offset| offset.trim().parse().ok());
            offset.map(Source::Appended)
        }
        Some("binary") => Some(Source::Inline(position)),
        Some("ascii") | None => Some(Source::Ascii(position)),
        Some(_) => None,
    };
    Ok(Some(Array { name, place, type_name, components, source }))
}

fn element(path: &Path, name: &str) -> Result<Element, Error> {
    Ok(match name {
        "UInt8" => Element::U8,
        "Int8" => Element::I8,
        "UInt16" => Element::U16,
        "Int16" => Element::I16,
        "UInt32" => Element::U32,
        "Int32" => Element::I32,
        "UInt64" => Element::U64,
        "Int64" => Element::I64,
        "Float32" => Element::F32,
        "Float64" => Element::F64,
        _ => {
            let advice = "convert it to an integer or float type";
            return Err(Error::unsupported(path, format!("the VTK type '{name:.40}'"), advice));
        }
    })
}

/// The numbers of an attribute, which must be there.
fn numbers<T: FromStr, const N: usize>(
    path: &Path,
    tag: &Tag,
    name: &str,
) -> Result<[T; N], Error> {
    let text = tag.get(name).unwrap_or_default();
    let numbers: Option<Vec<T>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        Error::header(path, format!("{name} of {} is '{text:.80}', not {N} numbers", tag.name))
    })
}

/// The same, with what it means not to give them.
fn numbers_or<const N: usize>(
    path: &Path,
    tag: &Tag,
    name: &str,
    default: [f64; N],
) -> Result<[f64; N], Error> {
    if tag.get(name).is_none() { Ok(default) } else { numbers(path, tag, name) }
}
