//! Several meshes and numbers per vertex in one file, and the formats that are only written.

use proptest::prelude::*;
use shrouds::TriMesh;
use shrouds_io::{
    Attribute, Error, Frame, Line, MeshFormat, MeshOptions, Part, Precision, mesh_format,
    read_mesh, write_lines, write_lines_with, write_mesh, write_meshes,
};

use crate::common::Folder;
use crate::decode::{Decoded, Vtp, attribute, glb, threemf};
use crate::meshes::octahedron;

const FORMATS: [&str; 6] = ["a.ply", "a.stl", "a.obj", "a.glb", "a.vtp", "a.3mf"];

fn double(unit: &str) -> MeshOptions {
    let frame = Frame { name: "RAS".into(), unit: unit.into(), source: "" };
    MeshOptions { precision: Precision::Double, frame: Some(frame) }
}

fn moved(mesh: &TriMesh, by: f64) -> TriMesh {
    let vertices = mesh.vertices.iter().map(|v| v.map(|x| x + by)).collect();
    TriMesh { vertices, ..mesh.clone() }
}

fn bytes(folder: &Folder, name: &str, parts: &[Part], options: &MeshOptions) -> Vec<u8> {
    write_meshes(folder.path(name), parts, options).unwrap();
    std::fs::read(folder.path(name)).unwrap()
}

/// Two octahedra with an attribute each, as a list of parts.
struct Two {
    meshes: [TriMesh; 2],
    values: [[f32; 6]; 2],
}

impl Two {
    fn new() -> Self {
        let first = octahedron(true);
        let values = [1.0, 2.0].map(|x: f32| std::array::from_fn(|n| x + 0.1 * n as f32));
        Self { meshes: [first.clone(), moved(&first, 3.0)], values }
    }

    fn attributes(&self) -> [[Attribute<'_>; 1]; 2] {
        self.values.each_ref().map(|values| [Attribute { name: "delta", values }])
    }

    fn parts<'a>(&'a self, attributes: &'a [[Attribute<'a>; 1]; 2]) -> [Part<'a>; 2] {
        let part = |n: usize, name, label| Part {
            name,
            label: Some(label),
            mesh: &self.meshes[n],
            attributes: &attributes[n],
        };
        [part(0, "liver & \"gall\"", 6), part(1, "left\nkidney", -3)]
    }

    /// All in one list.
    fn merged(&self) -> TriMesh {
        let [a, b] = &self.meshes;
        let shifted = b.triangles.iter().map(|t| t.map(|v| v + 6));
        TriMesh {
            vertices: [&a.vertices[..], &b.vertices].concat(),
            triangles: a.triangles.iter().copied().chain(shifted).collect(),
            normals: [&a.normals[..], &b.normals].concat(),
        }
    }
}

#[test]
fn one_list_of_vertices_holds_all_parts() {
    let (folder, two) = (Folder::new(), Two::new());
    let attributes = two.attributes();
    let parts = two.parts(&attributes);
    for name in ["a.ply", "a.obj"] {
        bytes(&folder, name, &parts, &double("mm"));
        assert_eq!(read_mesh(folder.path(name)).unwrap(), two.merged(), "{name}");
    }
    let file = bytes(&folder, "a.vtp", &parts, &double("mm"));
    let vtp = Vtp::new(&file);
    assert_eq!(vtp.mesh(), two.merged());
    assert_eq!(vtp.array("label"), [[6.0; 8], [-3.0; 8]].concat());
    let values: Vec<f64> = two.values.as_flattened().iter().map(|x| f64::from(*x)).collect();
    assert_eq!(vtp.array("delta"), values);
}

#[test]
fn ply_vertices_carry_attributes_and_labels() {
    let (folder, two) = (Folder::new(), Two::new());
    let attributes = two.attributes();
    let mut parts = two.parts(&attributes);
    // What follows the six numbers of place and normal, for every vertex.
    let tails = |parts: &[Part], tail: usize| {
        let file = bytes(&folder, "a.ply", parts, &double("mm"));
        let end = b"end_header\n";
        let start = file.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let header = String::from_utf8(file[..start].into()).unwrap();
        let vertices = &file[start..start + 12 * (48 + tail)];
        let tails: Vec<Vec<u8>> = vertices.chunks(48 + tail).map(|v| v[48..].into()).collect();
        (header, tails)
    };
    let expected = |label: [&[u8]; 2]| -> Vec<Vec<u8>> {
        let tail = |n: usize| [&two.values[n / 6][n % 6].to_le_bytes()[..], label[n / 6]].concat();
        (0..12).map(tail).collect()
    };
    let (header, found) = tails(&parts, 8);
    assert!(header.contains("nz\nproperty float delta\nproperty int label\nelement face 16\n"));
    assert_eq!(found, expected([&6i32.to_le_bytes(), &(-3i32).to_le_bytes()]));
    // A label missing: all parts are numbered.
    parts[0].label = None;
    assert_eq!(tails(&parts, 8).1, expected([&1i32.to_le_bytes(), &2i32.to_le_bytes()]));
    parts[0].label = Some(1 << 40);
    let (header, found) = tails(&parts, 12);
    assert!(header.contains("property double label\n"));
    assert_eq!(found, expected([&(2f64.powi(40)).to_le_bytes(), &(-3f64).to_le_bytes()]));
    parts[0].label = Some(i64::MAX);
    let error = write_meshes(folder.path("b.ply"), &parts, &double("mm")).unwrap_err();
    assert!(error.to_string().contains("write .vtp"), "{error}");
    // One part alone has a label only where it is given.
    let part = Part { label: None, ..parts[0] };
    let text =
        String::from_utf8_lossy(&bytes(&folder, "a.ply", &[part], &double("mm"))).to_string();
    assert!(text.contains("float delta") && !text.contains("label"));
}

#[test]
fn obj_names_its_parts() {
    let mesh = TriMesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]],
        triangles: vec![[0, 1, 2]],
        normals: Vec::new(),
    };
    let parts = ["a b\nv 1", ""].map(|name| Part { name, ..Part::from(&mesh) });
    let text = bytes(&Folder::new(), "a.obj", &parts, &MeshOptions::default());
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1.5 0\n";
    let (comment, text) = str::from_utf8(&text).unwrap().split_once('\n').unwrap();
    assert!(comment.starts_with("# shrouds"));
    assert_eq!(text, format!("o a_b_v_1\ng a_b_v_1\n{vertices}f 1 2 3\n{vertices}f 4 5 6\n"));
}

#[test]
fn glb_has_a_node_for_each_part() {
    let (folder, two) = (Folder::new(), Two::new());
    let attributes = two.attributes();
    let (json, meshes) = glb(&bytes(&folder, "a.glb", &two.parts(&attributes), &double("um")));
    let asset = &json["asset"];
    assert_eq!((&asset["version"], &asset["extras"]["unit"]), (&"2.0".into(), &"um".into()));
    assert_eq!(json["nodes"][0]["children"], serde_json::json!([1, 2]));
    assert_eq!(json["nodes"][2]["extras"]["label"], -3);
    for (n, decoded) in meshes.iter().enumerate() {
        let expected = &two.meshes[n];
        assert_eq!(decoded.name, ["liver & \"gall\"", "left\nkidney"][n]);
        assert_eq!(
            (&decoded.mesh.triangles, &decoded.mesh.normals),
            (&expected.triangles, &expected.normals)
        );
        assert!(farthest(&decoded.mesh, expected) < 3e-7);
        assert_eq!(decoded.attributes, [("_DELTA".to_string(), two.values[n].to_vec())]);
    }
}

/// The largest difference of two coordinates.
fn farthest(a: &TriMesh, b: &TriMesh) -> f64 {
    let [a, b] = [a, b].map(|mesh| mesh.vertices.as_flattened());
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |max: f64, (a, b)| max.max((a - b).abs()))
}

#[test]
fn glb_keeps_its_digits_far_away_and_its_normals_long() {
    let folder = Folder::new();
    let mut far = moved(&octahedron(true), 1e9);
    far.normals = vec![
        [0.0; 3],
        [0.0, 3.0, 4.0],
        [f32::NAN; 3],
        [1e-30, 0.0, 0.0],
        [1e30; 3],
        [-1.0, 0.0, 0.0],
    ];
    let (_, meshes) = glb(&bytes(&folder, "a.glb", &[(&far).into()], &MeshOptions::default()));
    // The steps of 64 bits are 1.2e-7 there, those of 32 bits 64.
    assert!(farthest(&meshes[0].mesh, &far) < 4e-7);
    for normal in &meshes[0].mesh.normals {
        let length = normal.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-6, "{normal:?}");
    }
    assert_eq!(meshes[0].mesh.normals[1], [0.0, 0.6, 0.8]);
    // From end to end of the 32-bit floats.
    let mut wide = octahedron(false);
    wide.vertices[0] = [f64::from(f32::MAX); 3];
    wide.vertices[1] = [-f64::from(f32::MAX); 3];
    let (_, meshes) = glb(&bytes(&folder, "a.glb", &[(&wide).into()], &MeshOptions::default()));
    assert_eq!(meshes[0].mesh.vertices[..2], wide.vertices[..2]);
}

#[test]
fn vtp_names_frame_and_parts() {
    let (folder, two) = (Folder::new(), Two::new());
    let attributes = two.attributes();
    let file = bytes(&folder, "a.vtp", &two.parts(&attributes), &double("mm"));
    let vtp = Vtp::new(&file);
    let text = |name: &str| {
        let start = format!("<Array type=\"String\" Name=\"{name}\" ");
        let element = vtp.xml.split(&start).nth(1).unwrap();
        let numbers = element.split(['>', '<']).nth(1).unwrap();
        numbers.split(' ').map(|n| n.parse::<u8>().unwrap() as char).collect::<String>()
    };
    assert_eq!([text("SPACE"), text("UNIT")], ["RAS\0", "mm\0"]);
    assert_eq!(text("names"), "liver & \"gall\"\0left\nkidney\0");
    assert_eq!(attribute(vtp.xml, "NumberOfPolys"), "16");
    // A single mesh has none of that.
    let file = bytes(&folder, "a.vtp", &[(&two.meshes[0]).into()], &MeshOptions::default());
    let vtp = Vtp::new(&file);
    assert_eq!(vtp.names(), ["Normals", "Points", "connectivity", "offsets"]);
    assert!(!vtp.xml.contains("String"));
}

#[test]
fn threemf_has_units_and_objects() {
    let (folder, two) = (Folder::new(), Two::new());
    let attributes = two.attributes();
    let parts = two.parts(&attributes);
    let (model, objects) = threemf(&bytes(&folder, "a.3mf", &parts, &double("mm")));
    assert!(model.contains("<model unit=\"millimeter\"") && model.contains("SPACE=RAS UNIT=mm"));
    assert_eq!(model.matches("<item objectid=").count(), 2);
    let names = ["liver &amp; &quot;gall&quot;", "left?kidney"];
    for ((object, mesh), name) in objects.iter().zip(&two.meshes).zip(names) {
        let bare = TriMesh { normals: Vec::new(), ..mesh.clone() };
        assert_eq!((&object.mesh, object.name.as_str()), (&bare, name));
    }
    for (unit, expected, factor) in [
        ("µm", "micron", 1.0),
        ("um", "micron", 1.0),
        ("nm", "micron", 1e-3),
        ("m", "meter", 1.0),
        ("in", "inch", 1.0),
        ("voxel", "millimeter", 1.0),
    ] {
        let (model, objects) = threemf(&bytes(&folder, "a.3mf", &parts[..1], &double(unit)));
        assert_eq!(attribute(model.split("<model").nth(1).unwrap(), "unit"), expected, "{unit}");
        let scaled: Vec<[f64; 3]> =
            two.meshes[0].vertices.iter().map(|v| v.map(|x| factor * x)).collect();
        assert_eq!(objects[0].mesh.vertices, scaled);
    }
    // What 3MF forbids is not written.
    let mut thin = two.meshes[0].clone();
    thin.triangles.truncate(1);
    thin.triangles.insert(0, [0, 0, 1]);
    let empty = TriMesh { triangles: vec![[1, 1, 1]], ..thin.clone() };
    let parts = [&empty, &thin].map(Part::from);
    let (_, objects) = threemf(&bytes(&folder, "a.3mf", &parts, &double("mm")));
    assert_eq!(objects.len(), 1);
    assert_eq!(objects[0].mesh.triangles, thin.triangles[1..]);
}

#[test]
fn nothing_is_written_too() {
    let folder = Folder::new();
    let none = TriMesh::default();
    let mut points = octahedron(true);
    points.triangles.clear();
    for parts in [vec![], vec![Part::from(&none)], vec![Part::from(&none), Part::from(&points)]] {
        for name in FORMATS {
            let written = write_meshes(folder.path(name), &parts, &double("mm"));
            assert_eq!(written.is_ok(), parts.len() == 1 || name != "a.stl", "{name}");
        }
        let (json, meshes) = glb(&std::fs::read(folder.path("a.glb")).unwrap());
        assert!(json.get("meshes").is_none() && meshes.len() == parts.len());
        assert!(threemf(&std::fs::read(folder.path("a.3mf")).unwrap()).1.is_empty());
        let file = std::fs::read(folder.path("a.vtp")).unwrap();
        assert!(Vtp::new(&file).mesh().triangles.is_empty());
    }
}

#[test]
fn formats_say_what_they_hold() {
    let known = FORMATS.map(|name| mesh_format(name).unwrap());
    let which = |holds: fn(MeshFormat) -> bool| known.map(|format| u8::from(holds(format)));
    assert_eq!(which(MeshFormat::holds_attributes), [1, 0, 0, 1, 1, 0]);
    assert_eq!(which(MeshFormat::holds_parts), [1, 0, 1, 1, 1, 1]);
    assert_eq!(which(MeshFormat::is_read), [1, 1, 1, 0, 0, 0]);
    let (folder, two) = (Folder::new(), Two::new());
    let attributes = two.attributes();
    let error = write_meshes(folder.path("a.stl"), &two.parts(&attributes), &double("mm"));
    assert!(error.unwrap_err().to_string().contains("write each to a file of its own"));
    assert!(folder.names().is_empty());
    for name in FORMATS {
        let alone = two.parts(&attributes)[0];
        bytes(&folder, name, &[alone], &double("mm"));
        match read_mesh(folder.path(name)) {
            Ok(mesh) => assert_eq!(mesh.triangles.len(), 8),
            Err(error) => assert!(
                matches!(error, Error::Unsupported { .. })
                    && error.to_string().contains("read from .ply, .stl and .obj"),
                "{error}"
            ),
        }
    }
}

#[test]
fn attributes_that_cannot_be_are_refused() {
    let (folder, mesh) = (Folder::new(), octahedron(false));
    let finite = [0.5; 6];
    let mut infinite = finite;
    infinite[4] = f32::INFINITY;
    let cases: [(&[Attribute], &str); 9] = [
        (&[Attribute { name: "delta", values: &finite[1..] }], "5 values for 6 vertices"),
        (
            &[Attribute { name: "delta", values: &infinite }],
            "value 4 of the attribute delta is inf",
        ),
        (&[Attribute { name: "", values: &finite }], "names no attribute"),
        (&[Attribute { name: "a b", values: &finite }], "names no attribute"),
        (&[Attribute { name: "0a", values: &finite }], "names no attribute"),
        (&[Attribute { name: "a\"", values: &finite }], "names no attribute"),
        (&[Attribute { name: "NX", values: &finite }], "is taken"),
        (&[Attribute { name: "label", values: &finite }], "is taken"),
        (
            &[Attribute { name: "a", values: &finite }, Attribute { name: "A", values: &finite }],
            "'A' is taken",
        ),
    ];
    for (attributes, words) in cases {
        for name in FORMATS {
            let parts = [Part { attributes, ..Part::from(&mesh) }];
            let error = write_meshes(folder.path(name), &parts, &double("mm")).unwrap_err();
            assert!(matches!(error, Error::Unwritable { .. }));
            assert!(error.to_string().contains(words), "{error} lacks {words}");
        }
    }
    let attributes = [Attribute { name: "delta", values: &finite }];
    let parts = [Part { attributes: &attributes, ..Part::from(&mesh) }, Part::from(&mesh)];
    let error = write_meshes(folder.path("a.vtp"), &parts, &double("mm")).unwrap_err();
    assert!(error.to_string().contains("part 1 ():") && error.to_string().contains("same ones"));
    assert!(folder.names().is_empty());
}

#[test]
fn lines_of_vtp_have_their_numbers() {
    let folder = Folder::new();
    let (triangle, dash) =
        ([[0.0, 0.0, 0.1], [1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]], [[2.0; 3], [3.0; 3]]);
    let lines = [
        Line { points: &triangle, closed: true },
        Line { points: &[], closed: true },
        Line { points: &dash, closed: false },
    ];
    let axis = [Attribute { name: "axis", values: &[2.0, 1.0, 0.0] }];
    let path = folder.path("a.vtp");
    write_lines_with(&path, &lines, &axis, &double("mm")).unwrap();
    let file = std::fs::read(&path).unwrap();
    let vtp = Vtp::new(&file);
    assert_eq!(vtp.array("Points"), [triangle.as_flattened(), dash.as_flattened()].concat());
    assert_eq!(vtp.array("connectivity"), [0.0, 1.0, 2.0, 0.0, 3.0, 4.0]);
    assert_eq!((vtp.array("offsets"), vtp.array("axis")), (vec![4.0, 6.0], vec![2.0, 0.0]));
    assert_eq!(attribute(vtp.xml, "NumberOfLines"), "2");
    write_lines(folder.path("b.vtp"), &lines, &double("mm")).unwrap();
    // OBJ leaves them out.
    write_lines_with(folder.path("a.obj"), &lines, &axis, &double("mm")).unwrap();
    write_lines(folder.path("b.obj"), &lines, &double("mm")).unwrap();
    let text = |name| std::fs::read(folder.path(name)).unwrap();
    assert_eq!(text("a.obj"), text("b.obj"));
    let short = [Attribute { name: "axis", values: &[2.0, 1.0] }];
    let error = write_lines_with(folder.path("c.vtp"), &lines, &short, &double("mm")).unwrap_err();
    assert!(error.to_string().contains("2 values for 3 lines"));
    let error = write_lines(folder.path("c.glb"), &lines, &double("mm")).unwrap_err();
    assert!(matches!(error, Error::Extension { kind: "line", .. }));
}

fn meshes() -> impl Strategy<Value = TriMesh> {
    let points = || prop::array::uniform3(prop_oneof![-1e3..1e3, -1e30..1e30, Just(-0.0)]);
    let normal = prop::array::uniform3(-1f32..1f32);
    prop::collection::vec((points(), normal), 1..20).prop_flat_map(|vertices| {
        let count = vertices.len() as u32;
        let corners = prop::array::uniform3(0..count);
        let (vertices, normals): (Vec<_>, Vec<_>) = vertices.into_iter().unzip();
        (prop::collection::vec(corners, 0..20), any::<bool>()).prop_map(move |(triangles, with)| {
            let normals = if with { normals.clone() } else { Vec::new() };
            TriMesh { vertices: vertices.clone(), triangles, normals }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_finite_mesh_comes_back(mesh in meshes()) {
        let folder = Folder::new();
        for name in ["a.ply", "a.obj"] {
            write_mesh(folder.path(name), &mesh, &double("mm")).unwrap();
            let mut expected = mesh.clone();
            // Normals of OBJ belong to the corners of faces.
            if name == "a.obj" && mesh.triangles.is_empty() {
                expected.normals = read_mesh(folder.path(name)).unwrap().normals;
            }
            prop_assert_eq!(read_mesh(folder.path(name)).unwrap(), expected);
        }
        let file = bytes(&folder, "a.vtp", &[(&mesh).into()], &double("mm"));
        prop_assert_eq!(Vtp::new(&file).mesh(), mesh.clone());
        let (_, objects) = threemf(&bytes(&folder, "a.3mf", &[(&mesh).into()], &double("mm")));
        let mut triangles = mesh.triangles.clone();
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        match objects.as_slice() {
            [] => prop_assert!(triangles.is_empty()),
            [Decoded { mesh: found, .. }] => {
                prop_assert_eq!(&found.vertices, &mesh.vertices);
                prop_assert_eq!(&found.triangles, &triangles);
            }
            _ => prop_assert!(false),
        }
        let (_, meshes) = glb(&bytes(&folder, "a.glb", &[(&mesh).into()], &double("mm")));
        if !mesh.triangles.is_empty() {
            let found = &meshes[0].mesh;
            prop_assert_eq!(&found.triangles, &mesh.triangles);
            let size = mesh.vertices.as_flattened().iter().fold(0f64, |m, x| m.max(x.abs()));
            prop_assert!(farthest(found, &mesh) <= 1.5e-7 * size);
        }
    }
}
