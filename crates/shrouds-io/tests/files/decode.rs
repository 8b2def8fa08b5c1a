//! The files that are only written, taken apart as their formats prescribe.

use std::io::{Cursor, Read};

use serde_json::Value;
use shrouds::TriMesh;

/// A mesh of a file, with its name and its numbers per vertex.
#[derive(Debug, PartialEq)]
pub(crate) struct Decoded {
    pub(crate) name: String,
    pub(crate) mesh: TriMesh,
    pub(crate) attributes: Vec<(String, Vec<f32>)>,
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize
}

fn f32s(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|chunk| f32::from_le_bytes(*chunk)).collect()
}

fn triples<T: Copy>(values: &[T]) -> Vec<[T; 3]> {
    assert_eq!(values.len() % 3, 0);
    values.as_chunks().0.to_vec()
}

/// The JSON and the meshes of a GLB file.
pub(crate) fn glb(bytes: &[u8]) -> (Value, Vec<Decoded>) {
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!([u32_at(bytes, 4), u32_at(bytes, 8)], [2, bytes.len()]);
    let length = u32_at(bytes, 12);
    assert_eq!((&bytes[16..20], length % 4), (&b"JSON"[..], 0));
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let rest = &bytes[20 + length..];
    let arrays = match rest.len() {
        0 => rest,
        _ => {
            assert_eq!((u32_at(rest, 0), &rest[4..8]), (rest.len() - 8, &b"BIN\0"[..]));
            assert_eq!(json["buffers"][0]["byteLength"], rest.len() - 8);
            &rest[8..]
        }
    };
    let nodes = json["nodes"].as_array().cloned().unwrap_or_default();
    let meshes = nodes.iter().skip(1).map(|node| glb_mesh(&json, arrays, node)).collect();
    (json, meshes)
}

fn glb_mesh(json: &Value, arrays: &[u8], node: &Value) -> Decoded {
    let mut decoded = Decoded {
        name: node["name"].as_str().unwrap().into(),
        mesh: TriMesh::default(),
        attributes: Vec::new(),
    };
    let Some(mesh) = node["mesh"].as_u64() else { return decoded };
    let primitive = &json["meshes"][mesh as usize]["primitives"][0];
    let array = |index: &Value| {
        let accessor = &json["accessors"][index.as_u64().unwrap() as usize];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let [start, length] =
            ["byteOffset", "byteLength"].map(|k| view[k].as_u64().unwrap() as usize);
        let width = if accessor["type"] == "VEC3" { 3 } else { 1 };
        assert_eq!(accessor["count"].as_u64().unwrap() as usize * 4 * width, length);
        (accessor, &arrays[start..start + length])
    };
    let translation: [f64; 3] =
        serde_json::from_value(json["nodes"][0]["translation"].clone()).unwrap();
    for (name, index) in primitive["attributes"].as_object().unwrap() {
        let (accessor, bytes) = array(index);
        assert_eq!(accessor["componentType"], 5126);
        let values = f32s(bytes);
        match name.as_str() {
            "POSITION" => {
                let points = triples(&values);
                for (key, pick) in [("min", f32::min as fn(f32, f32) -> f32), ("max", f32::max)] {
                    let bound = points
                        .iter()
                        .copied()
                        .reduce(|a, b| std::array::from_fn(|k| pick(a[k], b[k])));
                    // The reader of JSON may miss the last bit of 64.
                    let stated = [0, 1, 2].map(|k| accessor[key][k].as_f64().unwrap() as f32);
                    assert_eq!(Some(stated), bound);
                }
                let place =
                    |p: &[f32; 3]| std::array::from_fn(|k| translation[k] + f64::from(p[k]));
                decoded.mesh.vertices = points.iter().map(place).collect();
            }
            "NORMAL" => decoded.mesh.normals = triples(&values),
            _ => decoded.attributes.push((name.clone(), values)),
        }
    }
    let (accessor, bytes) = array(&primitive["indices"]);
    assert_eq!(accessor["componentType"], 5125);
    let corners: Vec<u32> =
        bytes.as_chunks().0.iter().map(|chunk| u32::from_le_bytes(*chunk)).collect();
    decoded.mesh.triangles = triples(&corners);
    decoded
}

/// A VTP file: its XML, and the arrays by name with the type that they have.
pub(crate) struct Vtp<'a> {
    pub(crate) xml: &'a str,
    data: &'a [u8],
}

impl<'a> Vtp<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let mark = b"<AppendedData encoding=\"raw\">\n_";
        let at = bytes.windows(mark.len()).position(|window| window == mark).unwrap();
        let end = b"\n</AppendedData>\n</VTKFile>\n";
        assert!(bytes.ends_with(end));
        let data = &bytes[at + mark.len()..bytes.len() - end.len()];
        let vtp = Self { xml: str::from_utf8(&bytes[..at]).unwrap(), data };
        // Every byte belongs to one array.
        let mut next = 0;
        for tag in vtp.tags() {
            assert_eq!(attribute(tag, "offset").parse::<usize>().unwrap(), next);
            next += 8 + u64_at(data, next) as usize;
        }
        assert_eq!(next, data.len());
        vtp
    }

    fn tags(&self) -> impl Iterator<Item = &'a str> {
        self.xml.split("<DataArray").skip(1).map(|rest| rest.split("/>").next().unwrap())
    }

    pub(crate) fn names(&self) -> Vec<&'a str> {
        self.tags().map(|tag| attribute(tag, "Name")).collect()
    }

    /// The numbers of an array; whole numbers up to 2⁵³ are exact.
    pub(crate) fn array(&self, name: &str) -> Vec<f64> {
        let tag = self.tags().find(|tag| attribute(tag, "Name") == name).unwrap();
        let at: usize = attribute(tag, "offset").parse().unwrap();
        let bytes = &self.data[at + 8..][..u64_at(self.data, at) as usize];
        let eights = || bytes.as_chunks::<8>().0.iter();
        match attribute(tag, "type") {
            "Float32" => f32s(bytes).into_iter().map(f64::from).collect(),
            "Float64" => eights().map(|chunk| f64::from_le_bytes(*chunk)).collect(),
            "Int64" => eights().map(|chunk| i64::from_le_bytes(*chunk) as f64).collect(),
            "Int32" => {
                bytes.as_chunks().0.iter().map(|chunk| i32::from_le_bytes(*chunk).into()).collect()
            }
            other => panic!("the type {other}"),
        }
    }

    /// Vertices, triangles and normals.
    pub(crate) fn mesh(&self) -> TriMesh {
        let corners: Vec<u32> = self.array("connectivity").iter().map(|x| *x as u32).collect();
        let ends: Vec<f64> = (1..=corners.len() / 3).map(|n| 3.0 * n as f64).collect();
        assert_eq!(self.array("offsets"), ends);
        let normals = match self.names().contains(&"Normals") {
            true => self.array("Normals").iter().map(|x| *x as f32).collect(),
            false => Vec::new(),
        };
        TriMesh {
            vertices: triples(&self.array("Points")),
            triangles: triples(&corners),
            normals: triples(&normals),
        }
    }
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(*bytes[at..].first_chunk().unwrap())
}

/// The value of an attribute of an XML element.
pub(crate) fn attribute<'t>(tag: &'t str, name: &str) -> &'t str {
    let start = format!(" {name}=\"");
    tag.split(&start).nth(1).expect(name).split('"').next().unwrap()
}

/// The model of a 3MF file as text, and its meshes.
pub(crate) fn threemf(bytes: &[u8]) -> (String, Vec<Decoded>) {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let names: Vec<_> = archive.file_names().map(Result::unwrap).collect();
    assert_eq!(names, ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]);
    let mut model = String::new();
    archive.by_name("3D/3dmodel.model").unwrap().read_to_string(&mut model).unwrap();
    let objects = model.split("<object").skip(1).map(|object| {
        let tag = object.split('>').next().unwrap();
        let numbers = |element: &str, names: [&str; 3]| -> Vec<[String; 3]> {
            let elements = object.split(element).skip(1).filter(|rest| rest.starts_with(' '));
            elements.map(|tag| names.map(|name| attribute(tag, name).to_string())).collect()
        };
        let vertices = numbers("<vertex", ["x", "y", "z"]);
        let triangles = numbers("<triangle", ["v1", "v2", "v3"]);
        let name = if tag.contains(" name=") { attribute(tag, "name") } else { "" };
        let mesh = TriMesh {
            vertices: vertices.iter().map(|v| v.each_ref().map(|x| x.parse().unwrap())).collect(),
            triangles: triangles.iter().map(|t| t.each_ref().map(|x| x.parse().unwrap())).collect(),
            normals: Vec::new(),
        };
        Decoded { name: name.into(), mesh, attributes: Vec::new() }
    });
    let objects = objects.collect();
    (model, objects)
}
