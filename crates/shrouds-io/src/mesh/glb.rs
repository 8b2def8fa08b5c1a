//! GLB out: binary glTF 2.0, for viewers.
//!
//! Format: the glTF 2.0 specification. A file is a header of 12 bytes, a chunk of JSON and a chunk
//! with the arrays, in which the bytes of each part follow one another: positions, normals,
//! attributes, triangles. All numbers have 32 bits.
//!
//! Coordinates keep their directions and their unit, although by the specification y points up and
//! lengths are metres: so they are the same numbers as in the other formats. Which they are stands in
//! `asset.extras`. Positions are relative to the middle of everything, the translation of the root
//! node, so that little is lost to 32 bits far from the origin.

use std::io::{self, Write};

use serde_json::{Value, json};
use shrouds::TriMesh;

use crate::mesh::MeshOptions;
use crate::mesh::part::{Part, Parts};
use crate::mesh::records::{put, write_fixed};

/// Bytes of the file's header, and of the header of a chunk.
const HEADER: u64 = 12;
const CHUNK: u64 = 8;
/// Numbers of the specification: types of arrays and what they are for.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A file that is ready to be written.
pub(super) struct Glb<'a> {
    parts: Parts<'a>,
    with_normals: bool,
    centre: [f64; 3],
    json: Vec<u8>,
    /// Bytes of all arrays, and of the whole file.
    arrays: u32,
    total: u32,
}

impl<'a> Glb<'a> {
    /// Says what keeps the parts from being a GLB file.
    pub(super) fn new(parts: Parts<'a>, options: &MeshOptions) -> Result<Self, String> {
        let with_normals = parts.have_normals();
        let centre = centre(parts);
        let mut document = Document::default();
        for part in parts.iter() {
            document.add(part, with_normals, centre);
        }
        let (mut json, arrays) = (document.json(centre, options), document.bytes);
        // Chunks end at multiples of four bytes.
        json.resize(json.len().next_multiple_of(4), b' ');
        let total = total(json.len() as u64, arrays)?;
        Ok(Self { parts, with_normals, centre, json, arrays: arrays as u32, total })
    }

    pub(super) fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        writer.write_all(b"glTF")?;
        for number in [2, self.total, self.json.len() as u32] {
            writer.write_all(&number.to_le_bytes())?;
        }
        writer.write_all(b"JSON")?;
        writer.write_all(&self.json)?;
        if self.arrays == 0 {
            return Ok(());
        }
        writer.write_all(&self.arrays.to_le_bytes())?;
        writer.write_all(b"BIN\0")?;
        self.parts
            .iter()
            .filter(|part| is_shown(part))
            .try_for_each(|part| self.arrays(writer, part))
    }

    fn arrays(&self, writer: &mut dyn Write, part: &Part) -> io::Result<()> {
        let TriMesh { vertices, triangles, normals } = part.mesh;
        write_fixed(writer, vertices.iter(), |vertex, record: &mut [u8; 12]| {
            put(record, relative(*vertex, self.centre).map(f32::to_le_bytes).as_flattened());
        })?;
        if self.with_normals {
            write_fixed(writer, normals.iter(), |normal, record: &mut [u8; 12]| {
                put(record, unit(*normal).map(f32::to_le_bytes).as_flattened());
            })?;
        }
        for attribute in part.attributes {
            write_fixed(writer, attribute.values.iter(), |x, record: &mut [u8; 4]| {
                *record = x.to_le_bytes();
            })?;
        }
        write_fixed(writer, triangles.iter(), |triangle, record: &mut [u8; 12]| {
            put(record, triangle.map(u32::to_le_bytes).as_flattened());
        })
    }
}

/// The lists of the JSON, and the bytes of the arrays that they describe.
#[derive(Default)]
struct Document {
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: u64,
}

impl Document {
    /// Adds a part. One without triangles is a node without a mesh, for arrays cannot be empty.
    fn add(&mut self, part: &Part, with_normals: bool, centre: [f64; 3]) {
        let mut node = json!({ "name": part.name });
        if let Some(label) = part.label {
            node["extras"] = json!({ "label": label });
        }
        if is_shown(part) {
            let vertices = part.mesh.vertices.len();
            let position = self.array(vertices, "VEC3", FLOAT, ARRAY_BUFFER);
            let [low, high] = bounds(part.mesh.vertices.iter().map(|v| relative(*v, centre)));
            self.accessors[position]["min"] = json!(low);
            self.accessors[position]["max"] = json!(high);
            let mut attributes = json!({ "POSITION": position });
            if with_normals {
                attributes["NORMAL"] = json!(self.array(vertices, "VEC3", FLOAT, ARRAY_BUFFER));
            }
            for attribute in part.attributes {
                let name = format!("_{}", attribute.name.to_ascii_uppercase());
                attributes[name] = json!(self.array(vertices, "SCALAR", FLOAT, ARRAY_BUFFER));
            }
            let corners = 3 * part.mesh.triangles.len();
            let indices = self.array(corners, "SCALAR", UNSIGNED_INT, ELEMENT_ARRAY_BUFFER);
            let primitive = json!({ "attributes": attributes, "indices": indices, "material": 0 });
            node["mesh"] = json!(self.meshes.len());
            self.meshes.push(json!({ "name": part.name, "primitives": [primitive] }));
        }
        self.nodes.push(node);
    }

    /// Adds an array of numbers of 32 bits after the others; its number.
    fn array(&mut self, count: usize, shape: &str, kind: u32, target: u32) -> usize {
        let bytes = 4 * count as u64 * if shape == "VEC3" { 3 } else { 1 };
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes, "byteLength": bytes, "target": target
        }));
        self.bytes += bytes;
        let view = self.accessors.len();
        self.accessors.push(
            json!({ "bufferView": view, "componentType": kind, "count": count, "type": shape }),
        );
        view
    }

    fn json(&self, centre: [f64; 3], options: &MeshOptions) -> Vec<u8> {
        let generator = format!("shrouds {}", env!("CARGO_PKG_VERSION"));
        let mut root = json!({ "asset": { "version": "2.0", "generator": generator } });
        if let Some(frame) = &options.frame {
            root["asset"]["extras"] = json!({ "frame": frame.name, "unit": frame.unit });
        }
        // No list may be empty.
        if !self.nodes.is_empty() {
            let parts: Vec<usize> = (1..=self.nodes.len()).collect();
            let mut nodes = vec![json!({ "translation": centre, "children": parts })];
            nodes.extend_from_slice(&self.nodes);
            root["nodes"] = json!(nodes);
            root["scenes"] = json!([{ "nodes": [0] }]);
            root["scene"] = json!(0);
        }
        if !self.meshes.is_empty() {
            root["meshes"] = json!(self.meshes);
            root["accessors"] = json!(self.accessors);
            root["bufferViews"] = json!(self.views);
            root["buffers"] = json!([{ "byteLength": self.bytes }]);
            let white = json!({ "metallicFactor": 0.0, "roughnessFactor": 0.8 });
            root["materials"] = json!([{ "pbrMetallicRoughness": white }]);
        }
        root.to_string().into_bytes()
    }
}

fn is_shown(part: &Part) -> bool {
    !part.mesh.triangles.is_empty()
}

/// Bytes of a file with so many bytes of JSON and of arrays.
fn total(json: u64, arrays: u64) -> Result<u32, String> {
    let total = HEADER + CHUNK + json + if arrays == 0 { 0 } else { CHUNK + arrays };
    u32::try_from(total).map_err(|_| {
        format!("it takes {total} bytes as .glb, which holds 4 GiB; write .vtp or .ply, or crop it")
    })
}

/// The middle of all that is shown.
fn centre(parts: Parts) -> [f64; 3] {
    let shown = parts.iter().filter(|part| is_shown(part));
    let [low, high] = bounds(shown.flat_map(|part| part.mesh.vertices.iter().copied()));
    // Halves first: their sum cannot overflow.
    std::array::from_fn(|k| if low[k] <= high[k] { 0.5 * low[k] + 0.5 * high[k] } else { 0.0 })
}

/// The smallest and the largest coordinates; the other way round where there are none.
fn bounds<T: PartialOrd + Copy + From<f32>>(points: impl Iterator<Item = [T; 3]>) -> [[T; 3]; 2] {
    let none = [[T::from(f32::INFINITY); 3], [T::from(f32::NEG_INFINITY); 3]];
    points.fold(none, |[mut low, mut high], point| {
        for (k, x) in point.into_iter().enumerate() {
            low[k] = if x < low[k] { x } else { low[k] };
            high[k] = if x > high[k] { x } else { high[k] };
        }
        [low, high]
    })
}

/// A place as it stands in the file.
fn relative(vertex: [f64; 3], centre: [f64; 3]) -> [f32; 3] {
    // Adding 0 turns -0 into 0, as the bounds have it.
    std::array::from_fn(|k| (vertex[k] - centre[k]) as f32 + 0.0)
}

/// A normal of length 1, which glTF insists on; upwards where there is none.
fn unit(normal: [f32; 3]) -> [f32; 3] {
    let normal = normal.map(f64::from);
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        normal.map(|x| (x / length) as f32)
    } else {
        [0.0, 0.0, 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::total;

    #[test]
    fn four_gibibytes_are_the_end() {
        assert_eq!(total(100, 0), Ok(120));
        let room = u64::from(u32::MAX) - 12 - 8 - 8 - 100;
        assert_eq!(total(100, room), Ok(u32::MAX));
        assert!(total(100, room + 1).is_err_and(|text| text.contains("4294967296 bytes")));
    }
}
