//! Whatever is missing from or wrong in a file: an error, no panic, no huge allocation.

use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;
use shrouds::Select;
use shrouds_io::{
    Error, MeshOptions, VolumeOptions, read_mesh, read_occupancy, read_volume, write_mesh,
};

use crate::common::{
    Folder, Nifti, gzip, metaimage, npy, npz, nrrd, read_both, tiff, tiff_page, vti, zlib,
};
use crate::dicom::{label_map, overlapping};
use crate::meshes::octahedron;

const NRRD: &str = "type: short\ndimension: 3\nsizes: 4 3 2\nendian: big\n\
    space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,2)\nspace origin: (1,2,3)\n";

const METAIMAGE: &str = "NDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n\
    BinaryDataByteOrderMSB = True\nOffset = 1 2 3\nElementSpacing = 1 1 2\n\
    TransformMatrix = 1 0 0 0 1 0 0 0 1\n";
const SEGMENTS: &str = "type: uchar\ndimension: 4\nsizes: 1 4 3 2\nspace: RAS\n\
    kinds: list domain domain domain\nspace directions: none (1,0,0) (0,1,0) (0,0,2)\n\
    Segment0_Name:=a\nSegment0_LabelValue:=2\nSegment0_Layer:=0\nencoding: gzip\n";
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

type Named = (&'static str, Vec<u8>);

/// A sound volume file of each kind.
fn volumes() -> Vec<Named> {
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
        ("hex.nrrd", nrrd(&format!("{NRRD}encoding: hex\n"), hexadecimals(&data).as_bytes())),
        ("a.seg.nrrd", nrrd(SEGMENTS, &gzip(&data[..24]))),
        ("a.mha", metaimage(METAIMAGE, &data)),
        ("zlib.mha", metaimage(&format!("{METAIMAGE}CompressedData = True\n"), &zlib(&data))),
        ("a.dcm", label_map("1.2.840.10008.1.2.1").bytes()),
        ("deflated.dcm", label_map("1.2.840.10008.1.2.1.99").bytes()),
        ("runs.dcm", label_map("1.2.840.10008.1.2.5").bytes()),
        ("bits.dcm", overlapping().0.bytes()),
    ]
}

fn hexadecimals(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Whether the values of a file do not simply come last.
fn is_indexed(name: &str) -> bool {
    [".npz", ".vti", ".tif"].iter().any(|extension| name.ends_with(extension))
}

fn is_packed(name: &str) -> bool {
    let packed = ["gzip.nrrd", "a.nii.gz", "a.seg.nrrd", "zlib.mha", "deflated.dcm"];
    packed.contains(&name) || is_indexed(name)
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
    let options = VolumeOptions::default();
    match read_volume(path, &options) {
        Err(Error::Extension { .. }) => read_mesh(path).map(|_| ()),
        // Of layers of segments all are selected from, but only one at a time has values.
        Err(Error::Choice { .. }) => {
            let _ = read_occupancy(path, &options, &Select::NonZero);
            read_both(path, &VolumeOptions { layer: Some(0), ..options }).map(|_| ())
        }
        _ => read_both(path, &options).map(|_| ()),
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
            // Pixels are padded to an even length.
            "bits.dcm" => bytes.len() - 1,
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
            assert!(error.to_string().contains(name), "{error} does not name {name}");
        }
    }
}

#[test]
fn truncated_data_is_counted() {
    let folder = Folder::new();
    for (name, bytes) in volumes() {
        if is_packed(name) || ["hex.nrrd", "runs.dcm", "bits.dcm"].contains(&name) {
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
        // Deflate alone has no checksum.
        if is_packed(name) && !is_indexed(name) && name != "deflated.dcm" {
            let (place, method) = match name {
                "zlib.mha" => (bytes.len() - 4, "zlib"),
                _ => (bytes.len() - 8, "gzip"),
            };
            bytes[place] ^= 1;
            assert!(folder.refusal(name, &bytes).contains(method), "{name}");
        }
    }
}

#[test]
fn a_bomb_of_zeros_takes_no_more_memory_than_it_unpacks_to() {
    let folder = Folder::new();
    let zeros = vec![0; 1 << 20];
    // A thousandfold at most: what is promised beyond that is refused before it is unpacked.
    let sizes = "type: uint8\ndimension: 4\nendian: big\nencoding: gzip\n";
    let list = format!("{sizes}sizes: 1048576 2048 1024 1024\nkinds: list domain domain domain\n");
    let file = nrrd(&list, &gzip(&zeros));
    assert!(folder.refusal("a.nrrd", &file).contains("frames 0 to 1048575"));
    assert!(folder.layer("a.nrrd", 9).unwrap_err().to_string().contains("it promises"));
    let beyond =
        format!("{sizes}sizes: 9 1048574 1048574 1048574\nkinds: list domain domain domain\n");
    assert!(folder.refusal("a.nrrd", &nrrd(&beyond, &gzip(&zeros))).contains("more than a file"));
    // Seventy megabytes of zeros after the last voxel.
    let few = format!("{sizes}sizes: 1 4 3 2\n");
    let file = nrrd(&few, &gzip(&vec![0; 70 << 20]));
    assert!(folder.refusal("a.nrrd", &file).contains("follow the last voxel"));
}

/// Headers with their data in other files, and these.
fn detached() -> Vec<(&'static str, Vec<u8>, Vec<Named>)> {
    let data: Vec<u8> = (0..48).map(|n| n * 5).collect();
    let (low, high) = data.split_at(24);
    let parts = |pack: fn(&[u8]) -> Vec<u8>| vec![("s0", pack(low)), ("s1", pack(high))];
    let raw = format!("{NRRD}encoding: raw\n");
    vec![
        ("one.nhdr", nrrd(&format!("{raw}data file: s\n"), b""), vec![("s", data.clone())]),
        ("list.nhdr", nrrd(&format!("{raw}data file: LIST\ns0\ns1\n"), b""), parts(<[u8]>::to_vec)),
        (
            "gzip.nhdr",
            nrrd(&format!("{NRRD}encoding: gzip\ndata file: s%d 0 1 1 2\n"), b""),
            parts(gzip),
        ),
        (
            "zlib.mhd",
            metaimage(
                &format!("{METAIMAGE}CompressedData = True\nElementDataFile = LIST\ns0\ns1\n"),
                b"",
            ),
            parts(zlib),
        ),
    ]
}

#[test]
fn every_truncation_of_data_elsewhere_names_it() {
    for (name, header, parts) in detached() {
        let folder = Folder::new();
        let write_all = || {
            parts.iter().for_each(|(part, bytes)| {
                folder.file(part, bytes);
            })
        };
        write_all();
        let path = folder.file(name, &header);
        let whole = read_both(&path, &VolumeOptions::default()).unwrap();
        for length in 0..header.len() {
            folder.file(name, &header[..length]);
            match read_both(&path, &VolumeOptions::default()) {
                Err(error) => assert!(error.to_string().contains(name), "{error}"),
                // The last line may do without its end.
                Ok(volume) => assert_eq!(volume, whole, "{name} cut to {length}"),
            }
        }
        folder.file(name, &header);
        for (part, bytes) in &parts {
            for length in 0..bytes.len() {
                folder.file(part, &bytes[..length]);
                let error = read_any(&path).expect_err(part).to_string();
                assert!(error.contains(name) && error.contains(&format!("{part}: ")), "{error}");
            }
            write_all();
        }
    }
}

#[test]
fn absurd_headers_fail_before_memory_does() {
    let folder = Folder::new();
    let nifti = Nifti::new(&[30000, 30000, 30000], 64, false).with(&[0; 48]);
    let sizes = "type: double\ndimension: 3\nendian: big\nsizes: 30000 30000 30000\n";
    let large = "NDims = 3\nDimSize = 30000 30000 30000\nElementType = MET_DOUBLE\n";
    let shape = "(30000, 30000, 30000)";
    let files = [
        ("a.npy", npy("'<f8'", false, shape, &[0; 48])),
        ("f.npy", npy("'<f8'", true, shape, &[0; 48])),
        ("a.nii.gz", gzip(&nifti)),
        ("a.nii", nifti),
        ("a.nrrd", nrrd(&format!("{sizes}encoding: raw\n"), &[0; 48])),
        ("b.nrrd", nrrd(&format!("{sizes}encoding: gzip\n"), &gzip(&[0; 48]))),
        ("c.nrrd", nrrd(&format!("{sizes}encoding: ascii\n"), &b"1 ".repeat(24))),
        ("a.mha", metaimage(large, &[0; 48])),
        ("b.mha", metaimage(&format!("{large}CompressedData = True\n"), &zlib(&[0; 48]))),
    ];
    for (name, bytes) in files {
        let refusal = folder.refusal(name, &bytes);
        let expected = match name {
            "a.nii.gz" | "b.nrrd" | "c.nrrd" | "b.mha" => {
                "it promises 216000000000000 bytes of voxels, more than"
            }
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
        which in 0..SOUND.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (name, mut bytes) = SOUND[which].clone();
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
    fn changed_bytes_of_detached_files_never_panic(
        which in 0usize..4,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        at_header in any::<bool>(),
    ) {
        let (name, mut header, mut parts) = detached().swap_remove(which);
        let bytes = if at_header { &mut header } else { &mut parts[0].1 };
        for (place, value) in &changes {
            let length = bytes.len();
            bytes[place.index(length)] = *value;
        }
        let folder = Folder::new();
        for (part, bytes) in &parts {
            folder.file(part, bytes);
        }
        if let Err(error) = read_any(&folder.file(name, &header)) {
            prop_assert!(error.to_string().contains(name));
        }
    }

    #[test]
    fn bytes_after_a_magic_never_panic(
        which in 0usize..7,
        tail in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        let (name, magic): (&str, &[u8]) = [
            ("a.npy", &b"\x93NUMPY\x01\x00\x76\x00"[..]),
            ("a.nii", &[0x5c, 1, 0, 0]),
            ("a.nrrd", b"NRRD0005\n"),
            ("a.mha", b"NDims = 3\nDimSize = "),
            ("a.ply", b"ply\nformat binary_little_endian 1.0\n"),
            ("a.stl", b"solid\n"),
            ("a.obj", b"v 0 0 0\nf "),
        ][which];
        let folder = Folder::new();
        let _ = read_any(&folder.file(name, &[magic, &tail].concat()));
    }
}
