//! PLY in: text and binary of both byte orders, any properties in any order.
//!
//! Format: Greg Turk's "The PLY Polygon File Format". A header names elements and their properties;
//! the data follows in that order.

use std::path::Path;

use shrouds::TriMesh;
use shrouds::materials::MaterialMesh;

use crate::error::Error;
use crate::mesh::push_fan;

/// Type of a number in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// One property of an element; a list has a type for its length.
struct Property {
    name: String,
    number: Number,
    length: Option<Number>,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Text,
    Little,
    Big,
}

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<TriMesh, Error> {
    if !(bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")) {
        let advice = "check the extension, or write it again as .ply";
        return Err(Error::Content { path: path.into(), expected: "a PLY mesh", advice });
    }
    Ok(parsed(path, bytes)?.surface)
}

/// Whether the header, of which these are the first bytes, says that every face has two labels.
pub(super) fn has_labels(bytes: &[u8]) -> bool {
    let mut cursor = Cursor { bytes, at: 0, encoding: Encoding::Text };
    let Ok((_, elements)) = header(&mut cursor) else { return false };
    let faces = elements.iter().find(|element| element.name == "face");
    let has = |name| {
        let of_name = |p: &Property| p.name == name && p.length.is_none();
        faces.is_some_and(|faces| faces.properties.iter().any(of_name))
    };
    has("first") && has("second")
}

/// The mesh, with the labels of its faces and its edges if it has some.
pub(super) fn parsed(path: &Path, bytes: &[u8]) -> Result<MaterialMesh, Error> {
    parse(bytes).map_err(|mut problem| {
        if !bytes.ends_with(b"\n") && problem.starts_with("it ends") {
            problem.push_str(" (in a text file that is complete, the last line must end too)");
        }
        Error::mesh(path, problem)
    })
}

fn parse(bytes: &[u8]) -> Result<MaterialMesh, String> {
    let mut cursor = Cursor { bytes, at: 0, encoding: Encoding::Text };
    let (encoding, elements) = header(&mut cursor)?;
    cursor.encoding = encoding;
    let mut mesh = MaterialMesh::default();
    for element in &elements {
        match element.name.as_str() {
            "vertex" => vertices(&mut cursor, element, &mut mesh.surface)?,
            "face" => faces(&mut cursor, element, &mut mesh)?,
            "edge" => edges(&mut cursor, element, &mut mesh)?,
            "tristrips" => return Err("it has triangle strips, which are not read".into()),
            _ => skip(&mut cursor, element)?,
        }
    }
    Ok(mesh)
}

fn header(cursor: &mut Cursor) -> Result<(Encoding, Vec<Element>), String> {
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    loop {
        let line = cursor.line().ok_or("the header has no end_header")?;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["end_header"] => break,
            ["format", "ascii", _] => encoding = Some(Encoding::Text),
            ["format", "binary_little_endian", _] => encoding = Some(Encoding::Little),
            ["format", "binary_big_endian", _] => encoding = Some(Encoding::Big),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| format!("'{line}' has no count"))?;
                elements.push(Element { name: (*name).into(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] => {
                let element = elements.last_mut().ok_or("a property comes before its element")?;
                let property = property(rest).ok_or_else(|| format!("'{line}' is not known"))?;
                element.properties.push(property);
            }
            [] | ["ply" | "comment" | "obj_info", ..] => {}
            _ => return Err(format!("the header line '{line:.60}' is not known")),
        }
    }
    Ok((encoding.ok_or("the header names no format")?, elements))
}

fn property(words: &[&str]) -> Option<Property> {
    let (length, number, name) = match words {
        ["list", length, number, name] => (Some(number_type(length)?), number, name),
        [number, name] => (None, number, name),
        _ => return None,
    };
    Some(Property { name: (*name).into(), number: number_type(number)?, length })
}

fn number_type(name: &str) -> Option<Number> {
    Some(match name {
        "char" | "int8" => Number::I8,
        "uchar" | "uint8" => Number::U8,
        "short" | "int16" => Number::I16,
        "ushort" | "uint16" => Number::U16,
        "int" | "int32" => Number::I32,
        "uint" | "uint32" => Number::U32,
        "float" | "float32" => Number::F32,
        "double" | "float64" => Number::F64,
        _ => return None,
    })
}

/// Which of the wanted names each property of an element is.
fn roles(element: &Element, names: &[&str]) -> Result<Vec<Option<usize>>, String> {
    if element.properties.is_empty() && element.count > 0 {
        return Err(format!("the element {} has no properties", element.name));
    }
    let role = |p: &Property| names.iter().position(|name| *name == p.name);
    Ok(element.properties.iter().map(role).collect())
}

fn vertices(cursor: &mut Cursor, element: &Element, mesh: &mut TriMesh) -> Result<(), String> {
    let roles = roles(element, &["x", "y", "z", "nx", "ny", "nz"])?;
    let has = |wanted: usize| {
        let mut pairs = roles.iter().zip(&element.properties);
        pairs.any(|(role, property)| *role == Some(wanted) && property.length.is_none())
    };
    if !(0..3).all(has) {
        return Err("the vertices have no x, y, z".into());
    }
    let has_normals = (3..6).all(has);
    for index in 0..element.count {
        let truncated = || format!("it ends at vertex {index} of {}", element.count);
        let mut values = [0.0; 6];
        for (property, role) in element.properties.iter().zip(&roles) {
            match (property.length, role) {
                (None, Some(role)) => {
                    values[*role] = cursor.number(property.number).ok_or_else(truncated)?;
                }
                _ => cursor.skip(property).ok_or_else(truncated)?,
            }
        }
        let [x, y, z, nx, ny, nz] = values;
        mesh.vertices.push([x, y, z]);
        if has_normals {
            mesh.normals.push([nx, ny, nz].map(|x| x as f32));
        }
    }
    Ok(())
}

fn faces(cursor: &mut Cursor, element: &Element, mesh: &mut MaterialMesh) -> Result<(), String> {
    const LABELS: [&str; 2] = ["first", "second"];
    let roles = roles(element, &["vertex_indices", "vertex_index", LABELS[0], LABELS[1]])?;
    let has_labels = LABELS
        .iter()
        .all(|name| element.properties.iter().any(|p| p.name == *name && p.length.is_none()));
    let mut corners = Vec::new();
    for index in 0..element.count {
        let truncated = || format!("it ends at face {index} of {}", element.count);
        let (mut pair, before) = ([0; 2], mesh.surface.triangles.len());
        for (property, role) in element.properties.iter().zip(&roles) {
            let length = match (property.length, role) {
                (Some(length), Some(0 | 1)) => length,
                (None, Some(role @ (2 | 3))) => {
                    let label = cursor.number(property.number).ok_or_else(truncated)?;
                    pair[role - 2] = label as i64;
                    continue;
                }
                _ => {
                    cursor.skip(property).ok_or_else(truncated)?;
                    continue;
                }
            };
            corners.clear();
            for _ in 0..cursor.length(length).ok_or_else(truncated)? {
                let corner = cursor.number(property.number).ok_or_else(truncated)?;
                let whole = corner.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&corner);
                if !whole {
                    return Err(format!("face {index} names the vertex {corner}"));
                }
                corners.push(corner as u32);
            }
            push_fan(&mut mesh.surface.triangles, &corners)
                .map_err(|problem| format!("face {index} {problem}"))?;
        }
        if has_labels {
            let added = mesh.surface.triangles.len() - before;
            mesh.pairs.extend(std::iter::repeat_n(pair, added));
        }
    }
    let list =
        |(property, role): (&Property, &Option<usize>)| property.length.is_some() && role.is_some();
    if element.count > 0 && !element.properties.iter().zip(&roles).any(list) {
        return Err("the faces have no list vertex_indices".into());
    }
    Ok(())
}

/// The edges, if they are what this program writes; others are left out.
fn edges(cursor: &mut Cursor, element: &Element, mesh: &mut MaterialMesh) -> Result<(), String> {
    let is_end = |p: &Property, name| p.name == name && p.length.is_none();
    let [first, second] = element.properties.as_slice() else { return skip(cursor, element) };
    if !(is_end(first, "vertex1") && is_end(second, "vertex2")) {
        return skip(cursor, element);
    }
    for index in 0..element.count {
        let mut end = |property: &Property| cursor.number(property.number);
        let ends = [end(first), end(second)];
        let [Some(a), Some(b)] = ends else {
            return Err(format!("it ends at edge {index} of {}", element.count));
        };
        mesh.lines.push([a as u32, b as u32]);
    }
    Ok(())
}

fn skip(cursor: &mut Cursor, element: &Element) -> Result<(), String> {
    roles(element, &[])?;
    for index in 0..element.count {
        for property in &element.properties {
            let end = || format!("it ends at {} {index} of {}", element.name, element.count);
            cursor.skip(property).ok_or_else(end)?;
        }
    }
    Ok(())
}

/// A place in the file. Reads give `None` when the file ends or holds something else there.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl<'a> Cursor<'a> {
    fn line(&mut self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|byte| *byte == b'\n')?;
        self.at += end + 1;
        Some(String::from_utf8_lossy(&rest[..end]).trim_end().to_string())
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let bytes = *self.bytes.get(self.at..)?.first_chunk::<N>()?;
        self.at += N;
        Some(bytes)
    }

    fn word(&mut self) -> Option<&'a str> {
        let rest = self.bytes.get(self.at..)?;
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let word = &rest[start..];
        // A last word without a line end may have been cut short.
        let end = word.iter().position(u8::is_ascii_whitespace)?;
        self.at += start + end;
        str::from_utf8(&word[..end]).ok()
    }

    fn number(&mut self, number: Number) -> Option<f64> {
        macro_rules! read {
            ($type:ty) => {
                match self.encoding {
                    Encoding::Text => self.word()?.parse::<$type>().ok()?.into(),
                    Encoding::Little => <$type>::from_le_bytes(self.take()?).into(),
                    Encoding::Big => <$type>::from_be_bytes(self.take()?).into(),
                }
            };
        }
        Some(match number {
            Number::I8 => read!(i8),
            Number::U8 => read!(u8),
            Number::I16 => read!(i16),
            Number::U16 => read!(u16),
            Number::I32 => read!(i32),
            Number::U32 => read!(u32),
            Number::F32 => read!(f32),
            Number::F64 => read!(f64),
        })
    }

    fn length(&mut self, number: Number) -> Option<u64> {
        let length = self.number(number)?;
        (length >= 0.0 && length.fract() == 0.0).then_some(length as u64)
    }

    fn skip(&mut self, property: &Property) -> Option<()> {
        let count = match property.length {
            Some(length) => self.length(length)?,
            None => 1,
        };
        (0..count).try_for_each(|_| self.number(property.number).map(|_| ()))
    }
}
