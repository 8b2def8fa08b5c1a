//! Whatever is missing from or wrong in a file: an error, no panic, no huge allocation.

use std::io::Write;
use std::path::Path;
use std::sync::LazyLock;

use flate2::{Compression, write::ZlibEncoder};
use proptest::prelude::*;
use shrouds_io::{Error, MeshOptions, VolumeOptions, read_mesh, write_mesh};

use crate::common::{Folder, Nifti, gzip, npy, npz, nrrd, read_both, tiff, tiff_page, vti};
use crate::meshes::octahedron;

const NRRD: &str = "type: short\ndimension: 3\nsizes: 4 3 2\nendian: big\n\
    space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,2)\nspace origin: (1,2,3)\n";

const VTI: &str = "WholeExtent=\"0 3 0 2 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"";

fn vti_array(format: &str, data: &str) -> String {
    format!(
        "<PointData Scalars=\"v\"><DataArray type=\"Int16\" Name=\"v\" format=\"{format}\">{data}\
         </DataArray></PointData>"
    )
}

/// Raw bytes in a compressed block.
fn written_vti(data: &[u8]) -> Vec<u8> {
    let array = "<PointData><DataArray type=\"Int16\" Name=\"v\" format=\"appended\" offset=\"0\"/>\
        </PointData>";
    let packed = zlib(data);
    let lengths = [1u32, 48, 48, packed.len() as u32].map(u32::to_le_bytes).concat();
    let appended = [b"<AppendedData encoding=\"raw\">_", &lengths[..], &packed].concat();
    vti("compressor=\"vtkZLibDataCompressor\"", VTI, array, &appended)
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// A sound volume file of each kind.
fn volumes() -> Vec<(&'static str, Vec<u8>)> {
    let data: Vec<u8> = (0..48).map(|n| n * 5).collect();
    let nifti = Nifti::new(&[4, 3, 2], 4, false).with(&data);
    let numbers: String = (0..24).map(|n| format!("{n} ")).collect();
    let strips = (tiff_page(4, 3, 16, 1), vec![data[..24].to_vec()]);
    let packed = zlib(&[7; 256]);
    let mut tiles = (tiff_page(20, 10, 8, 1), vec![packed.clone(), packed]);
    tiles.0.retain(|tag| tag.0 != 259 && tag.0 != 278);
    tiles.0.extend([(259, 3, vec![8]), (322, 3, vec![16]), (323, 3, vec![16])]);
    vec![
        ("a.npy", npy("'<i2'", false, "(2, 3, 4)", &data)),
        ("a.nii.gz", gzip(&nifti)),
        ("a.nii", nifti),
        ("a.npz", npz(&[("a", npy("'<i2'", false, "(2, 3, 4)", &data))], true)),
        ("stored.npz", npz(&[("a", npy("'<i2'", false, "(2, 3, 4)", &data))], false)),
        ("text.vti", vti("", VTI, &vti_array("ascii", &numbers), &[])),
        (
            "base64.vti",
            vti("", VTI, &vti_array("binary", &format!("MAAAAA=={}", "AQAB".repeat(16))), &[]),
        ),
        ("zlib.vti", written_vti(&data)),
        ("a.tif", tiff(&[strips.clone(), strips], true, false)),
        ("tiles.tif", tiff(&[tiles], false, true)),
        ("raw.nrrd", nrrd(&format!("{NRRD}encoding: raw\n"), &data)),
        ("gzip.nrrd", nrrd(&format!("{NRRD}encoding: gzip\n"), &gzip(&data))),
    ]
}

/// A sound mesh file of each kind, with the length from which on nothing of the mesh is missing.
fn meshes() -> Vec<(&'static str, Vec<u8>, usize)> {
    let folder = Folder::new();
    let mut meshes: Vec<_> = ["a.ply", "a.stl", "a.obj"]
        .map(|name| {
            write_mesh(folder.path(name), &octahedron(true), &MeshOptions::default()).unwrap();
            let bytes = std::fs::read(folder.path(name)).unwrap();
            let complete = bytes.len();
            (name, bytes, complete)
        })
        .into();
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid a\n";
    meshes.push(("text.stl", stl.into(), stl.len() - 3));
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    meshes.push(("text.ply", ply.into(), ply.len()));
    meshes
}

fn read_any(path: &Path) -> Result<(), Error> {
    match read_both(path, &VolumeOptions::default()) {
        Err(Error::Extension { .. }) => read_mesh(path).map(|_| ()),
        result => result.map(|_| ()),
    }
}

#[test]
fn every_truncation_is_an_error() {
    let folder = Folder::new();
    let volumes = volumes().into_iter().map(|(name, bytes)| {
        // The last tags of XML may be missing.
        let end_of = |tag: &[u8]| bytes.windows(tag.len()).position(|w| w == tag).unwrap();
        let complete = match name {
            "text.vti" | "base64.vti" => end_of(b"</Piece>") + 8,
            "zlib.vti" => end_of(b"\n</AppendedData>"),
            _ => bytes.len(),
        };
        (name, bytes, complete)
    });
    // Text without an end of its own may be cut anywhere and still be a mesh.
    for (name, bytes, complete) in volumes.chain(meshes()).filter(|(name, ..)| *name != "a.obj") {
        assert!(read_any(&folder.file(name, &bytes)).is_ok(), "{name}");
        for length in 0..complete {
            let error = read_any(&folder.file(name, &bytes[..length]));
            let error = error.expect_err(&format!("{name} cut to {length} of {complete}"));
            assert!(error.to_string().contains(name));
        }
    }
}

#[test]
fn truncated_data_is_counted() {
    let folder = Folder::new();
    for (name, bytes) in volumes() {
        if !["a.npy", "a.nii", "raw.nrrd"].contains(&name) {
            continue;
        }
        let refusal = folder.refusal(name, &bytes[..bytes.len() - 5]);
        assert!(refusal.contains("expected 48 bytes of voxel data, found 43"), "{refusal}");
    }
    let nifti = Nifti::new(&[4, 3, 2], 4, false).with(&[0; 43]);
    assert!(folder.refusal("a.nii.gz", &gzip(&nifti)).contains("found 43"));
}

#[test]
fn a_wrong_checksum_is_an_error() {
    let folder = Folder::new();
    for (name, mut bytes) in volumes() {
        if name == "gzip.nrrd" || name == "a.nii.gz" {
            let place = bytes.len() - 8;
            bytes[place] ^= 1;
            assert!(folder.refusal(name, &bytes).contains("gzip"), "{name}");
        }
    }
}

#[test]
fn absurd_headers_fail_before_memory_does() {
    let folder = Folder::new();
    let nifti = Nifti::new(&[30000, 30000, 30000], 64, false).with(&[0; 48]);
    let sizes = "type: double\ndimension: 3\nendian: big\nsizes: 30000 30000 30000\n";
    let shape = "(30000, 30000, 30000)";
    let files = [
        ("a.npy", npy("'<f8'", false, shape, &[0; 48])),
        ("f.npy", npy("'<f8'", true, shape, &[0; 48])),
        ("a.nii.gz", gzip(&nifti)),
        ("a.nii", nifti),
        ("a.nrrd", nrrd(&format!("{sizes}encoding: raw\n"), &[0; 48])),
        ("b.nrrd", nrrd(&format!("{sizes}encoding: gzip\n"), &gzip(&[0; 48]))),
    ];
    for (name, bytes) in files {
        let refusal = folder.refusal(name, &bytes);
        let expected = match name {
            "a.nii.gz" | "b.nrrd" => "it promises 216000000000000 bytes of voxels, more than",
            _ => "expected 216000000000000 bytes of voxel data, found 48",
        };
        assert!(refusal.contains(expected), "{refusal}");
    }
    let many = usize::MAX;
    let beyond = [
        npy("'<f8'", false, &format!("({many}, {many}, {many})"), &[]),
        npy("'<f8'", false, &format!("(1, 1, {})", 1 << 20), &[]),
    ];
    for bytes in beyond {
        assert!(folder.refusal("a.npy", &bytes).contains("between 1 and"));
    }
    assert!(folder.refusal("a.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\xff{").contains("length"));
    let mut far = Nifti::new(&[1, 1, 1], 2, false);
    far.put(108, 8e15f32);
    assert!(folder.refusal("a.nii", &far.with(&[1])).contains("found 0"));
    let stl = [&[b'x'; 80][..], &u32::MAX.to_le_bytes(), &[0; 50]].concat();
    assert!(matches!(read_mesh(folder.file("a.stl", &stl)), Err(Error::Mesh { .. })));
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n\
        property float x\nproperty float y\nproperty float z\nend_header\n";
    let ply = [header.as_bytes(), &[0; 120]].concat();
    let error = read_mesh(folder.file("a.ply", &ply)).unwrap_err().to_string();
    assert!(error.contains("ends at vertex 10"), "{error}");
}

/// Made once: every case of a property changes one of them.
static SOUND: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let meshes = meshes().into_iter().map(|(name, bytes, _)| (name, bytes));
    volumes().into_iter().chain(meshes).collect()
});

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn changed_bytes_never_panic(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (name, mut bytes) = SOUND[which.index(SOUND.len())].clone();
        for (place, value) in &changes {
            let length = bytes.len();
            bytes[place.index(length)] = *value;
        }
        let folder = Folder::new();
        // A change may leave the file sound; an error must name it.
        if let Err(error) = read_any(&folder.file(name, &bytes)) {
            prop_assert!(error.to_string().contains(name));
        }
    }

    #[test]
    fn changed_nifti_headers_inside_gzip_never_panic(
        changes in prop::collection::vec((0usize..352, any::<u8>()), 1..4),
        big in any::<bool>(),
    ) {
        let mut bytes = Nifti::new(&[4, 3, 2], 16, big).with(&[0; 96]);
        for (place, value) in &changes {
            bytes[*place] = *value;
        }
        let folder = Folder::new();
        if let Err(error) = read_any(&folder.file("a.nii.gz", &gzip(&bytes))) {
            prop_assert!(error.to_string().contains("a.nii.gz"));
        }
    }

    #[test]
    fn bytes_after_a_magic_never_panic(
        which in 0usize..6,
        tail in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        let (name, magic): (&str, &[u8]) = [
            ("a.npy", &b"\x93NUMPY\x01\x00\x76\x00"[..]),
            ("a.nii", &[0x5c, 1, 0, 0]),
            ("a.nrrd", b"NRRD0005\n"),
            ("a.ply", b"ply\nformat binary_little_endian 1.0\n"),
            ("a.stl", b"solid\n"),
            ("a.obj", b"v 0 0 0\nf "),
        ][which];
        let folder = Folder::new();
        let _ = read_any(&folder.file(name, &[magic, &tail].concat()));
    }
}
