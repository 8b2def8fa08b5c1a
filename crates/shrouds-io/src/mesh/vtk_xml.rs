//! VTK XML files of PolyData, with their arrays as raw binary data after the XML.
//!
//! Format: the VTK file formats guide, "XML file formats". In the header every array has its offset
//! in the appended data, where its bytes follow their number as a 64-bit integer. So the header is
//! made first, from the sizes of the arrays, and then each array is written in turn.

use std::io::{self, Write};

use crate::mesh::records::write_gathered;
use crate::mesh::{MeshOptions, Precision};

/// Type of the numbers of an array.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    Float32,
    Float64,
    Int32,
    Int64,
}

impl Kind {
    pub(super) fn of(precision: Precision) -> Self {
        match precision {
            Precision::Single => Self::Float32,
            Precision::Double => Self::Float64,
        }
    }

    /// Integers for numbers up to `largest`.
    pub(super) fn up_to(largest: usize) -> Self {
        if i32::try_from(largest).is_ok() { Self::Int32 } else { Self::Int64 }
    }

    fn size(self) -> usize {
        match self {
            Self::Float32 | Self::Int32 => 4,
            Self::Float64 | Self::Int64 => 8,
        }
    }

    /// Appends whole numbers that are not negative.
    pub(super) fn put<N: Into<u64>, const COUNT: usize>(
        self,
        numbers: [N; COUNT],
        bytes: &mut Vec<u8>,
    ) {
        for number in numbers {
            bytes.extend_from_slice(&number.into().to_le_bytes()[..self.size()]);
        }
    }
}

type WriteArray<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// An array of the file, with what writes its bytes.
pub(super) struct Array<'a> {
    name: &'a str,
    kind: Kind,
    components: usize,
    bytes: u64,
    write: Box<WriteArray<'a>>,
}

impl<'a> Array<'a> {
    /// An array of `count` tuples. `items` gives what `encode` appends the bytes of to a buffer.
    pub(super) fn new<I: Iterator>(
        name: &'a str,
        kind: Kind,
        [count, components]: [usize; 2],
        items: impl Fn() -> I + 'a,
        encode: impl Fn(I::Item, &mut Vec<u8>) + 'a,
    ) -> Self {
        let bytes = (count * components * kind.size()) as u64;
        let write = Box::new(move |writer: &mut dyn Write| {
            write_gathered(writer, items(), |item, bytes| encode(item, bytes))
        });
        Self { name, kind, components, bytes, write }
    }

    /// One number for each of `count` things.
    pub(super) fn numbers<I: Iterator<Item = &'a f32>>(
        name: &'a str,
        count: usize,
        numbers: impl Fn() -> I + 'a,
    ) -> Self {
        Self::new(name, Kind::Float32, [count, 1], numbers, |x, bytes| {
            bytes.extend_from_slice(&x.to_le_bytes());
        })
    }

    /// The positions of `count` points.
    pub(super) fn points<I: Iterator<Item = &'a [f64; 3]>>(
        count: usize,
        precision: Precision,
        points: impl Fn() -> I + 'a,
    ) -> Self {
        Self::new(
            "Points",
            Kind::of(precision),
            [count, 3],
            points,
            move |p, bytes| match precision {
                Precision::Single => {
                    bytes.extend_from_slice(p.map(|x| (x as f32).to_le_bytes()).as_flattened());
                }
                Precision::Double => {
                    bytes.extend_from_slice(p.map(f64::to_le_bytes).as_flattened());
                }
            },
        )
    }
}

/// An element of the header with its arrays.
pub(super) struct Section<'a> {
    pub(super) name: &'static str,
    pub(super) arrays: Vec<Array<'a>>,
}

/// Points, lines and polygons of a file.
pub(super) struct Counts {
    pub(super) points: usize,
    pub(super) lines: usize,
    pub(super) polygons: usize,
}

/// The frame of the file, where 3D Slicer looks for it.
pub(super) fn field_data(options: &MeshOptions) -> String {
    options.frame.as_ref().map_or(String::new(), |frame| {
        strings("SPACE", &[&frame.name]) + &strings("UNIT", &[&frame.unit])
    })
}

/// An array of texts: their bytes as numbers, each text with a 0 after it.
pub(super) fn strings(name: &str, texts: &[&str]) -> String {
    let bytes = texts.iter().flat_map(|text| text.bytes().filter(|byte| *byte != 0).chain([0]));
    let bytes: Vec<String> = bytes.map(|byte| byte.to_string()).collect();
    format!(
        "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{}\" format=\"ascii\">{}</Array>\n",
        texts.len(),
        bytes.join(" ")
    )
}

pub(super) fn write_file(
    writer: &mut dyn Write,
    counts: &Counts,
    field_data: &str,
    sections: &[Section],
) -> io::Result<()> {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- shrouds {} -->\n\
         <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n{field_data}</FieldData>\n\
         <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        env!("CARGO_PKG_VERSION"),
        counts.points,
        counts.lines,
        counts.polygons
    );
    let mut offset = 0;
    for Section { name, arrays } in sections {
        // What is called normals is to be taken for them.
        let normals = arrays.iter().any(|array| array.name == "Normals");
        let role = if normals { " Normals=\"Normals\"" } else { "" };
        text.push_str(&format!("<{name}{role}>\n"));
        for Array { name, kind, components, bytes, .. } in arrays {
            text.push_str(&format!(
                "<DataArray type=\"{kind:?}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                 format=\"appended\" offset=\"{offset}\"/>\n"
            ));
            offset += size_of::<u64>() as u64 + bytes;
        }
        text.push_str(&format!("</{name}>\n"));
    }
    text.push_str("</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
    writer.write_all(text.as_bytes())?;
    for array in sections.iter().flat_map(|section| &section.arrays) {
        writer.write_all(&array.bytes.to_le_bytes())?;
        (array.write)(writer)?;
    }
    writer.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}
