//! 3MF out: a ZIP archive with the model as XML, for printing.
//!
//! Format: 3MF core specification 1.3. Objects have a name and triangles, but no normals and no
//! numbers per vertex; the model has a unit.

use std::io::{self, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::mesh::part::{Part, Parts};
use crate::mesh::records::write_gathered;
use crate::mesh::xml::escaped;
use crate::mesh::{MeshOptions, Precision};

const CONTENT_TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\
</Types>\n";

const RELATIONSHIPS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
<Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" \
Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

/// Most bytes of text that a vertex and a triangle take: 17 digits with sign and exponent, 10 digits.
const VERTEX: u64 = 3 * 24 + 23;
const TRIANGLE: u64 = 3 * 10 + 29;

/// Says what keeps the parts from being a 3MF file.
pub(super) fn check(parts: Parts) -> Result<(), String> {
    let limit = i32::MAX as usize;
    match parts.iter().map(|part| part.mesh.vertices.len()).find(|count| *count > limit) {
        Some(count) => Err(format!("it has {count} vertices, 3MF at most {limit}; crop it")),
        None => Ok(()),
    }
}

pub(super) fn write(writer: &mut dyn Write, parts: Parts, options: &MeshOptions) -> io::Result<()> {
    let (vertices, triangles) = (parts.vertex_count() as u64, parts.triangle_count() as u64);
    let largest = 1000 * parts.iter().count() as u64 + VERTEX * vertices + TRIANGLE * triangles;
    // Larger files have headers that not every reader of ZIP knows.
    let model = SimpleFileOptions::default().large_file(largest > u64::from(u32::MAX));
    let mut archive = ZipWriter::new_stream(writer);
    for (name, text) in [("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        archive.start_file(name, SimpleFileOptions::default())?;
        archive.write_all(text.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", model)?;
    write_model(&mut archive, parts, options)?;
    archive.finish()?;
    Ok(())
}

fn write_model(writer: &mut dyn Write, parts: Parts, options: &MeshOptions) -> io::Result<()> {
    let (unit, factor) = unit(options.frame.as_ref().map_or("", |frame| &frame.unit));
    write!(
        writer,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{unit}\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n\
         <metadata name=\"Application\">shrouds {}</metadata>\n\
         <metadata name=\"Description\">{}</metadata>\n<resources>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(&options.comment())
    )?;
    // An object needs a triangle.
    let objects: Vec<(usize, &Part)> =
        (1..).zip(parts.iter()).filter(|(_, part)| has_area(part)).collect();
    for (id, part) in &objects {
        write!(writer, "<object id=\"{id}\" type=\"model\"")?;
        if !part.name.is_empty() {
            write!(writer, " name=\"{}\"", escaped(part.name))?;
        }
        writeln!(writer, "><mesh>\n<vertices>")?;
        write_gathered(writer, part.mesh.vertices.iter(), |vertex, text| {
            match options.precision {
                Precision::Single => put_vertex(text, vertex.map(|x| (factor * x) as f32)),
                Precision::Double => put_vertex(text, vertex.map(|x| factor * x)),
            }
        })?;
        writeln!(writer, "</vertices>\n<triangles>")?;
        let triangles = part.mesh.triangles.iter().filter(|triangle| is_triangle(triangle));
        write_gathered(writer, triangles, put_triangle)?;
        writeln!(writer, "</triangles>\n</mesh></object>")?;
    }
    writeln!(writer, "</resources>\n<build>")?;
    for (id, _) in &objects {
        writeln!(writer, "<item objectid=\"{id}\"/>")?;
    }
    writeln!(writer, "</build>\n</model>")
}

/// The unit of 3MF and the factor to it; millimetres where there is no such unit.
fn unit(name: &str) -> (&'static str, f64) {
    match name.to_lowercase().as_str() {
        "nm" | "nanometer" | "nanometre" => ("micron", 1e-3),
        "um" | "µm" | "μm" | "micron" | "micrometer" | "micrometre" => ("micron", 1.0),
        "cm" | "centimeter" | "centimetre" => ("centimeter", 1.0),
        "m" | "meter" | "metre" => ("meter", 1.0),
        "in" | "inch" => ("inch", 1.0),
        "ft" | "foot" => ("foot", 1.0),
        _ => ("millimeter", 1.0),
    }
}

/// 3MF forbids triangles that name a vertex twice.
fn is_triangle([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

fn has_area(part: &Part) -> bool {
    part.mesh.triangles.iter().any(is_triangle)
}

fn put_vertex(text: &mut Vec<u8>, place: [impl zmij::Float; 3]) {
    text.extend_from_slice(b"<vertex");
    for (name, number) in [" x=\"", " y=\"", " z=\""].into_iter().zip(place) {
        text.extend_from_slice(name.as_bytes());
        let mut digits = zmij::Buffer::new();
        let digits = digits.format(number);
        text.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
        text.push(b'"');
    }
    text.extend_from_slice(b"/>\n");
}

fn put_triangle(triangle: &[u32; 3], text: &mut Vec<u8>) {
    text.extend_from_slice(b"<triangle");
    for (name, index) in [" v1=\"", " v2=\"", " v3=\""].into_iter().zip(triangle) {
        text.extend_from_slice(name.as_bytes());
        text.extend_from_slice(itoa::Buffer::new().format(*index).as_bytes());
        text.push(b'"');
    }
    text.extend_from_slice(b"/>\n");
}
