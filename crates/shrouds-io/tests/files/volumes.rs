//! Volume files made byte by byte are read as their formats prescribe.

use std::cell::RefCell;

use crate::common::{Folder, Nifti, bytes, cases, datatype, gzip, npy, nrrd, read_both};
use shrouds::{Grid, Occupancy, Select};
use shrouds_io::{
    Axes, Error, Frame, Values, VolumeOptions, read_volume, volume_format, write_npy, write_volume,
};

const DIMS: [usize; 3] = [4, 3, 2];

#[test]
fn npy_holds_every_type_in_both_byte_orders() {
    let folder = Folder::new();
    for (big, mark) in [(false, '<'), (true, '>')] {
        for case in cases(big) {
            let size = case.bytes.len() / 24;
            let kind = &case.name[..1];
            let descr = format!("'{}{kind}{size}'", if size == 1 { '|' } else { mark });
            let volume = folder.volume("a.npy", &npy(&descr, false, "(2, 3, 4)", &case.bytes));
            let volume = volume.unwrap();
            assert_eq!((volume.grid.dims(), &volume.values), (DIMS, &case.values));
            assert_eq!(volume.values.type_name(), case.name);
        }
    }
    let bits: Vec<u8> = (0..24).map(|n| n % 3 % 2).collect();
    let volume = folder.volume("a.npy", &npy("'|b1'", false, "(2, 3, 4)", &bits)).unwrap();
    assert_eq!(volume.values, Values::Bool(bits.iter().map(|b| *b == 1).collect()));
    let halves = bytes(&[0x3c00u16; 24], true);
    let volume = folder.volume("a.npy", &npy("'>f2'", false, "(2L, 3L, 4L)", &halves)).unwrap();
    assert_eq!(volume.values, Values::F32(vec![1.0; 24]));
}

#[test]
fn npy_orders_and_axes_agree_on_where_a_value_lies() {
    let folder = Folder::new();
    let value = |[i, j, k]: [usize; 3]| (100 * i + 10 * j + k) as u16;
    let x_fastest: Vec<u16> = (0..24).map(|n| value([n % 4, n / 4 % 3, n / 12])).collect();
    let z_fastest: Vec<u16> = (0..24).map(|n| value([n / 6, n / 2 % 3, n % 2])).collect();
    let cases = [
        (Axes::Zyx, false, "(2, 3, 4)", &x_fastest),
        (Axes::Zyx, true, "(2, 3, 4)", &z_fastest),
        (Axes::Xyz, false, "(4, 3, 2)", &z_fastest),
        (Axes::Xyz, true, "(4, 3, 2)", &x_fastest),
    ];
    for (axes, fortran, shape, stored) in cases {
        let path = folder.file("a.npy", &npy("'<u2'", fortran, shape, &bytes(stored, false)));
        let options =
            VolumeOptions { axes, spacing: Some([0.5, 1.0, 2.0]), ..VolumeOptions::default() };
        let volume = read_both(&path, &options).unwrap();
        assert_eq!(volume.values, Values::U16(x_fastest.clone()), "{axes:?} {fortran}");
        assert_eq!(volume.grid, Grid::new(DIMS, [0.5, 1.0, 2.0]).unwrap());
    }
}

#[test]
fn npy_axes_of_length_one_beyond_three_do_not_count() {
    let folder = Folder::new();
    let data: Vec<u8> = (0..6).collect();
    let read = |shape| folder.volume("a.npy", &npy("'|u1'", false, shape, &data));
    for shape in ["(1, 2, 3, 1)", "(1, 1, 2, 3)", "(1, 1, 1, 2, 3, 1)"] {
        assert_eq!(read(shape).unwrap(), read("(1, 2, 3)").unwrap(), "{shape}");
    }
    assert_eq!(read("(2, 3, 1, 1)").unwrap(), read("(2, 3, 1)").unwrap());
    for shape in ["(1, 6)", "(2, 1, 1, 3)"] {
        assert!(read(shape).unwrap_err().to_string().contains("three dimensions"), "{shape}");
    }
}

#[test]
fn npy_versions_two_and_three_have_long_headers() {
    let folder = Folder::new();
    let header = b"{'shape':(1,1,2),'fortran_order':False,'descr':'|u1'}\n";
    for version in [2, 3] {
        let start = [b"\x93NUMPY", &[version, 0][..], &(header.len() as u32).to_le_bytes()];
        let file = [&start.concat(), &header[..], &[7, 9]].concat();
        assert_eq!(folder.volume("a.npy", &file).unwrap().values, Values::U8(vec![7, 9]));
    }
}

#[test]
fn a_written_occupancy_is_read_back() {
    let folder = Folder::new();
    for nx in [1, 63, 64, 65, 130] {
        let grid = Grid::new([nx, 3, 2], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |[i, j, k]| (i * 7 + j * 5 + k * 3) % 4 == 0);
        write_npy(folder.path("a.npy"), &volume).unwrap();
        let back = read_both(&folder.path("a.npy"), &VolumeOptions::default()).unwrap();
        assert_eq!(back.values.type_name(), "u8");
        assert_eq!(back.occupancy(&Select::NonZero).unwrap(), volume);
        let file = std::fs::read(folder.path("a.npy")).unwrap();
        assert_eq!((file.len() - nx * 6) % 64, 0, "the data is aligned as NumPy aligns it");
    }
}

#[test]
fn a_written_volume_keeps_what_its_format_can() {
    let folder = Folder::new();
    let affine = [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 1.0 / 3.0]];
    let oblique = Grid::with_affine([67, 3, 2], affine).unwrap();
    let straight = Grid::new([67, 3, 2], [0.1, 1e-9, 2e9]).unwrap();
    let frame =
        |name: &str, unit: &str, source| Frame { name: name.into(), unit: unit.into(), source };
    for (grid, name, unit, again) in [
        (&oblique, "LPS", "mm", frame("LPS", "mm", "space directions")),
        (&oblique, "RAS", "um", frame("RAS", "um", "space directions")),
        (&oblique, "scanner-xyz", "mm", frame("scanner-xyz", "mm", "space directions")),
        (&oblique, "index", "unknown", frame("unnamed", "unknown", "space directions")),
        (&oblique, "my\nworld", "a \"b\"", frame("unnamed", "unknown", "space directions")),
        (&straight, "index", "m", frame("index", "m", "spacings")),
        (&straight, "index", "unknown", frame("index", "unknown", "spacings")),
    ] {
        let volume = Occupancy::from_fn(grid.clone(), |[i, j, k]| (i * 7 + j * 5 + k * 3) % 4 == 0);
        write_volume(folder.path("a.nrrd"), &volume, &frame(name, unit, "test")).unwrap();
        let back = read_both(&folder.path("a.nrrd"), &VolumeOptions::default()).unwrap();
        assert_eq!(back.frame, again, "{name}");
        assert_eq!(back.occupancy(&Select::NonZero).unwrap(), volume);
    }
    let volume = Occupancy::empty(straight);
    for name in ["a.ply", "a", "a.raw"] {
        let error = write_volume(folder.path(name), &volume, &frame("index", "mm", "test"));
        assert!(matches!(error, Err(Error::Extension { .. })));
    }
    assert_eq!(folder.names(), ["a.nrrd"]);
}

#[test]
fn nifti_holds_every_type_in_both_byte_orders_plain_and_compressed() {
    let folder = Folder::new();
    for big in [false, true] {
        for case in cases(big) {
            let file = Nifti::new(&[4, 3, 2], datatype(case.name), big).with(&case.bytes);
            for (name, file) in [("a.nii", file.clone()), ("A.NII.GZ", gzip(&file))] {
                let volume = folder.volume(name, &file).unwrap();
                assert_eq!((volume.grid.dims(), &volume.values), (DIMS, &case.values), "{name}");
            }
        }
    }
}

#[test]
fn nifti_scaling_makes_floats_and_only_where_there_is_any() {
    let folder = Folder::new();
    let values = |slope: f32, intercept: f32| {
        let mut file = Nifti::new(&[2, 1, 1], datatype("i16"), false);
        file.put(112, slope).put(116, intercept);
        folder.volume("a.nii", &file.with(&bytes(&[-3i16, 4], false))).map(|v| v.values)
    };
    assert_eq!(values(0.5, 10.0).unwrap(), Values::F64(vec![8.5, 12.0]));
    assert_eq!(values(1.0, -1.0).unwrap(), Values::F64(vec![-4.0, 3.0]));
    for (slope, intercept) in [(0.0, 5.0), (1.0, 0.0), (f32::NAN, f32::NAN), (f32::NAN, 2.0)] {
        assert_eq!(values(slope, intercept).unwrap(), Values::I16(vec![-3, 4]));
    }
    assert!(values(2.0, f32::NAN).unwrap_err().to_string().contains("scl_inter"));
}

#[test]
fn nifti_frames_follow_the_order_sform_qform_spacings() {
    let folder = Folder::new();
    let mut file = Nifti::new(&[4, 3, 2], datatype("u8"), true);
    file.put_all(76, &[-1f32, 2.0, 3.0, 5.0]).put_all(268, &[7f32, 8.0, 9.0]);
    file.put_all(280, &[0f32, -2.0, 0.0, 1.0, 3.0, 0.0, 0.0, 2.0, 0.0, 0.5, 4.0, 3.0]);
    let mut read = |qform: i16, sform: i16, unit: u8| {
        file.put(252, qform).put(254, sform).header[123] = unit;
        let volume = folder.volume("a.nii", &file.with(&[1; 24])).unwrap();
        (volume.grid.affine(), volume.frame)
    };
    let frame =
        |name: &str, unit: &str, source| Frame { name: name.into(), unit: unit.into(), source };
    let sform = [[0.0, -2.0, 0.0, 1.0], [3.0, 0.0, 0.0, 2.0], [0.0, 0.5, 4.0, 3.0]];
    assert_eq!(read(1, 4, 2), (sform, frame("RAS", "mm", "sform")));
    assert_eq!(read(0, 1, 3 | 8), (sform, frame("RAS", "um", "sform")));
    let qform = [[2.0, 0.0, 0.0, 7.0], [0.0, 3.0, 0.0, 8.0], [0.0, 0.0, -5.0, 9.0]];
    assert_eq!(read(1, 0, 1), (qform, frame("RAS", "m", "qform")));
    let spacings = [[2.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 5.0, 0.0]];
    assert_eq!(read(0, 0, 0), (spacings, frame("index", "unknown", "pixdim")));
}

#[test]
fn a_given_spacing_replaces_an_unusable_frame() {
    let folder = Folder::new();
    let mut file = Nifti::new(&[1, 1, 2], datatype("u8"), false);
    file.put(254, 1i16); // An sform of zeros.
    assert!(folder.refusal("a.nii", &file.with(&[1, 2])).contains("give the spacing"));
    file.put(254, 0i16).put(80, -1f32);
    assert!(folder.refusal("a.nii", &file.with(&[1, 2])).contains("give the spacing"));
    let options = VolumeOptions { spacing: Some([1.0, 2.0, 3.0]), ..VolumeOptions::default() };
    let volume = read_both(&folder.path("a.nii"), &options).unwrap();
    assert_eq!((volume.grid.spacing(), volume.frame.source), ([1.0, 2.0, 3.0], "options"));
}

#[test]
fn nifti_dimensions_of_one_are_dropped() {
    let folder = Folder::new();
    let read = |dims: &[i16]| {
        let file = Nifti::new(dims, datatype("u8"), false).with(&[1; 120]);
        folder.volume("a.nii", &file).map(|volume| volume.grid.dims())
    };
    assert_eq!(read(&[4, 3]).unwrap(), [4, 3, 1]);
    assert_eq!(read(&[4, 3, 2, 1, 1]).unwrap(), [4, 3, 2]);
    for dims in [&[4, 0, 2][..], &[4, -3, 2], &[]] {
        assert!(matches!(read(dims), Err(Error::Header { .. })));
    }
}

#[test]
fn nifti_data_may_start_later_and_end_earlier_than_the_file() {
    let folder = Folder::new();
    let mut file = Nifti::new(&[2, 1, 1], datatype("u8"), false);
    file.put(108, 368f32);
    let bytes = file.with(&[[0; 16].as_slice(), &[5, 6, 99, 99]].concat());
    for (name, bytes) in [("a.nii", bytes.clone()), ("a.nii.gz", gzip(&bytes))] {
        assert_eq!(folder.volume(name, &bytes).unwrap().values, Values::U8(vec![5, 6]));
    }
    for offset in [100f32, -1.0, f32::NAN, f32::INFINITY, 1e30, 352.5] {
        let refusal = folder.refusal("a.nii", &file.put(108, offset).with(&[5, 6]));
        assert!(refusal.contains("starts at byte"), "{refusal}");
    }
}

#[test]
fn nifti_two_is_read_like_nifti_one() {
    let folder = Folder::new();
    for big in [false, true] {
        let mut file = Nifti { header: vec![0; 544], big };
        file.header[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
        file.put(0, 540i32).put(12, datatype("i16")).put_all(16, &[3i64, 2, 1, 1]);
        file.put_all(104, &[1f64, 2.0, 3.0, 5.0]).put(168, 544i64).put(176, 2f64);
        file.put(344, 1i32).put_all(376, &[7f64, 8.0, 9.0]).put(500, 2i32);
        let volume = folder.volume("a.nii", &file.with(&bytes(&[3i16, -4], big))).unwrap();
        assert_eq!(volume.values, Values::F64(vec![6.0, -8.0]));
        assert_eq!(volume.grid.point([1.0; 3]), [9.0, 11.0, 14.0]);
        assert_eq!((volume.frame.unit.as_str(), volume.frame.source), ("mm", "qform"));
    }
}

#[test]
fn several_gzip_members_are_one_file() {
    let folder = Folder::new();
    let case = &cases(false)[3];
    let file = Nifti::new(&[4, 3, 2], datatype(case.name), false).with(&case.bytes);
    let members = [gzip(&file[..200]), gzip(&file[200..371]), gzip(&file[371..])].concat();
    assert_eq!(folder.volume("a.nii.gz", &members).unwrap().values, case.values);
}

#[test]
fn nrrd_holds_every_type_by_every_name() {
    let folder = Folder::new();
    let names = [
        ("u8", "uchar|unsigned char|uint8|uint8_t"),
        ("i8", "signed char|int8|int8_t"),
        ("u16", "ushort|unsigned short|unsigned short int|uint16|uint16_t"),
        ("i16", "short|short int|signed short|signed short int|int16|int16_t"),
        ("u32", "uint|unsigned int|uint32|uint32_t"),
        ("i32", "int|signed int|int32|int32_t"),
        ("u64", "ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t"),
        (
            "i64",
            "longlong|long long|long long int|signed long long|signed long long int|int64|int64_t",
        ),
        ("f32", "float"),
        ("f64", "double"),
    ];
    for (big, endian) in [(false, "little"), (true, "big")] {
        for case in cases(big) {
            let (_, names) = names.iter().find(|(name, _)| *name == case.name).unwrap();
            for name in names.split('|') {
                let fields =
                    format!("type: {name}\ndimension: 3\nsizes: 4 3 2\nendian: {endian}\n");
                let raw = nrrd(&format!("{fields}encoding: raw\n"), &case.bytes);
                let packed = nrrd(&format!("{fields}encoding: gzip\n"), &gzip(&case.bytes));
                for file in [raw, packed] {
                    let volume = folder.volume("a.nrrd", &file).unwrap();
                    assert_eq!((volume.grid.dims(), &volume.values), (DIMS, &case.values));
                }
            }
        }
    }
}

#[test]
fn nrrd_frames_come_from_directions_or_spacings() {
    let folder = Folder::new();
    let read = |fields: &str| {
        let start = "type: uint8\r\nDimension: 3\nsizes: 4 3 2\nencoding: raw\nkey:=a: b\n";
        let volume = folder.volume("a.nrrd", &nrrd(&format!("{start}{fields}"), &[1; 24])).unwrap();
        let Frame { name, unit, source } = volume.frame;
        (volume.grid.affine(), format!("{name} {unit} {source}"))
    };
    let affine = [[0.0, -2.0, 0.0, -10.0], [3.0, 0.0, 0.0, 20.5], [0.0, 0.5, 4.0, 1e-3]];
    let directions =
        "space directions: (0, 3,0) (-2,0,0.5) (0,0,4)\nspace origin: (-10,20.5,1e-3)\n";
    let lps = format!("space: left-posterior-superior\n{directions}");
    assert_eq!(read(&lps), (affine, "LPS mm space directions".into()));
    let ras = format!("space: RAS\nspace units: \"um\" \"um\" \"um\"\n{directions}");
    assert_eq!(read(&ras), (affine, "RAS um space directions".into()));
    let unnamed = format!("space dimension: 3\n{directions}");
    assert_eq!(read(&unnamed), (affine, "unnamed unknown space directions".into()));
    let at_zero = affine.map(|[x, y, z, _]| [x, y, z, 0.0]);
    assert_eq!(read(&directions.replace("space origin", "# no origin")).0, at_zero);
    let spacings = [[2.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 5.0, 0.0]];
    assert_eq!(read("spacings: 2 3 5\n"), (spacings, "index unknown spacings".into()));
    let none = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    assert_eq!(read(""), (none, "index unknown none".into()));
}

#[test]
fn what_cannot_be_read_is_said_with_a_way_out() {
    let folder = Folder::new();
    let data = [0; 512];
    let nifti = |datatype| Nifti::new(&[2, 2, 2], datatype, false).with(&data);
    let mut pair = Nifti::new(&[2, 2, 2], 2, false);
    pair.header[344..348].copy_from_slice(b"ni1\0");
    let mut matrix = Nifti::new(&[1, 1, 1, 1, 4, 4], 16, false);
    matrix.put(68, 3001i16);
    let nrrd_with = |fields: &str| {
        nrrd(&format!("type: short\nsizes: 2 2 2\ndimension: 3\nendian: big\n{fields}\n"), &data)
    };
    let npy_with = |descr: &str, shape: &str| npy(descr, false, shape, &data);
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("a.nii", nifti(128), "colours"),
        ("a.nii", nifti(32), "complex"),
        ("a.nii", nifti(77), "does not exist"),
        ("a.nii", pair.with(&data), "call it .hdr"),
        ("a.nii", matrix.with(&data), "CIFTI"),
        ("a.nii", gzip(&nifti(2)), "call it .nii.gz"),
        ("a.nii.gz", nifti(2), "call it .nii"),
        ("a.nii", data.to_vec(), "not a NIfTI"),
        ("a.npy", nifti(2), "not a NumPy array"),
        ("a.nrrd", nifti(2), "not an NRRD"),
        ("a.npy", npy_with("'|O'", "(2, 2, 2)"), "'|O'"),
        ("a.npy", npy_with("'<c8'", "(2, 2, 2)"), "'<c8'"),
        ("a.npy", npy_with("[('a', '<f4')]", "(2, 2, 2)"), "records"),
        ("a.npy", npy_with("'<f4'", "(2, 2)"), "three dimensions"),
        ("a.npy", npy_with("'<f4'", "(2, -2, 2)"), "shape"),
        ("a.npy", npy_with("'<f4'", "(0, 2, 2)"), "between 1 and"),
        ("a.nrrd", nrrd_with("encoding: bzip2"), "raw or gzip"),
        ("a.nrrd", nrrd_with("encoding: raw\ntype: block"), "'block'"),
        ("a.nrrd", nrrd_with("encoding: raw\nendian: middle"), "middle"),
        ("a.nrrd", nrrd_with("encoding: raw\nsizes: 2 2"), "3 numbers"),
        ("a.nrrd", nrrd_with("encoding: raw\nspacings: 1 0 1"), "give the spacing"),
        ("a.nrrd", nrrd_with("type short"), "no field"),
        ("a.nrrd", nrrd_with(""), "'encoding' is missing"),
    ];
    for (name, bytes, word) in cases {
        let refusal = folder.refusal(name, &bytes);
        assert!(refusal.contains(word), "{refusal} lacks {word}");
    }
}

#[test]
fn unknown_extensions_missing_files_and_folders_are_said() {
    let folder = Folder::new();
    for name in ["a.jpg", "a", "", "a.nii.bz2"] {
        assert!(matches!(volume_format(name), Err(Error::Extension { .. })), "{name}");
    }
    std::fs::create_dir(folder.path("b.nii")).unwrap();
    let read = |name| read_volume(folder.path(name), &VolumeOptions::default()).unwrap_err();
    assert!(read("b.nii").to_string().contains("folder"));
    assert!(read("c.nii").to_string().contains("check the path"));
}

#[test]
fn progress_is_reported_to_the_end() {
    let folder = Folder::new();
    let count = 9 << 20;
    let file = npy("'|u1'", false, "(9, 1024, 1024)", &vec![1; count]);
    let path = folder.file("a.npy", &file);
    let calls = RefCell::new(Vec::new());
    let progress = |read, length| calls.borrow_mut().push((read, length));
    let options = VolumeOptions { progress: Some(&progress), ..VolumeOptions::default() };
    read_volume(path, &options).unwrap();
    let calls = calls.into_inner();
    assert!(calls.len() >= 2 && calls.is_sorted());
    assert!(calls.iter().all(|&(read, length)| read <= length && length == file.len() as u64));
}
