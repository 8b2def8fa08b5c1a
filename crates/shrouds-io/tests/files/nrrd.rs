//! NRRD files with the data elsewhere, in other shapes and other encodings, and 3D Slicer's segments.

use shrouds::Select;
use shrouds_io::{
    Error, Segment, Values, VolumeOptions, read_contents, read_occupancy, read_volume,
};

use crate::common::{Folder, bytes, cases, gzip, nrrd};

const FIELDS: &str = "type: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n";
const STEPS: &str = "space: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3)\n";

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

/// The warnings of a file, one a line.
fn warnings(folder: &Folder, file: &[u8]) -> String {
    let path = folder.file("warned.nrrd", file);
    read_contents(path, &VolumeOptions::default()).unwrap().2.warnings.join("\n")
}

#[test]
fn a_detached_header_finds_its_data_in_every_way() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sub")).unwrap();
    let data = ramp();
    folder.file("a b%d.raw", &data);
    folder.file("sub/a.raw.gz", &gzip(&data));
    folder.file("late.raw", &[b"x\ny\nzz", data.as_slice()].concat());
    folder.file("before.raw", &[b"zzz", data.as_slice(), b"yy"].concat());
    for n in 0..6 {
        folder.file(&format!("row{:03}.raw", 10 * n), &data[4 * n..4 * n + 4]);
        folder.file(&format!("{n}.gz"), &gzip(&[b"..", &data[4 * n..4 * n + 4]].concat()));
    }
    folder.file("s1", &data[..12]);
    folder.file("s2", &data[12..]);
    let absolute = folder.path("late.raw").display().to_string();
    for fields in [
        "data file: a b%d.raw\n",
        "datafile: ./a b%d.raw",
        "data file: s%d 1 2 1\n\n",
        "data file: s%d 1 2 1 2\n",
        "data file: row%03d.raw 0 50 10 1\n",
        "data file: LIST\ns1\ns2",
        "data file: LIST 3\ns1\ns2\n",
        "data file: LIST 2\r\ns1\r\ns2\r\n\r\n",
        "line skip: 2\nbyte skip: 2\ndata file: late.raw\n",
        "byte skip: -1\ndata file: late.raw\n",
        "byte skip: -3\ndata file: before.raw\n",
        &format!("byte skip: -1\ndata file: {absolute}\n"),
        "encoding: gzip\ndata file: sub/a.raw.gz\n",
        "encoding: gz\nbyte skip: 2\ndata file: %d.gz 0 5 1 1\n",
    ] {
        let file = [b"NRRD0005\n", FIELDS.as_bytes(), fields.as_bytes()].concat();
        let volume = folder.volume("a.nhdr", &file).unwrap_or_else(|e| panic!("{fields}: {e}"));
        assert_eq!(volume.values, Values::U8(data.clone()), "{fields}");
        assert!(volume.contents.warnings.iter().all(|w| w.contains("encoding")), "{fields}");
    }
    let back = FIELDS.to_string() + "data file: s%d 2 1 -1\n";
    let volume = folder.volume("a.nhdr", &nrrd(&back, b"")).unwrap();
    assert_eq!(volume.values, Values::U8([&data[12..], &data[..12]].concat()));
}

#[test]
fn data_files_that_do_not_fit_are_named() {
    let folder = Folder::new();
    folder.file("s1", &ramp()[..12]);
    folder.file("s2", &ramp()[..11]);
    folder.file("s3", &gzip(&ramp()[..11]));
    std::fs::create_dir(folder.path("s4")).unwrap();
    for (fields, words) in [
        ("data file: no.raw\n", "no.raw: cannot open it"),
        ("data file: LIST\ns1\nno.raw\n", "no.raw: cannot open it"),
        ("data file: LIST\ns1\ns2\n", "s2: expected 12 bytes of voxel data, found 11"),
        ("data file: LIST\ns1\ns4\n", "s4: a folder, a device"),
        (
            "encoding: gzip\ndata file: LIST\ns3\ns3\n",
            "s3: expected 12 bytes of voxel data, found 11",
        ),
        ("data file: LIST\ns1\n", "names 1 data files"),
        ("data file: LIST\ns1\ns1\ns1\n", "names 3 data files"),
        ("data file: LIST 3\ns1\ns1\ns1\ns1\ns1\n", "5 data files cannot share 24"),
        ("data file: LIST 4\ns1\ns1\n", "'4' is no number of axes"),
        ("data file: LIST\n", "names 0 data files"),
        ("data file:\n", "the data file is ''"),
        ("data file: s%d 1 1000000000000 1\n", "more than 65536"),
        ("data file: s%d 1 2 0\n", "more than 65536"),
        ("data file: s%s 1 2 1\n", "place for a number"),
        ("byte skip: -14\ndata file: LIST\ns1\ns1\n", "found 12"),
        ("byte skip: x\ndata file: s1\n", "the byte skip is 'x'"),
        ("line skip: -1\ndata file: s1\n", "the line skip is '-1'"),
        ("byte skip: -1\nencoding: gzip\ndata file: LIST\ns3\ns3\n", "without a skip"),
        ("line skip: 9000000000000000000\ndata file: LIST\ns1\ns1\n", "found 0"),
    ] {
        let path = folder.file("a.nhdr", &nrrd(&format!("{FIELDS}{fields}"), b""));
        let error = read_volume(path, &VolumeOptions::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{error} lacks {words}");
    }
}

#[test]
fn text_and_hexadecimals_hold_every_type() {
    let folder = Folder::new();
    for big in [false, true] {
        for case in cases(big) {
            let name = match case.name {
                "f32" => "float".to_string(),
                "f64" => "double".to_string(),
                name => {
                    name.replace('u', "uint").replace('i', "int").replace("uintnt", "uint") + "_t"
                }
            };
            let endian = if big { "big" } else { "little" };
            let fields = format!("type: {name}\ndimension: 3\nsizes: 4 3 2\nendian: {endian}\n");
            let hex: String = case.bytes.iter().map(|byte| format!("{byte:02X} \n")).collect();
            let file = nrrd(&format!("{fields}encoding: hex\n"), hex.as_bytes());
            assert_eq!(folder.volume("a.nrrd", &file).unwrap().values, case.values, "{name}");
            let text = format!("{:?}", case.values);
            let text = text.split(['[', ']']).nth(1).unwrap();
            for text in [text.to_string(), text.replace(", ", "\n") + "\n"] {
                let file = nrrd(&format!("{fields}encoding: ascii\n"), text.as_bytes());
                assert_eq!(folder.volume("a.nrrd", &file).unwrap().values, case.values, "{name}");
            }
        }
    }
    let fields = |encoding| FIELDS.replace("raw", encoding);
    for (encoding, data, word) in [
        ("ascii", "1 2 3", "found 3"),
        ("ascii", "1 2 x", "'x' is no number"),
        ("txt", "1 2 300", "'300' is no number"),
        ("text", "1 -2 3", "'-2' is no number"),
        ("hex", "0001 0", "found 2"),
        ("hex", "0001 0g", "'g' is no hexadecimal"),
    ] {
        let padded = data.to_string() + &" ".repeat(80);
        let refusal = folder.refusal("a.nrrd", &nrrd(&fields(encoding), padded.as_bytes()));
        assert!(refusal.contains(word), "{refusal} lacks {word}");
    }
}

#[test]
fn the_volumes_of_a_series_may_be_told_apart_by_any_axis() {
    let folder = Folder::new();
    // The value of a voxel says where it is: 24 points of 4 × 3 × 2, times 3 volumes.
    let expected: Vec<u8> = (0..24).collect();
    let vector = ["(1,0,0)", "(0,2,0)", "(0,0,3)"];
    for at in 0..4 {
        let mut sizes = vec![4, 3, 2];
        sizes.insert(at, 3);
        let (mut kinds, mut steps) = (vec!["domain"; 3], vector.to_vec());
        kinds.insert(at, ["list", "vector", "time", "list"][at]);
        steps.insert(at, ["none", "(nan,nan,nan)", "none", "none"][at]);
        let inner: usize = sizes[..at].iter().product();
        let stored: Vec<u16> = (0..72)
            .map(|n| {
                let (layer, point) = (n / inner % 3, n / (inner * 3) * inner + n % inner);
                (100 * layer + point) as u16
            })
            .collect();
        let list = sizes.iter().map(|n| n.to_string()).collect::<Vec<_>>().join(" ");
        let start = format!("type: uint16\ndimension: 4\nendian: big\nsizes: {list}\n");
        let space = format!("space: RAS\nspace directions: {}\n", steps.join(" "));
        let by_kind = format!("kinds: {}\n", kinds.join(" "));
        let data = bytes(&stored, true);
        let number = if at == 3 { 6 } else { 3 };
        for (n, part) in data.chunks(data.len() / number).enumerate() {
            folder.file(&format!("{at}part{n}"), part);
        }
        let parts = format!("data file: {at}part%d 0 {} 1 4\n", number - 1);
        let files = [
            nrrd(&format!("{start}{space}encoding: raw\n"), &data),
            nrrd(&format!("{start}{by_kind}encoding: raw\n"), &data),
            nrrd(&format!("{start}{by_kind}{space}encoding: gzip\n"), &gzip(&data)),
            nrrd(&format!("{start}{by_kind}encoding: raw\n{parts}"), b""),
        ];
        // A third of a volume and a half is no whole number of either.
        let (whole, parts) = files.split_at(3);
        let refused = folder.refusal("a.nrrd", &parts[0]);
        assert!(
            refused.contains(if at == 2 { "several volumes" } else { "frames 0" }),
            "{refused}"
        );
        let files = if at == 2 { whole } else { &files };
        for file in files {
            for layer in 0..3 {
                folder.file("a.nrrd", file);
                let volume = folder.layer("a.nrrd", layer).unwrap();
                let wanted = expected.iter().map(|n| u16::from(*n) + 100 * layer as u16).collect();
                assert_eq!((volume.grid.dims(), volume.values), ([4, 3, 2], Values::U16(wanted)));
                assert_eq!(volume.contents.layers, 3);
                assert_eq!(volume.contents.warnings, [""; 0]);
            }
            let refusal = folder.refusal("a.nrrd", file);
            assert!(refusal.contains("frames 0 to 2"), "{refusal}");
            assert!(matches!(folder.layer("a.nrrd", 3), Err(Error::Choice { .. })));
        }
    }
}

#[test]
fn axes_that_are_none_in_space_are_found() {
    let folder = Folder::new();
    let read = |dimension: usize, sizes: &str, fields: &str| {
        let start = format!("type: uint8\ndimension: {dimension}\nsizes: {sizes}\nencoding: raw\n");
        let volume = folder.volume("a.nrrd", &nrrd(&format!("{start}{fields}"), &ramp()));
        volume.map(|volume| (volume.grid.dims(), volume.contents.warnings.len()))
    };
    assert_eq!(read(4, "4 3 2 1", "").unwrap(), ([4, 3, 2], 0));
    assert_eq!(read(4, "1 4 3 2", "").unwrap(), ([4, 3, 2], 0));
    assert_eq!(read(4, "1 4 3 2", "kinds: list domain domain domain\n").unwrap(), ([4, 3, 2], 0));
    assert_eq!(read(4, "4 1 3 2", "spacings: 1 nan 1 1\n").unwrap(), ([4, 3, 2], 0));
    assert_eq!(
        read(5, "1 4 3 2 1", "kinds: scalar space space space time\n").unwrap().0,
        [4, 3, 2]
    );
    assert_eq!(read(2, "6 4", "").unwrap(), ([6, 4, 1], 1));
    assert_eq!(read(3, "6 4 1", "kinds: domain domain list\n").unwrap(), ([6, 4, 1], 1));
    let lps4 = "space: left-posterior-superior-time\n\
        space directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) none\n";
    assert_eq!(read(4, "4 3 2 1", lps4).unwrap().0, [4, 3, 2]);
    for (dimension, sizes, fields, word) in [
        (4, "4 3 1 2", "kinds: domain domain domain time\n", "frames 0 to 1"),
        (4, "2 3 2 2", "", "frames 0 to 1"),
        (5, "2 2 3 2 2", "", "5 axes in space"),
        (5, "2 2 3 1 2", "kinds: list domain domain domain list\n", "several axes"),
        (1, "24", "", "1 axes in space"),
        (3, "4 3 2", "kinds: list list domain\n", "1 axes in space"),
        (3, "4 3 2", "kinds: domain domain\n", "kinds"),
        (3, "4 3 2", "space directions: (1,0,0) (0,1,0)\n", "space directions"),
        (3, "4 3 2", "space directions: (1) (2) (3)\n", "vectors of two, three or four"),
        (3, "4 3 2", "space directions: (1,0,0) (0,1,0) (0,0,1) x\n", "space directions"),
        (3, "4 0 2", "", "3 numbers from 1 on"),
        (3, "4 3", "", "3 numbers from 1 on"),
        (17, "4 3", "", "not 1 to 16"),
        (4, "9000000000000000000 4 3 2", "kinds: list domain domain domain\n", "more than a file"),
    ] {
        let error = read(dimension, sizes, fields).unwrap_err().to_string();
        assert!(error.contains(word), "{error} lacks {word}");
    }
}

#[test]
fn frames_without_directions_follow_the_centering() {
    let folder = Folder::new();
    let place = |fields: &str| {
        let volume = folder.volume("a.nrrd", &nrrd(&format!("{FIELDS}{fields}"), &ramp())).unwrap();
        let grid = volume.grid;
        (grid.point([0.0; 3]), grid.point([1.0; 3]), volume.frame.source)
    };
    let mins = "axis mins: 10 20 30\n";
    let range = "axis maxs: 14 26 36\n";
    for (fields, low, next, source) in [
        ("spacings: 1 -2 3\n".to_string(), [0.0, 0.0, 0.0], [1.0, -2.0, 3.0], "spacings"),
        (format!("spacings: 1 2 3\n{mins}"), [10.5, 21.0, 31.5], [11.5, 23.0, 34.5], "spacings"),
        (
            format!("spacings: 1 2 3\n{mins}centers: node cell node\n"),
            [10.0, 21.0, 30.0],
            [11.0, 23.0, 33.0],
            "spacings",
        ),
        (
            format!("{mins}{range}centerings: cell cell cell\n"),
            [10.5, 21.0, 31.5],
            [11.5, 23.0, 34.5],
            "axis mins",
        ),
        (
            format!("{mins}{range}centers: cell node node\n"),
            [10.5, 20.0, 30.0],
            [11.5, 23.0, 36.0],
            "axis mins",
        ),
        (
            "spacings: 1 2 3\nspace: LPS\nspace origin: (4,5,6)\n".into(),
            [4.0, 5.0, 6.0],
            [5.0, 7.0, 9.0],
            "spacings",
        ),
    ] {
        assert_eq!(place(&fields), (low, next, source), "{fields}");
    }
    let flat = "type: uint8\ndimension: 2\nsizes: 6 4\nencoding: raw\nspace dimension: 2\n\
        space directions: (0,3) (-2,0)\nspace origin: (5,6)\n";
    let volume = folder.volume("a.nrrd", &nrrd(flat, &ramp())).unwrap();
    assert_eq!(
        volume.grid.affine(),
        [[0.0, -2.0, 0.0, 5.0], [3.0, 0.0, 0.0, 6.0], [0.0, 0.0, 2.0, 0.0]]
    );
}

#[test]
fn doubtful_headers_are_told() {
    let folder = Folder::new();
    for (fields, word) in [
        (format!("{STEPS}spacings: 1 2 4\n"), "differ from the lengths"),
        (format!("{STEPS}space units: \"mm\" \"mm\" \"um\"\n"), "mm is used for all"),
        ("axis mins: 0 0 0\n".into(), "edges are assumed"),
        ("type: int8\n".into(), "twice"),
        ("spacings: 2 nan 2\n".into(), "1 is taken"),
        ("Segment0_Name:=a\nSegment0_LabelValue:=x\n".into(), "left out"),
        ("Segment7_Name:=a\nSegment7_Layer:=1\n".into(), "Segment 7 ('a')"),
    ] {
        let told = warnings(&folder, &nrrd(&format!("{FIELDS}{fields}"), &ramp()));
        assert!(told.contains(word) && told.ends_with('.'), "{told} lacks {word}");
    }
    let sound =
        format!("{STEPS}{FIELDS}spacings: 1 2 3\nunits: \"\" \"\" \"\"\ncenters: node node node\n");
    assert_eq!(warnings(&folder, &nrrd(&sound, &ramp())), "");
}

#[test]
fn segments_have_names_labels_and_layers() {
    let folder = Folder::new();
    let one = "Segment10_ID:=last\nSegment10_LabelValue:=9\nSegment0_Name:=größe \\\\ a\\nb\n\
        Segment0_LabelValue:=4\nSegment0_Layer:=0\nSegment2_LabelValue:=-3\nSegmentation_X:=1\n\
        Segment0_Extent:=1 2 1 2 0 0\nSegmentation_ReferenceImageExtentOffset:=5 6 7\n";
    let volume = folder.volume("a.seg.nrrd", &nrrd(&format!("{FIELDS}{one}"), &ramp())).unwrap();
    let segment = |name: &str, label, layer| Segment { name: name.into(), label, layer };
    let segments =
        [segment("größe \\ a\nb", 4, 0), segment("Segment 2", -3, 0), segment("last", 9, 0)];
    assert_eq!(volume.contents.segments, segments);
    assert_eq!(volume.grid.point([0.0; 3]), [0.0; 3], "extents do not move the frame");
}

#[test]
fn segments_of_all_layers_are_one_volume_unless_one_is_named() {
    let folder = Folder::new();
    let start = "type: uint8\ndimension: 4\nsizes: 3 4 3 2\nkinds: list domain domain domain\n\
        encoding: raw\n";
    let data: Vec<u8> =
        (0..72).map(|n| u8::from(n % 3 == 0 && n < 30 || n % 3 == 2 && n > 50)).collect();
    let new = "Segment0_Name:=a\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n\
        Segment1_Name:=b\nSegment1_LabelValue:=1\nSegment1_Layer:=2\n";
    let old = "Segment0_Name:=a\nSegment1_Name:=c\nSegment2_Name:=b\n";
    for (pairs, layers) in [(new, vec![0, 2]), (old, vec![0, 1, 2])] {
        let path = folder.file("a.seg.nrrd", &nrrd(&format!("{start}{pairs}"), &data));
        let (_, _, contents) = read_contents(&path, &VolumeOptions::default()).unwrap();
        let found: Vec<_> = contents.segments.iter().map(|s| (s.label, s.layer)).collect();
        assert_eq!(found, layers.into_iter().map(|layer| (1, layer)).collect::<Vec<_>>());
        let all = read_occupancy(&path, &VolumeOptions::default(), &Select::NonZero).unwrap();
        let inside = |n: usize, layer: usize| data[3 * n + layer] == 1;
        for n in 0..24 {
            let any = (0..3).any(|layer| inside(n, layer));
            assert_eq!(all.occupancy.get([n % 4, n / 4 % 3, n / 12]), any, "{n}");
        }
        assert_eq!(all.occupancy.count(), 17);
        for layer in 0..3 {
            let count = (0..24).filter(|n| inside(*n, layer)).count() as u64;
            let volume = folder.layer("a.seg.nrrd", layer).unwrap();
            assert_eq!(volume.occupancy(&Select::NonZero).unwrap().count(), count);
        }
        let error = read_volume(&path, &VolumeOptions::default());
        assert!(matches!(error, Err(Error::Choice { .. })));
    }
}
