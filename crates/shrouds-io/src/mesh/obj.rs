//! Wavefront OBJ: text, out and in. What is read passes over materials,
//! textures, groups and curves.

use std::io::{self, Write};
use std::path::Path;

use shrouds::TriMesh;

use crate::error::Error;
use crate::mesh::part::Parts;
use crate::mesh::records::write_gathered;
use crate::mesh::{Line, MeshOptions, Precision, push_fan};

pub(super) fn write(writer: &mut dyn Write, parts: Parts, options: &MeshOptions) -> io::Result<()> {
    writeln!(writer, "# {}", options.comment())?;
    let with_normals = parts.have_normals();
    for (first, part) in parts.counted() {
        if !part.name.is_empty() {
            let name = part.name.replace(|c: char| c.is_whitespace() || c.is_control(), "_");
            // Some programs tell parts apart by o, others by g.
            writeln!(writer, "o {name}\ng {name}")?;
        }
        let vertices = part.mesh.vertices.iter();
        match options.precision {
            Precision::Single => write_gathered(writer, vertices, |v, text| {
                put_line(text, b"v", v.map(|x| x as f32))
            }),
            Precision::Double => {
                write_gathered(writer, vertices, |v, text| put_line(text, b"v", *v))
            }
        }?;
        if with_normals {
            write_gathered(writer, part.mesh.normals.iter(), |n, text| put_line(text, b"vn", *n))?;
        }
        write_faces(writer, &part.mesh.triangles, first, with_normals)?;
    }
    Ok(())
}

fn write_faces(
    writer: &mut dyn Write,
    triangles: &[[u32; 3]],
    first: u32,
    with_normals: bool,
) -> io::Result<()> {
    write_gathered(writer, triangles.iter(), |triangle, text| {
        text.push(b'f');
        for index in triangle {
            let mut digits = itoa::Buffer::new();
            let digits = digits.format(u64::from(first + *index) + 1).as_bytes();
            text.push(b' ');
            text.extend_from_slice(digits);
            if with_normals {
                text.extend_from_slice(b"//");
                text.extend_from_slice(digits);
            }
        }
        text.push(b'\n');
    })
}

pub(super) fn write_lines(
    writer: &mut dyn Write,
    lines: &[Line],
    options: &MeshOptions,
) -> io::Result<()> {
    writeln!(writer, "# {}", options.comment())?;
    let points = lines.iter().flat_map(|line| line.points);
    write_gathered(writer, points, |p, text| match options.precision {
        Precision::Single => put_line(text, b"v", p.map(|x| x as f32)),
        Precision::Double => put_line(text, b"v", *p),
    })?;
    let mut first = 1;
    for line in lines.iter().filter(|line| !line.points.is_empty()) {
        write!(writer, "l")?;
        for index in line.indices(first) {
            write!(writer, " {index}")?;
        }
        writeln!(writer)?;
        first += line.points.len() as u64;
    }
    Ok(())
}

/// Appends a line of three numbers, each with the fewest digits that read back as the same one.
fn put_line(text: &mut Vec<u8>, kind: &[u8], numbers: [impl zmij::Float; 3]) {
    text.extend_from_slice(kind);
    for number in numbers {
        let mut digits = zmij::Buffer::new();
        let digits = digits.format(number).as_bytes();
        text.push(b' ');
        text.extend_from_slice(digits.strip_suffix(b".0").unwrap_or(digits));
    }
    text.push(b'\n');
}

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<TriMesh, Error> {
    if bytes.contains(&0) {
        let advice = "check the extension, or write it again as .obj";
        return Err(Error::Content { path: path.into(), expected: "an OBJ mesh", advice });
    }
    parse(&String::from_utf8_lossy(bytes)).map_err(|problem| Error::mesh(path, problem))
}

fn parse(text: &str) -> Result<TriMesh, String> {
    let mut mesh = TriMesh::default();
    // Normals belong to vertices only if every corner names the normal of its own number.
    let (mut own_normals, mut corners) = (true, Vec::new());
    for (number, line) in text.lines().enumerate() {
        let at = |problem: String| format!("line {}: {problem}", number + 1);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => mesh.vertices.push(point(words).map_err(at)?),
            Some("vn") => mesh.normals.push(point(words).map_err(at)?.map(|x| x as f32)),
            Some("f") => {
                corners.clear();
                for word in words {
                    let (vertex, normal) = corner(word, &mesh).map_err(at)?;
                    own_normals &= normal == Some(vertex);
                    corners.push(vertex);
                }
                push_fan(&mut mesh.triangles, &corners)
                    .map_err(|problem| at(format!("the face {problem}")))?;
            }
            _ => {}
        }
    }
    if !own_normals || mesh.normals.len() != mesh.vertices.len() {
        mesh.normals.clear();
    }
    Ok(mesh)
}

fn point<'t>(words: impl Iterator<Item = &'t str>) -> Result<[f64; 3], String> {
    let values: Option<Vec<f64>> = words.take(3).map(|word| word.parse().ok()).collect();
    values.and_then(|values| values.try_into().ok()).ok_or_else(|| "not three numbers".to_string())
}

/// Vertex and normal of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
fn corner(word: &str, mesh: &TriMesh) -> Result<(u32, Option<u32>), String> {
    let mut parts = word.split('/');
    let index = |part: Option<&str>, count| resolve(part?, count);
    let vertex = index(parts.next(), mesh.vertices.len());
    let normal = index(parts.nth(1), mesh.normals.len());
    vertex.map(|vertex| (vertex, normal)).ok_or_else(|| format!("'{word:.40}' names no vertex"))
}

/// Indices count from 1, or backwards from -1, the one defined last.
fn resolve(part: &str, count: usize) -> Option<u32> {
    let index: i64 = part.parse().ok()?;
    let index = if index < 0 { count as i64 + index } else { index - 1 };
    u32::try_from(index).ok()
}
