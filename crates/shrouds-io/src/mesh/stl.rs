//! STL: binary out, binary and text in.
//!
//! A binary file is 80 bytes of comment, the number of triangles and 50 bytes for each: its normal,
//! three corners as 32-bit floats and two bytes that mean nothing here.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

use shrouds::TriMesh;

use crate::error::Error;
use crate::mesh::MeshOptions;
use crate::mesh::part::{Part, Parts};
use crate::mesh::records::write_fixed;

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn write(writer: &mut dyn Write, parts: Parts, options: &MeshOptions) -> io::Result<()> {
    // The comment begins with the name of the program: never with "solid", which marks text.
    let mut header = [b' '; HEADER];
    for (byte, text) in header[..80].iter_mut().zip(options.comment().bytes()) {
        *byte = text;
    }
    header[80..].copy_from_slice(&(parts.triangle_count() as u32).to_le_bytes());
    writer.write_all(&header)?;
    parts.iter().try_for_each(|Part { mesh, .. }| {
        write_fixed(writer, mesh.triangles.iter(), |triangle, record: &mut [u8; TRIANGLE]| {
            let corners = mesh.corners(*triangle);
            let vectors = [normal(corners), corners[0], corners[1], corners[2]];
            let floats = record.as_chunks_mut::<4>().0;
            for (bytes, x) in floats.iter_mut().zip(vectors.as_flattened()) {
                *bytes = (*x as f32).to_le_bytes();
            }
        })
    })
}

/// Unit normal of a triangle, or 0 when it has no area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|k| p[k] - a[k]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { n.map(|x| x / length) } else { [0.0; 3] }
}

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<TriMesh, Error> {
    let count = bytes.get(80..HEADER).and_then(|count| count.first_chunk());
    let count = count.map(|count| u32::from_le_bytes(*count));
    let expected = count.map(|count| HEADER as u64 + u64::from(count) * TRIANGLE as u64);
    if expected == Some(bytes.len() as u64) {
        return Ok(binary(&bytes[HEADER..]));
    }
    // Binary files may begin with "solid" too, against the rule: so the length decides first.
    if bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return text(bytes).map_err(|problem| Error::mesh(path, problem));
    }
    Err(match (count, expected) {
        (Some(count), Some(expected)) => {
            let found = bytes.len();
            Error::mesh(
                path,
                format!("{count} triangles take {expected} bytes, but it has {found}"),
            )
        }
        _ => {
            let advice = "check the extension, or write it again as .stl";
            Error::Content { path: path.into(), expected: "an STL mesh", advice }
        }
    })
}

fn binary(bytes: &[u8]) -> TriMesh {
    let mut corners = Corners::default();
    for record in bytes.as_chunks::<TRIANGLE>().0 {
        let floats = record.as_chunks::<4>().0;
        let x = |n: usize| f64::from(f32::from_le_bytes(floats[n]));
        corners.push([3, 6, 9].map(|n| [x(n), x(n + 1), x(n + 2)]));
    }
    corners.mesh
}

fn text(bytes: &[u8]) -> Result<TriMesh, String> {
    let text = str::from_utf8(bytes).map_err(|_| "it is neither text nor complete binary")?;
    let (mut corners, mut facet, mut ended) = (Corners::default(), Vec::new(), false);
    for (number, line) in text.lines().enumerate() {
        let number = number + 1;
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default().to_lowercase();
        ended = word == "endsolid" || (ended && word.is_empty());
        match word.as_str() {
            "vertex" => {
                let values: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
                let point = values.and_then(|values| values.try_into().ok());
                facet.push(point.ok_or_else(|| format!("line {number} has no three numbers"))?);
            }
            "endfacet" => {
                let facet: Vec<[f64; 3]> = std::mem::take(&mut facet);
                let found = facet.len();
                let facet = facet.try_into();
                corners.push(
                    facet.map_err(|_| format!("the facet at line {number} has {found} corners"))?,
                );
            }
            "solid" | "facet" | "outer" | "endloop" | "endsolid" | "" => {}
            _ => return Err(format!("line {number} begins with '{word:.20}'")),
        }
    }
    if ended && facet.is_empty() { Ok(corners.mesh) } else { Err("it has no endsolid".into()) }
}

/// A mesh in which equal corners are one vertex, in the order of their first appearance.
#[derive(Default)]
struct Corners {
    mesh: TriMesh,
    index: HashMap<[u64; 3], u32>,
}

impl Corners {
    fn push(&mut self, triangle: [[f64; 3]; 3]) {
        let triangle = triangle.map(|point| {
            // Adding 0 turns -0 into 0: they are the same place.
            let point = point.map(|x| x + 0.0);
            let vertices = &mut self.mesh.vertices;
            *self.index.entry(point.map(f64::to_bits)).or_insert_with(|| {
                vertices.push(point);
                (vertices.len() - 1) as u32
            })
        });
        self.mesh.triangles.push(triangle);
    }
}
