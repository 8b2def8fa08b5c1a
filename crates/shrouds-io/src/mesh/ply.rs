//! PLY out: binary, little endian, all parts in one list of vertices and one of faces.

use std::io::{self, Write};

use shrouds::TriMesh;

use crate::mesh::part::{Part, Parts};
use crate::mesh::records::{put, write_fixed, write_records};
use crate::mesh::{MeshOptions, Precision};

/// How the label of a vertex is stored; PLY has no integers of more than 32 bits.
#[derive(Clone, Copy)]
enum Label {
    Int(i32),
    Double(f64),
}

/// Largest whole number up to which 64-bit floats hold all.
const WHOLE: u64 = 1 << 53;

/// A file that is ready to be written.
pub(super) struct Ply<'a> {
    parts: Parts<'a>,
    options: &'a MeshOptions,
    with_normals: bool,
    /// One for each part, all of one type; empty for none.
    labels: Vec<Label>,
}

impl<'a> Ply<'a> {
    /// Says what keeps the parts from being a PLY file.
    pub(super) fn new(parts: Parts<'a>, options: &'a MeshOptions) -> Result<Self, String> {
        let labels = parts.labels().unwrap_or_default();
        if let Some(label) = labels.iter().find(|label| label.unsigned_abs() > WHOLE) {
            return Err(format!("the label {label} is too large for PLY; write .vtp instead"));
        }
        let ints: Result<Vec<i32>, _> = labels.iter().map(|label| i32::try_from(*label)).collect();
        let labels = match ints {
            Ok(ints) => ints.into_iter().map(Label::Int).collect(),
            Err(_) => labels.into_iter().map(|label| Label::Double(label as f64)).collect(),
        };
        Ok(Self { parts, options, with_normals: parts.have_normals(), labels })
    }

    pub(super) fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        writer.write_all(self.header().as_bytes())?;
        for (n, part) in self.parts.iter().enumerate() {
            self.write_vertices(writer, part, self.labels.get(n).copied())?;
        }
        for (first, part) in self.parts.counted() {
            let triangles = part.mesh.triangles.iter();
            write_fixed(writer, triangles, |triangle, record: &mut [u8; 13]| {
                record[0] = 3;
                put(&mut record[1..], triangle.map(|v| (first + v).to_le_bytes()).as_flattened());
            })?;
        }
        Ok(())
    }

    fn write_vertices(
        &self,
        writer: &mut dyn Write,
        part: &Part,
        label: Option<Label>,
    ) -> io::Result<()> {
        let numbers = if self.with_normals { 6 } else { 3 };
        let float = match self.options.precision {
            Precision::Single => 4,
            Precision::Double => 8,
        };
        let label_size = label.map_or(0, |label| label.bytes().1);
        let size = numbers * float + 4 * part.attributes.len() + label_size;
        write_records(writer, size, 0..part.mesh.vertices.len(), |v, record| {
            let mut rest = self.put(record, part.mesh.vertices[v]);
            if self.with_normals {
                rest = self.put(rest, part.mesh.normals[v].map(f64::from));
            }
            for attribute in part.attributes {
                rest = put(rest, &attribute.values[v].to_le_bytes());
            }
            if let Some((bytes, size)) = label.map(Label::bytes) {
                put(rest, &bytes[..size]);
            }
        })
    }

    /// Puts three numbers at the beginning of a record; what follows them.
    fn put<'r>(&self, record: &'r mut [u8], numbers: [f64; 3]) -> &'r mut [u8] {
        match self.options.precision {
            Precision::Single => {
                put(record, numbers.map(|x| (x as f32).to_le_bytes()).as_flattened())
            }
            Precision::Double => put(record, numbers.map(f64::to_le_bytes).as_flattened()),
        }
    }

    fn header(&self) -> String {
        let label = self.labels.first().map(|label| match label {
            Label::Int(_) => ("int", "label"),
            Label::Double(_) => ("double", "label"),
        });
        let attributes = self.parts.attribute_names().map(|name| ("float", name));
        let more: Vec<_> = attributes.chain(label).collect();
        let counts = [self.parts.vertex_count(), self.parts.triangle_count()];
        header(counts.map(|count| count as u64), self.with_normals, &more, self.options)
    }
}

/// The header of a file with so many vertices and triangles, and further properties of the vertices
/// with their types.
fn header(
    [vertices, triangles]: [u64; 2],
    with_normals: bool,
    more: &[(&str, &str)],
    options: &MeshOptions,
) -> String {
    let float = match options.precision {
        Precision::Single => "float",
        Precision::Double => "double",
    };
    let numbers: &[&str] =
        if with_normals { &["x", "y", "z", "nx", "ny", "nz"] } else { &["x", "y", "z"] };
    let numbers = numbers.iter().map(|name| (float, *name));
    let properties: String = numbers
        .chain(more.iter().copied())
        .map(|(kind, name)| format!("property {kind} {name}\n"))
        .collect();
    // Everybody reads int; uint only where it must be.
    let index = if vertices > i32::MAX as u64 { "uint" } else { "int" };
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {vertices}\n\
         {properties}element face {triangles}\nproperty list uchar {index} vertex_indices\nend_header\n",
        options.comment(),
    )
}

/// What a file begins with whose vertices with their normals, and whose triangles, are written elsewhere.
pub(crate) fn header_of_parts(counts: [u64; 2], options: &MeshOptions) -> String {
    header(counts, true, &[], options)
}

/// The bytes of the first `count` vertices of a mesh with normals.
pub(crate) fn vertex_bytes(mesh: &TriMesh, count: usize, options: &MeshOptions) -> Vec<u8> {
    let numbers = mesh.vertices.iter().zip(&mesh.normals).take(count);
    let numbers =
        numbers.flat_map(|(place, normal)| place.iter().copied().chain(normal.map(f64::from)));
    match options.precision {
        Precision::Single => numbers.flat_map(|x| (x as f32).to_le_bytes()).collect(),
        Precision::Double => numbers.flat_map(f64::to_le_bytes).collect(),
    }
}

/// The bytes of triangles.
pub(crate) fn face_bytes(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<u8> {
    let record = |triangle: [u32; 3]| {
        let mut record = [3; 13];
        put(&mut record[1..], triangle.map(u32::to_le_bytes).as_flattened());
        record
    };
    triangles.flat_map(record).collect()
}

impl Label {
    /// Its bytes, and how many of them count.
    fn bytes(self) -> ([u8; 8], usize) {
        match self {
            Self::Int(label) => (i64::from(label).to_le_bytes(), 4),
            Self::Double(label) => (label.to_le_bytes(), 8),
        }
    }
}
