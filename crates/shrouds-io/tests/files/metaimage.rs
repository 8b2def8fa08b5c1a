//! MetaImage files: as ITK reads them.

use shrouds_io::{Error, Values, VolumeOptions, read_contents, read_volume};

use crate::common::{Folder, bytes, cases, gzip, metaimage, zlib};

const FIELDS: &str = "NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n";

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

#[test]
fn every_type_in_both_byte_orders_plain_and_compressed() {
    let folder = Folder::new();
    let names = [
        ("u8", "MET_UCHAR|MET_UCHAR_ARRAY"),
        ("i8", "MET_CHAR"),
        ("u16", "MET_USHORT"),
        ("i16", "MET_SHORT|met_short"),
        ("u32", "MET_UINT|MET_ULONG"),
        ("i32", "MET_INT|MET_LONG"),
        ("u64", "MET_ULONG_LONG"),
        ("i64", "MET_LONG_LONG"),
        ("f32", "MET_FLOAT"),
        ("f64", "MET_DOUBLE"),
    ];
    for (big, order) in [
        (false, ""),
        (false, "BinaryDataByteOrderMSB = False\n"),
        (true, "BinaryDataByteOrderMSB = True\n"),
        (true, "ElementByteOrderMSB = 1\n"),
        (false, "ElementByteOrderMSB = True\nBinaryDataByteOrderMSB = False\n"),
    ] {
        for case in cases(big) {
            let (_, names) = names.iter().find(|(name, _)| *name == case.name).unwrap();
            for name in names.split('|') {
                let fields = format!("NDims: 3\r\nDimSize=4 3 2\nElementType = {name}\n{order}");
                let packed = format!("{fields}CompressedData = True\nCompressedDataSize = 7\n");
                for file in [
                    metaimage(&fields, &case.bytes),
                    metaimage(&packed, &zlib(&case.bytes)),
                    metaimage(&packed, &gzip(&case.bytes)),
                ] {
                    let volume = folder.volume("a.mha", &file).unwrap();
                    assert_eq!(
                        (volume.grid.dims(), volume.values),
                        ([4, 3, 2], case.values.clone())
                    );
                    let doubtful = order.matches('\n').count() == 2 && case.bytes.len() > 24;
                    assert_eq!(volume.contents.warnings.len(), usize::from(doubtful));
                }
            }
        }
    }
    let text: String = ramp().iter().map(|n| format!("{n}\n")).collect();
    let file = metaimage(&format!("{FIELDS}BinaryData = False\n"), text.as_bytes());
    assert_eq!(folder.volume("a.mha", &file).unwrap().values, Values::U8(ramp()));
}

#[test]
fn a_detached_header_finds_its_data_in_every_way() {
    let folder = Folder::new();
    let data = ramp();
    folder.file("a b.raw", &data);
    folder.file("late.raw", &[b"zzz", data.as_slice()].concat());
    folder.file("a.zraw", &zlib(&data));
    for n in 1..=2 {
        folder.file(&format!("s{n}"), &data[12 * n - 12..12 * n]);
        folder.file(&format!("z{n:02}"), &zlib(&data[12 * n - 12..12 * n]));
    }
    for fields in [
        "ElementDataFile = a b.raw\n",
        "ElementDataFile = a b.raw",
        "HeaderSize = 3\nElementDataFile = late.raw\n",
        "HeaderSize = -1\nElementDataFile = late.raw\n",
        "CompressedData = True\nElementDataFile = a.zraw\n",
        "ElementDataFile = s%d\n",
        "ElementDataFile = s%d 1 2 1\n",
        "ElementDataFile = s%d 1\n",
        "CompressedData = True\nElementDataFile = z%02d 1 2\n",
        "ElementDataFile = LIST\ns1\ns2\n",
        "ElementDataFile = LIST 2D\n\ns1\r\ns2",
        "CompressedData = True\nElementDataFile = LIST\nz01\nz02\n",
    ] {
        let file = metaimage(&format!("{FIELDS}{fields}"), b"");
        let volume = folder.volume("a.mhd", &file).unwrap_or_else(|e| panic!("{fields}: {e}"));
        assert_eq!(volume.values, Values::U8(data.clone()), "{fields}");
    }
    let files_of = |fields: &str| {
        folder.file("a.mhd", &metaimage(&format!("{FIELDS}{fields}"), b""));
        folder.files_of("a.mhd")
    };
    assert_eq!(files_of("ElementDataFile = a b.raw\n"), ["a b.raw", "a.mhd"]);
    assert_eq!(files_of("ElementDataFile = LIST\ns2\ns1\n"), ["a.mhd", "s1", "s2"]);
    folder.file("a.mha", &metaimage(&format!("{FIELDS}ElementDataFile = LOCAL\n"), &data));
    assert_eq!(folder.files_of("a.mha"), ["a.mha"]);
    for (fields, words) in [
        ("ElementDataFile = no.raw\n", "no.raw: cannot open it"),
        ("ElementDataFile = s1\n", "s1: expected 24 bytes of voxel data, found 12"),
        ("ElementDataFile = LIST\ns1\n\n", "s1: expected 24 bytes"),
        ("ElementDataFile = LIST\n", "0 data files cannot share"),
        ("ElementDataFile = s%d 1 99999999 1\n", "more than 65536"),
        ("ElementDataFile = s%d 1 x\n", "the ElementDataFile is"),
        ("ElementDataFile =\n", "has no name"),
        ("HeaderSize = -2\nElementDataFile = s1\n", "the HeaderSize is"),
        ("HeaderSize = 1\nCompressedData = True\nElementDataFile = z01\n", "HeaderSize"),
        ("CompressedData = True\nElementDataFile = s1\n", "s1: the zlib data is truncated"),
    ] {
        let path = folder.file("a.mhd", &metaimage(&format!("{FIELDS}{fields}"), b""));
        let error = read_volume(path, &VolumeOptions::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{error} lacks {words}");
    }
}

#[test]
fn frames_are_those_of_itk() {
    let folder = Folder::new();
    let read = |fields: &str| {
        let volume = folder.volume("a.mha", &metaimage(&format!("{FIELDS}{fields}"), &ramp()));
        let volume = volume.unwrap();
        let frame = volume.frame;
        let told = format!("{} {} {}", frame.name, frame.unit, frame.source);
        (volume.grid.affine(), told, volume.contents.warnings.len())
    };
    let plain = |steps: [f64; 3], origin: [f64; 3]| {
        let [x, y, z] = steps;
        let [a, b, c] = origin;
        [[x, 0.0, 0.0, a], [0.0, y, 0.0, b], [0.0, 0.0, z, c]]
    };
    let turned = [[0.0, -2.0, 0.0, 7.0], [1.0, 0.0, 0.0, 8.0], [0.0, 0.0, 3.0, 9.0]];
    let turn = "ElementSpacing = 1 2 3\nOffset = 7 8 9\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n";
    let lps = "LPS mm TransformMatrix";
    assert_eq!(read(turn), (turned, lps.into(), 0));
    // From anterior, left and inferior; or to the opposite of each.
    for (orientation, doubts) in [("ALI", 0), ("prs", 0), ("RAI", 1), ("ALS", 1), ("???", 0)] {
        let told = read(&format!("{turn}AnatomicalOrientation = {orientation}\n"));
        assert_eq!((told.0, told.2), (turned, doubts), "{orientation}");
    }
    let zero = [0.0; 3];
    assert_eq!(read(""), (plain([1.0; 3], zero), "index unknown none".into(), 0));
    assert_eq!(read("ElementSize = 2 3 4\n").0, plain([2.0, 3.0, 4.0], zero));
    let both = read("ElementSize = 2 3 4\nElementSpacing = 1 -1 5\n");
    assert_eq!(both, (plain([1.0, -1.0, 5.0], zero), "index mm ElementSpacing".into(), 0));
    let place = [7.0, 8.0, 9.0];
    for name in ["Position", "Offset", "Origin", "ImagePosition"] {
        let read = read(&format!("{name} = 7 8 9\n"));
        assert_eq!(read, (plain([1.0; 3], place), "LPS mm Offset".into(), 0));
    }
    let doubtful = read("Position = 1 2 3\nOrigin = 7 8 9\nOffset = 4 5 6\n");
    assert_eq!((doubtful.0, doubtful.2), (plain([1.0; 3], place), 2));
    let cm =
        read("DistanceUnits = cm\nElementSpacing = 2 2 2\nElementToIntensityFunctionSlope = 2\n");
    assert_eq!((cm.1.as_str(), cm.2), ("index cm ElementSpacing", 1));
}

#[test]
fn images_channels_and_series() {
    let folder = Folder::new();
    let image = "NDims = 2\nDimSize = 6 4\nElementType = MET_UCHAR\nElementSpacing = 3 2\n\
        TransformMatrix = 0 1 1 0\nOffset = 5 6\n";
    let volume = folder.volume("a.mha", &metaimage(image, &ramp())).unwrap();
    assert_eq!((volume.grid.dims(), volume.contents.warnings.len()), ([6, 4, 1], 1));
    assert_eq!(
        volume.grid.affine(),
        [[0.0, 2.0, 0.0, 5.0], [3.0, 0.0, 0.0, 6.0], [0.0, 0.0, -2.0, 0.0]]
    );
    let channels = format!("{FIELDS}ElementNumberOfChannels = 3\n").replace("UCHAR", "SHORT");
    let series = "NDims = 4\nDimSize = 4 3 2 3\nElementType = MET_SHORT\nElementSpacing = 1 2 3 9\n\
        Offset = 7 8 9 1\nTransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
    for (fields, stride, layer_step) in [(channels.as_str(), 3, 1), (series, 1, 24)] {
        let stored: Vec<i16> = (0..72).collect();
        let data = bytes(&stored, false);
        let packed = format!("{fields}CompressedData = True\n");
        for file in [metaimage(fields, &data), metaimage(&packed, &zlib(&data))] {
            folder.file("a.mha", &file);
            for layer in 0..3 {
                let volume = folder.layer("a.mha", layer).unwrap();
                let expected = (0..24).map(|n| (n * stride + layer * layer_step) as i16).collect();
                assert_eq!(volume.values, Values::I16(expected));
            }
            assert!(folder.refusal("a.mha", &file).contains("frames 0 to 2"));
        }
    }
    let volume = folder.layer("a.mha", 0).unwrap();
    assert_eq!(volume.grid.point([1.0; 3]), [8.0, 10.0, 12.0]);
}

#[test]
fn what_is_wrong_with_a_header_is_said() {
    let folder = Folder::new();
    for (fields, word) in [
        ("NDims = 3\nElementType = MET_UCHAR\n", "'DimSize' is missing"),
        ("DimSize = 4 3 2\n", "'NDims' is missing"),
        ("NDims = 3\nDimSize = 4 3 2\n", "'ElementType' is missing"),
        ("NDims = 3\nDimSize = 4 3\n", "not 3 numbers"),
        ("NDims = 3\nDimSize = 4 0 2\n", "not 3 numbers"),
        ("NDims = 1\nDimSize = 4\n", "1 dimensions"),
        ("NDims = 99\nDimSize = 4\n", "99 dimensions"),
        ("NDims = 3\nDimSize = 4 3 2\nElementType = MET_OTHER\n", "MET_OTHER"),
        ("nonsense\n", "'nonsense' has no field"),
    ] {
        let refusal = folder.refusal("a.mha", &metaimage(fields, &ramp()));
        assert!(refusal.contains(word), "{refusal} lacks {word}");
    }
    for (fields, word) in [
        ("ElementSpacing = 1 2\n", "not 3 numbers"),
        ("ElementSpacing = 0 1 1\n", "give the spacing"),
        ("TransformMatrix = 1 0 0 0 1 0 0 0 0\n", "give the spacing"),
        ("TransformMatrix = 1 0 0 0\n", "not 9 numbers"),
        ("Offset = a b c\n", "not 3 numbers"),
        ("ElementNumberOfChannels = 0\n", "ElementNumberOfChannels"),
        ("HeaderSize = 5\n", "HeaderSize"),
        ("CompressedData = True\n", "zlib"),
    ] {
        let refusal = folder.refusal("a.mha", &metaimage(&format!("{FIELDS}{fields}"), &ramp()));
        assert!(refusal.contains(word), "{refusal} lacks {word}");
    }
    for bytes in [&b"\x89PNG = 7\n"[..], b"", b"hello world"] {
        let path = folder.file("a.mha", bytes);
        let error = read_contents(path, &VolumeOptions::default());
        assert!(matches!(error, Err(Error::Content { .. })));
    }
    assert!(folder.refusal("a.mha", b"NDims = 3\n").contains("'ElementDataFile' is missing"));
}
