//! Mesh files come back as they went out, and files of other programs are read.

use shrouds::TriMesh;
use shrouds_io::{
    Error, Frame, Line, MeshFormat, MeshOptions, Precision, mesh_format, read_mesh, write_lines,
    write_mesh,
};

use crate::common::Folder;

/// An octahedron whose coordinates are not exact in 32 bits.
pub(crate) fn octahedron(normals: bool) -> TriMesh {
    let axes: Vec<[f64; 3]> = (0..6)
        .map(|n| std::array::from_fn(|k| if k == n / 2 { 1.0 - 2.0 * (n % 2) as f64 } else { 0.0 }))
        .collect();
    let vertices = axes.iter().map(|v| v.map(|x| 0.1 + 1.1 * x)).collect();
    let mut triangles = Vec::new();
    for (x, y, z) in (0..8).map(|n| (n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2 & 1))) {
        let flipped = (x + y + z) % 2 == 1;
        triangles.push(if flipped { [x, z, y] } else { [x, y, z] });
    }
    let axes = axes.iter().map(|axis| axis.map(|x| x as f32)).collect();
    TriMesh { vertices, triangles, normals: if normals { axes } else { Vec::new() } }
}

fn options(precision: Precision) -> MeshOptions {
    let frame = Frame { name: "LPS".into(), unit: "mm".into(), source: "space directions" };
    MeshOptions { precision, frame: Some(frame) }
}

fn round_trip(name: &str, mesh: &TriMesh, options: &MeshOptions) -> TriMesh {
    let folder = Folder::new();
    write_mesh(folder.path(name), mesh, options).unwrap();
    assert_eq!(folder.names(), [name], "nothing else stays");
    read_mesh(folder.path(name)).unwrap()
}

fn single(mesh: &TriMesh) -> TriMesh {
    let round = |points: &[[f64; 3]]| {
        points.iter().map(|p| p.map(|x| f64::from(x as f32))).collect::<Vec<_>>()
    };
    TriMesh {
        vertices: round(&mesh.vertices),
        triangles: mesh.triangles.clone(),
        normals: mesh.normals.clone(),
    }
}

#[test]
fn ply_keeps_everything_in_both_precisions() {
    for mesh in [octahedron(true), octahedron(false), TriMesh::default()] {
        assert_eq!(round_trip("a.ply", &mesh, &options(Precision::Double)), mesh);
        assert_eq!(round_trip("a.PLY", &mesh, &options(Precision::Single)), single(&mesh));
    }
}

#[test]
fn obj_text_reads_back_to_the_same_bits() {
    for mesh in [octahedron(true), octahedron(false), TriMesh::default()] {
        assert_eq!(round_trip("a.obj", &mesh, &options(Precision::Double)), mesh);
        // The shortest text of a 32-bit float, read with 64 bits, is near it but not the same.
        let back = round_trip("a.obj", &mesh, &options(Precision::Single));
        assert_eq!((single(&back), back.triangles.len()), (single(&mesh), mesh.triangles.len()));
    }
}

#[test]
fn stl_gives_back_each_triangle_and_one_vertex_per_place() {
    let mesh = octahedron(false);
    let back = round_trip("a.stl", &mesh, &MeshOptions::default());
    let corners = |mesh: &TriMesh| -> Vec<[[f64; 3]; 3]> {
        mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])).collect()
    };
    assert_eq!(corners(&back), corners(&single(&mesh)));
    assert_eq!(back.vertices.len(), 6);
    assert_eq!(
        round_trip("a.stl", &TriMesh::default(), &MeshOptions::default()),
        TriMesh::default()
    );
}

#[test]
fn stl_normals_point_outside_and_minus_zero_is_zero() {
    let folder = Folder::new();
    let mesh = TriMesh {
        vertices: vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, -0.0], [0.0, -0.0, 0.0]],
        triangles: vec![[0, 1, 2], [3, 2, 1], [0, 3, 1]],
        normals: Vec::new(),
    };
    write_mesh(folder.path("a.stl"), &mesh, &MeshOptions::default()).unwrap();
    let bytes = std::fs::read(folder.path("a.stl")).unwrap();
    assert_eq!(bytes.len(), 84 + 3 * 50);
    assert!(!bytes.starts_with(b"solid"));
    let floats = |at: usize| -> Vec<f32> {
        bytes[at..at + 12].as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()
    };
    assert_eq!([floats(84), floats(134)], [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    assert_eq!(floats(184), [0.0; 3], "a triangle without area has no normal");
    assert_eq!(
        read_mesh(folder.path("a.stl")).unwrap().triangles,
        [[0, 1, 2], [0, 2, 1], [0, 0, 1]]
    );
}

#[test]
fn comments_name_the_frame_as_3d_slicer_reads_it() {
    let folder = Folder::new();
    let mut options = options(Precision::Single);
    for name in ["a.ply", "a.stl", "a.obj"] {
        write_mesh(folder.path(name), &octahedron(true), &options).unwrap();
        let bytes = std::fs::read(folder.path(name)).unwrap();
        assert!(String::from_utf8_lossy(&bytes).contains("SPACE=LPS UNIT=mm"), "{name}");
    }
    // A frame name from a file cannot break out of the comment.
    options.frame =
        Some(Frame { name: "a\nend_header\n".repeat(20), unit: "µm".into(), source: "" });
    for name in ["a.ply", "a.stl", "a.obj"] {
        write_mesh(folder.path(name), &octahedron(true), &options).unwrap();
        assert_eq!(read_mesh(folder.path(name)).unwrap().triangles.len(), 8, "{name}");
    }
}

#[test]
fn plys_of_others_are_read() {
    let folder = Folder::new();
    // Text, normals after the colours, a list to pass over, an unknown element, a quadrangle.
    let text = "ply\r\nformat ascii 1.0\r\ncomment x\r\nobj_info y\r\nelement vertex 4\r\n\
        property uchar red\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n\
        property list uchar int seen\r\nelement camera 1\r\nproperty list uchar float view\r\n\
        element face 2\r\nproperty float quality\r\nproperty list uint8 uint32 vertex_index\r\n\
        end_header\r\n255 0 0 0 0\r\n255 1 0 0 2 7 8\r\n255 1 1e0 0 0\r\n255 0 1 0.5 1 3\r\n\
        2 1.5 2.5\r\n0.25 4 0 1 2 3\r\n0.5 3 0 2 3\r\n";
    let mesh = read_mesh(folder.file("a.ply", text.as_bytes())).unwrap();
    assert_eq!(mesh.vertices, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    // Big endian, faces before vertices.
    let mut big = b"ply\nformat binary_big_endian 1.0\nelement face 1\n\
        property list ushort short vertex_indices\nelement vertex 3\nproperty float x\n\
        property short y\nproperty double z\nend_header\n"
        .to_vec();
    big.extend([0, 3, 0, 2, 0, 1, 0, 0]);
    for (x, y, z) in [(0.5f32, -2i16, 0.25f64), (1.0, 300, 0.0), (0.0, 0, -1.0)] {
        big.extend([&x.to_be_bytes()[..], &y.to_be_bytes(), &z.to_be_bytes()].concat());
    }
    let mesh = read_mesh(folder.file("a.ply", &big)).unwrap();
    assert_eq!(mesh.vertices, [[0.5, -2.0, 0.25], [1.0, 300.0, 0.0], [0.0, 0.0, -1.0]]);
    assert_eq!(mesh.triangles, [[2, 1, 0]]);
}

#[test]
fn stl_text_is_read() {
    let folder = Folder::new();
    let text = "SOLID a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 -0.0\n   vertex 1e0 0 0\n\
        vertex 0 1 0\n endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 0 0\n\
        vertex 0 0.5 0\nendloop\nendfacet\nendsolid a b";
    let mesh = read_mesh(folder.file("a.stl", text.as_bytes())).unwrap();
    assert_eq!(mesh.vertices.len(), 4);
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 0, 3]]);
}

#[test]
fn objs_of_others_are_read() {
    let folder = Folder::new();
    let text = "mtllib a.mtl\no thing\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\n\
        usemtl m\ns off\nf 1/1/1 2/1/1 3/1/1\ng more\nv 0 1 0\nf -4 -2// -1//1\nf 1 2 3 4\n";
    let mesh = read_mesh(folder.file("a.obj", text.as_bytes())).unwrap();
    assert_eq!(mesh.vertices[3], [0.0, 1.0, 0.0]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3]]);
    assert!(mesh.normals.is_empty(), "one normal for all is none for each");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n";
    let normals = |face: &str| {
        read_mesh(folder.file("a.obj", format!("{text}{face}").as_bytes())).unwrap().normals.len()
    };
    assert_eq!([normals("f 1//1 2//2 3//3"), normals("f 1//1 2//3 3//2")], [3, 0]);
    assert_eq!([normals("f 1/4/1 2/4/2 3/4/3"), normals("f 1 2 3")], [3, 0]);
}

#[test]
fn unfit_meshes_are_refused_and_leave_nothing() {
    let folder = Folder::new();
    let change = |change: fn(&mut TriMesh)| {
        let mut mesh = octahedron(true);
        change(&mut mesh);
        mesh
    };
    let meshes = [
        change(|mesh| mesh.triangles[3][1] = 6),
        change(|mesh| mesh.vertices[2][0] = f64::NAN),
        change(|mesh| mesh.vertices[2][0] = 1e300),
        change(|mesh| mesh.normals.truncate(5)),
    ];
    for (mesh, name) in meshes.iter().flat_map(|m| ["a.ply", "a.stl", "a.obj"].map(|n| (m, n))) {
        let error = write_mesh(folder.path(name), mesh, &MeshOptions::default());
        assert!(matches!(error, Err(Error::Unwritable { .. })), "{name}");
    }
    let double = MeshOptions { precision: Precision::Double, frame: None };
    assert!(write_mesh(folder.path("b.stl"), &meshes[2], &double).is_err());
    let error = write_mesh(folder.path("c.vtk"), &octahedron(true), &double).unwrap_err();
    assert!(error.to_string().contains(".ply, .stl and .obj"));
    assert!(folder.names().is_empty());
    assert!(write_mesh(folder.path("c.ply"), &meshes[2], &double).is_ok());
}

#[test]
fn damaged_meshes_are_refused() {
    let folder = Folder::new();
    let ply = |vertex: &str, face: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
             end_header\n0 0 0\n1 0 0\n{vertex}\n{face}\n"
        )
    };
    assert!(read_mesh(folder.file("a.ply", ply("0 1 0", "3 0 1 2").as_bytes())).is_ok());
    let header = "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\n";
    let cases: Vec<(&str, String, &str)> = vec![
        ("a.ply", ply("0 nan 0", "3 0 1 2"), "vertex 2"),
        ("a.ply", ply("0 1e39 0", "3 0 1 2"), "vertex 2"),
        ("a.ply", ply("0 1 x", "3 0 1 2"), "vertex 2"),
        ("a.ply", ply("0 1 0", "3 0 1 3"), "3 vertices"),
        ("a.ply", ply("0 1 0", "3 0 1 -1"), "the vertex -1"),
        ("a.ply", ply("0 1 0", "2 0 1"), "2 corners"),
        ("a.ply", ply("0 1 0", "0"), "no corners"),
        ("a.ply", format!("{header}end_header\n"), "no properties"),
        ("a.ply", format!("{header}property float x\nend_header\n"), "no x, y, z"),
        ("a.ply", header.replace("vertex", "tristrips") + "end_header\n", "strips"),
        ("a.ply", "ply\nend_header\n".into(), "no format"),
        ("a.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n".into(), "before"),
        ("a.ply", "PLY".into(), "not a PLY"),
        ("a.stl", "x".repeat(200), "triangles take"),
        ("a.stl", "x".into(), "not an STL"),
        ("a.stl", "solid\nfacet\nvertex 0 0 0\nendfacet\nendsolid\n".into(), "1 corners"),
        ("a.stl", "solid\nvertex 0 0\nendsolid\n".into(), "three numbers"),
        ("a.stl", "solid\nhello\nendsolid\n".into(), "hello"),
        ("a.stl", "solid\n".into(), "no endsolid"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n".into(), "3 vertices"),
        ("a.obj", "v 0 0 0\nf 1 0 1\n".into(), "names no vertex"),
        ("a.obj", "v 0 0 0\nf 1 -2 1\n".into(), "names no vertex"),
        ("a.obj", "v 0 0\n".into(), "three numbers"),
        ("a.obj", "v 0 inf 0\n".into(), "not finite"),
        ("a.obj", "f 1 2 3 \\\n".into(), "names no vertex"),
        ("a.obj", "\0".into(), "not an OBJ"),
    ];
    for (name, text, word) in cases {
        let error = read_mesh(folder.file(name, text.as_bytes())).expect_err(&text).to_string();
        assert!(error.contains(word) && error.contains(name), "{error} lacks {word}");
    }
}

#[test]
fn normals_that_are_no_numbers_are_left_out() {
    let folder = Folder::new();
    let mut text = "ply\nformat ascii 1.0\nelement vertex 1\n".to_string();
    ["x", "y", "z", "nx", "ny", "nz"]
        .iter()
        .for_each(|name| text.push_str(&format!("property float {name}\n")));
    let read = |values: &str| {
        let text = format!("{text}end_header\n{values}\n");
        read_mesh(folder.file("a.ply", text.as_bytes())).unwrap().normals
    };
    assert_eq!(read("0 0 0 0 0 1"), [[0.0, 0.0, 1.0]]);
    assert!(read("0 0 0 0 nan 1").is_empty());
}

#[test]
fn lines_are_points_and_the_order_to_join_them() {
    let folder = Folder::new();
    let (triangle, dash) =
        ([[0.0, 0.0, 0.1], [1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]], [[2.0; 3], [3.0; 3]]);
    let lines = [
        Line { points: &triangle, closed: true },
        Line { points: &[], closed: true },
        Line { points: &dash, closed: false },
    ];
    let options = MeshOptions { precision: Precision::Double, ..MeshOptions::default() };
    let path = folder.path("a.obj");
    write_lines(&path, &lines, &options).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let (comment, rest) = text.split_once('\n').unwrap();
    assert!(comment.starts_with("# shrouds "));
    assert_eq!(rest, "v 0 0 0.1\nv 1 0 0\nv 0 1e-9 0\nv 2 2 2\nv 3 3 3\nl 1 2 3 1\nl 4 5\n");
    // To a reader of meshes they are points.
    assert_eq!(read_mesh(&path).unwrap().vertices.len(), 5);
    let refused = |path: &str, x: f64| {
        let points = [[x; 3]];
        let lines = [Line { points: &points, closed: false }];
        write_lines(folder.path(path), &lines, &options).unwrap_err()
    };
    assert!(matches!(refused("a.ply", 0.0), Error::Extension { kind: "line", .. }));
    assert!(matches!(refused("b.obj", f64::NAN), Error::Unwritable { .. }));
    assert!(!folder.path("b.obj").exists());
}

#[test]
fn formats_are_known_by_extension_alone() {
    assert_eq!(mesh_format("no/such/a.Ply").unwrap(), MeshFormat::Ply);
    assert_eq!(mesh_format("a.b.stl").unwrap(), MeshFormat::Stl);
    assert_eq!(mesh_format("a.obj").unwrap(), MeshFormat::Obj);
    for name in ["a", "ply", ".ply", "a.ply.gz", ""] {
        assert!(matches!(mesh_format(name), Err(Error::Extension { .. })), "{name}");
        assert!(matches!(read_mesh(name), Err(Error::Extension { .. })), "{name}");
    }
}
