//! DICOM segmentations: frames, planes, layers, and what is refused.

use std::io::Write;
use std::path::Path;

use flate2::{Compression, write::DeflateEncoder};
use shrouds::Select;
use shrouds_io::{Values, Volume, VolumeOptions, read_occupancy, read_volume};

use crate::common::Folder;

const EXPLICIT: &str = "1.2.840.10008.1.2.1";
const DEFLATED: &str = "1.2.840.10008.1.2.1.99";
const FRAGMENTS: &str = "1.2.840.10008.1.2.1.98";
const BIG_ENDIAN: &str = "1.2.840.10008.1.2.2";
const RUN_LENGTH: &str = "1.2.840.10008.1.2.5";
const DEFLATED_FRAMES: &str = "1.2.840.10008.1.2.8.1";

/// A segmentation that tests change before they write it.
#[derive(Clone)]
pub(crate) struct Segmentation {
    pub(crate) syntax: &'static str,
    class: &'static str,
    kind: &'static str,
    columns: u16,
    rows: u16,
    bits: u16,
    /// Segment and position of each frame.
    frames: Vec<(u16, [f64; 3])>,
    names: Vec<(u16, &'static str)>,
    orientation: &'static str,
    between: &'static str,
    pub(crate) pixels: Vec<u8>,
    /// Elements at the end of those before the pixels.
    more: Vec<u8>,
}

impl Segmentation {
    /// Frames of 4 columns and 3 rows of segment 1, 2.5 mm apart.
    pub(crate) fn new(kind: &'static str, bits: u16, frames: usize) -> Self {
        Self {
            syntax: EXPLICIT,
            class: "1.2.840.10008.5.1.4.1.1.66.4",
            kind,
            columns: 4,
            rows: 3,
            bits,
            frames: (0..frames).map(|n| (1, [10.0, 20.0, 30.0 + 2.5 * n as f64])).collect(),
            names: vec![(1, "liver")],
            orientation: "1\\0\\0\\0\\1\\0",
            between: "",
            pixels: vec![0; (12 * frames * usize::from(bits)).div_ceil(8)],
            more: Vec::new(),
        }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let meta = [
            element(0x0002_0002, b"UI", self.class.as_bytes()),
            element(0x0002_0010, b"UI", self.syntax.as_bytes()),
        ]
        .concat();
        let length = element(0x0002_0000, b"UL", &(meta.len() as u32).to_le_bytes());
        let dataset = self.dataset();
        let dataset = match self.syntax {
            DEFLATED => deflate(&dataset),
            BIG_ENDIAN => big_endian(&dataset),
            _ => dataset,
        };
        [&[0; 128], &b"DICM"[..], &length, &meta, &dataset].concat()
    }

    fn dataset(&self) -> Vec<u8> {
        let text = |tag, value: &str| element(tag, b"DS", value.as_bytes());
        let number = |tag, value: u16| element(tag, b"US", &value.to_le_bytes());
        let measures = [
            text(0x0018_0050, "3"),
            text(0x0018_0088, self.between),
            text(0x0028_0030, "1.5\\0.5"),
        ];
        let shared = [
            sequence(0x0020_9116, &[text(0x0020_0037, self.orientation)]),
            sequence(0x0028_9110, &[measures.concat()]),
        ];
        let frame = |(segment, [x, y, z]): &(u16, [f64; 3])| {
            let position = text(0x0020_0032, &format!("{x}\\{y}\\{z}"));
            let position = sequence(0x0020_9113, &[position]);
            [position, sequence(0x0062_000a, &[number(0x0062_000b, *segment)])].concat()
        };
        let frames: Vec<Vec<u8>> = self.frames.iter().map(frame).collect();
        let name = |(segment, name): &(u16, &str)| {
            let label = element(0x0062_0005, b"LO", name.as_bytes());
            [number(0x0062_0004, *segment), label].concat()
        };
        let names: Vec<Vec<u8>> = self.names.iter().map(name).collect();
        [
            element(0x0008_0016, b"UI", self.class.as_bytes()),
            text(0x0028_0008, &self.frames.len().to_string()),
            number(0x0028_0010, self.rows),
            number(0x0028_0011, self.columns),
            number(0x0028_0100, self.bits),
            text(0x0062_0001, self.kind),
            sequence(0x0062_0002, &names),
            number(0x0062_000e, 200),
            sequence(0x5200_9229, &[shared.concat()]),
            sequence(0x5200_9230, &frames),
            self.more.clone(),
            self.pixel_element(),
        ]
        .concat()
    }

    fn pixel_element(&self) -> Vec<u8> {
        let frame = self.pixels.len() / self.frames.len();
        let coded: Vec<Vec<u8>> =
            self.pixels.chunks(frame).map(|frame| self.coded(frame)).collect();
        if [EXPLICIT, DEFLATED, BIG_ENDIAN].contains(&self.syntax) {
            return element(0x7fe0_0010, b"OW", &self.pixels);
        }
        let mut bytes = b"\xe0\x7f\x10\x00OB\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\0\0\0\0".to_vec();
        for mut frame in coded {
            frame.resize(frame.len().next_multiple_of(2), 0);
            bytes.extend(b"\xfe\xff\x00\xe0");
            bytes.extend((frame.len() as u32).to_le_bytes());
            bytes.extend(frame);
        }
        bytes.extend(b"\xfe\xff\xdd\xe0\0\0\0\0");
        bytes
    }

    fn coded(&self, frame: &[u8]) -> Vec<u8> {
        match self.syntax {
            RUN_LENGTH => run_lengths(frame, usize::from(self.bits) / 8),
            DEFLATED_FRAMES => deflate(frame),
            _ => frame.to_vec(),
        }
    }

    fn read(&self) -> Volume {
        let folder = Folder::new();
        let path = folder.file("a.dcm", &self.bytes());
        let options = VolumeOptions::default();
        let volume = read_volume(&path, &options).unwrap();
        let selected = read_occupancy(&path, &options, &Select::NonZero).unwrap();
        assert_eq!(volume.occupancy(&Select::NonZero).unwrap(), selected.occupancy);
        volume
    }

    fn refusal(&self) -> String {
        Folder::new().refusal("a.dcm", &self.bytes())
    }
}

fn element(tag: u32, kind: &[u8; 2], value: &[u8]) -> Vec<u8> {
    let mut bytes = [(tag >> 16) as u16, tag as u16].map(u16::to_le_bytes).concat();
    bytes.extend(kind);
    let length = value.len().next_multiple_of(2);
    match kind {
        b"OW" | b"SQ" | b"UN" => {
            bytes.extend([0, 0]);
            bytes.extend((length as u32).to_le_bytes());
        }
        _ => bytes.extend((length as u16).to_le_bytes()),
    }
    bytes.extend(value);
    // Names are padded with 0, other text with spaces, which both are no part of it.
    bytes.resize(bytes.len() + length - value.len(), if kind == b"UI" { 0 } else { b' ' });
    bytes
}

fn sequence(tag: u32, items: &[Vec<u8>]) -> Vec<u8> {
    let item = |item: &Vec<u8>| {
        [&b"\xfe\xff\x00\xe0"[..], &(item.len() as u32).to_le_bytes(), item].concat()
    };
    element(tag, b"SQ", &items.iter().flat_map(item).collect::<Vec<u8>>())
}

/// The same elements in the other byte order, pixels in bytes.
fn big_endian(mut elements: &[u8]) -> Vec<u8> {
    let mut swapped = Vec::new();
    while let [a, b, c, d, rest @ ..] = elements {
        let item = [*a, *b] == [0xfe, 0xff];
        let kind = if item { *b"SQ" } else { [rest[0], rest[1]] };
        let long = [*b"OW", *b"SQ", *b"UN"].contains(&kind);
        let (typed, length) = match (item, long) {
            (true, _) => rest.split_at(0),
            (false, true) => rest.split_at(4),
            (false, false) => rest.split_at(2),
        };
        let (length, rest) = length.split_at(if long { 4 } else { 2 });
        let count = length.iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte));
        let value = &rest[..count];
        swapped.extend([b, a, d, c]);
        swapped.extend(if kind == *b"OW" { b"OB\0\0" } else { typed });
        swapped.extend(length.iter().rev());
        match &kind {
            b"SQ" => swapped.extend(big_endian(value)),
            b"US" | b"UL" => swapped.extend(value.iter().rev()),
            _ => swapped.extend(value),
        }
        elements = &rest[count..];
    }
    swapped
}

fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// RLE with a run for every byte.
fn run_lengths(frame: &[u8], planes: usize) -> Vec<u8> {
    let plane = |n: usize| {
        frame.iter().skip(n).step_by(planes).flat_map(|byte| [0, *byte]).collect::<Vec<u8>>()
    };
    let length = (2 * frame.len() / planes) as u32;
    let mut header = vec![planes as u32];
    header.extend((0..planes as u32).map(|n| 64 + n * length));
    header.resize(16, 0);
    let header = header.into_iter().flat_map(u32::to_le_bytes);
    header.chain((0..planes).rev().flat_map(plane)).collect()
}

fn pack(bits: impl Iterator<Item = bool>) -> Vec<u8> {
    let bits: Vec<bool> = bits.collect();
    let byte = |bits: &[bool]| bits.iter().rev().fold(0, |byte, bit| byte << 1 | u8::from(*bit));
    bits.chunks(8).map(byte).collect()
}

/// Four labels, two frames, of two bytes.
pub(crate) fn label_map(syntax: &'static str) -> Segmentation {
    let labels = (0..24).map(|n| n % 4 * 300u16);
    Segmentation {
        syntax,
        class: "1.2.840.10008.5.1.4.1.1.66.7",
        pixels: labels.flat_map(u16::to_le_bytes).collect(),
        ..Segmentation::new("LABELMAP", 16, 2)
    }
}

#[test]
fn label_maps_in_every_coding() {
    for syntax in [EXPLICIT, DEFLATED, FRAGMENTS, RUN_LENGTH, DEFLATED_FRAMES] {
        let volume = label_map(syntax).read();
        let expected: Vec<u16> = (0..24).map(|n| n % 4 * 300).collect();
        assert_eq!(volume.values, Values::U16(expected), "{syntax}");
        assert_eq!(volume.grid.dims(), [4, 3, 2]);
        let affine = [[0.5, 0.0, 0.0, 10.0], [0.0, 1.5, 0.0, 20.0], [0.0, 0.0, 2.5, 30.0]];
        assert_eq!(volume.grid.affine(), affine);
        assert_eq!((&volume.frame.name[..], &volume.frame.unit[..]), ("LPS", "mm"));
        assert_eq!(volume.contents.warnings, [""; 0]);
    }
}

/// Segments 1 and 2 overlap, 3 overlaps neither; frames start within bytes.
pub(crate) fn overlapping() -> (Segmentation, [Vec<bool>; 3]) {
    let inside = |segment: usize| {
        let bit = move |n: usize| match segment {
            0 => n.is_multiple_of(3),
            1 => n.is_multiple_of(5),
            _ => n % 3 == 1 && !n.is_multiple_of(5),
        };
        (0..24).map(bit).collect::<Vec<bool>>()
    };
    let segments = [0, 1, 2].map(inside);
    let mut file = Segmentation::new("BINARY", 1, 2);
    file.names = vec![(1, "one"), (2, "two"), (3, "three")];
    let [low, high] = [30.0, 32.5].map(|z| [10.0, 20.0, z]);
    file.frames = vec![(2, high), (1, low), (3, high), (1, high), (3, low), (2, low)];
    let frames = file.frames.clone();
    let frames = frames.iter().flat_map(|(segment, place)| {
        let bits = &segments[usize::from(*segment) - 1];
        if place[2] == 30.0 { &bits[..12] } else { &bits[12..] }
    });
    file.pixels = pack(frames.copied());
    (file, segments)
}

#[test]
fn segments_that_overlap_are_put_into_layers() {
    let (file, segments) = overlapping();
    let folder = Folder::new();
    let path = folder.file("a.dcm", &file.bytes());
    let layer = |layer| VolumeOptions { layer: Some(layer), ..VolumeOptions::default() };
    let label = |n: usize, number: u8| u8::from(segments[usize::from(number) - 1][n]) * number;
    let first = read_volume(&path, &layer(0)).unwrap();
    assert_eq!(first.values, Values::U8((0..24).map(|n| label(n, 1) + label(n, 3)).collect()));
    let second = read_volume(&path, &layer(1)).unwrap();
    assert_eq!(second.values, Values::U8((0..24).map(|n| label(n, 2)).collect()));
    let told = &first.contents;
    let told: Vec<_> = told.segments.iter().map(|s| (&s.name[..], s.label, s.layer)).collect();
    assert_eq!(told, [("one", 1, 0), ("two", 2, 1), ("three", 3, 0)]);

    for wrong in [VolumeOptions::default(), layer(2)] {
        let error = read_volume(&path, &wrong).unwrap_err().to_string();
        assert!(error.contains("frames 0 to 1; name one"), "{error}");
    }
    let wanted =
        |select| read_occupancy(&path, &VolumeOptions::default(), &select).unwrap().occupancy;
    for (select, numbers) in [
        (Select::NonZero, vec![0, 1, 2]),
        (Select::Labels(vec![2]), vec![1]),
        (Select::Labels(vec![1, 2]), vec![0, 1]),
    ] {
        let occupancy = wanted(select);
        let found: Vec<bool> = (0..24).map(|n| occupancy.get([n % 4, n / 4 % 3, n / 12])).collect();
        let any = |n| numbers.iter().any(|segment: &usize| segments[*segment][n]);
        assert_eq!(found, (0..24).map(any).collect::<Vec<bool>>(), "{numbers:?}");
    }
}

#[test]
fn big_endian_files_hold_the_same() {
    let (file, _) = overlapping();
    let mut fractions = Segmentation::new("FRACTIONAL", 8, 2);
    fractions.pixels = (0..24).map(|n| n * 9).collect();
    assert_eq!(Segmentation { syntax: BIG_ENDIAN, ..fractions.clone() }.read(), fractions.read());
    let folder = Folder::new();
    let read = |syntax| {
        let path = folder.file("a.dcm", &Segmentation { syntax, ..file.clone() }.bytes());
        read_occupancy(&path, &VolumeOptions::default(), &Select::Labels(vec![2]))
    };
    assert_eq!(read(BIG_ENDIAN).unwrap(), read(EXPLICIT).unwrap());
    let mut words = Segmentation { syntax: BIG_ENDIAN, ..fractions }.bytes();
    let pixels = words.windows(6).rposition(|bytes| bytes == b"\x7f\xe0\x00\x10OB").unwrap();
    words[pixels + 5] = b'W';
    let refusal = folder.refusal("a.dcm", &words);
    assert!(refusal.contains("pixels in words"), "{refusal}");
}

#[test]
fn without_a_number_of_frames_there_is_one() {
    let file = Segmentation::new("BINARY", 1, 3);
    let mut bytes = file.bytes();
    let count = bytes.windows(6).position(|bytes| bytes == b"\x28\x00\x08\x00DS").unwrap();
    bytes.drain(count..count + 10);
    let folder = Folder::new();
    let volume = read_volume(folder.file("a.dcm", &bytes), &VolumeOptions::default()).unwrap();
    assert_eq!(volume.grid.dims(), [4, 3, 1]);
    assert!(volume.contents.warnings[0].contains("no number of frames"));
}

#[test]
fn fractions_are_inside_from_a_half_on() {
    let mut file = Segmentation::new("FRACTIONAL", 8, 2);
    file.pixels = (0..24).map(|n| n * 9).collect();
    for syntax in [EXPLICIT, FRAGMENTS, RUN_LENGTH] {
        let volume = Segmentation { syntax, ..file.clone() }.read();
        let expected = (0..24).map(|n| u8::from(n * 9 >= 100)).collect();
        assert_eq!(volume.values, Values::U8(expected));
        assert!(volume.contents.warnings[0].contains("at least half of 200"));
    }
}

#[test]
fn slices_may_be_shifted_along_a_line_but_not_off_it() {
    let mut file = Segmentation::new("BINARY", 1, 4);
    for (n, (_, position)) in file.frames.iter_mut().enumerate() {
        position[1] += 0.3 * n as f64;
    }
    let affine = file.read().grid.affine();
    assert!((affine[1][2] - 0.3).abs() < 1e-12 && (affine[2][2] - 2.5).abs() < 1e-12);
    file.frames[2].1[0] += 0.1;
    let refusal = file.refusal();
    assert!(refusal.contains("0.1000 mm away from its place"), "{refusal}");
    let mut uneven = Segmentation::new("BINARY", 1, 4);
    uneven.frames[3].1[2] += 0.8;
    let refusal = uneven.refusal();
    assert!(refusal.contains("slices from 2.5000 to 3.3000 mm apart"), "{refusal}");
}

#[test]
fn distances_of_slices_are_compared_with_the_positions() {
    let read = |between| {
        let volume = Segmentation { between, ..Segmentation::new("BINARY", 1, 3) }.read();
        (volume.grid.dims()[2], volume.grid.spacing()[2], volume.contents.warnings.join(" "))
    };
    assert_eq!(read("2.5"), (3, 2.5, String::new()));
    assert_eq!(read(""), (3, 2.5, String::new()));
    let (slices, spacing, warning) = read("1.25");
    assert!(slices == 5 && spacing == 1.25 && warning.contains("taken as empty"), "{warning}");
    let (slices, spacing, warning) = read("1.7");
    assert!(slices == 3 && spacing == 2.5 && warning.contains("2.5 mm apart"), "{warning}");
    // One slice is as thick as it says.
    let one = |between| Segmentation { between, ..Segmentation::new("BINARY", 1, 1) }.read();
    assert_eq!(one("").grid.spacing()[2], 3.0);
    assert_eq!(one("2").grid.spacing()[2], 2.0);
}

#[test]
fn far_frames_are_no_reason_for_memory() {
    let mut file = Segmentation::new("BINARY", 1, 2);
    file.frames[1].1[2] = 1e6;
    file.between = "1";
    let refusal = file.refusal();
    assert!(refusal.contains("2 frames in a stack of 999970 slices"), "{refusal}");
}

#[test]
fn other_objects_are_named() {
    let ct = Segmentation { class: "1.2.840.10008.5.1.4.1.1.2", ..Segmentation::new("", 1, 1) };
    assert!(ct.refusal().contains("a slice of a CT series (class 1.2.840.10008.5.1.4.1.1.2)"));
    let jpeg =
        Segmentation { syntax: "1.2.840.10008.1.2.4.90", ..Segmentation::new("BINARY", 1, 1) };
    assert!(jpeg.refusal().contains("transfer syntax 1.2.840.10008.1.2.4.90 cannot be read"));
    let columns = element(0x0048_0006, b"UL", &9000u32.to_le_bytes());
    let tiled = Segmentation { more: columns, ..Segmentation::new("BINARY", 1, 1) };
    assert!(tiled.refusal().contains("a segmentation of a tiled slide cannot be read"));
    let eight = Segmentation::new("BINARY", 8, 1);
    assert!(eight.refusal().contains("a BINARY segmentation has 8 bits a pixel"));
    let short = Segmentation { pixels: vec![0; 2], ..Segmentation::new("BINARY", 1, 2) };
    assert!(short.refusal().contains("expected 3 bytes of voxel data, found 2"));
    let folder = Folder::new();
    assert!(folder.refusal("a.dcm", b"DICM").contains("not a DICOM file"));
    let error =
        read_volume(Path::new("IM0001"), &VolumeOptions::default()).unwrap_err().to_string();
    assert!(error.contains(".dcm"), "{error}");
}

#[test]
fn elements_that_are_not_wanted_are_passed_over() {
    let unknown = element(0x0009_1001, b"UN", &[7; 33]);
    let nested = sequence(0x0040_0275, &[sequence(0x5200_9230, &[vec![]]), unknown.clone()]);
    // Of undefined length, and of unknown type: then without the types of its elements.
    let open = b"\x40\x00\x76\x02SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff\
        \x08\x00\x05\x00CS\x02\x00ab\xfe\xff\x0d\xe0\0\0\0\0\xfe\xff\xdd\xe0\0\0\0\0";
    let bare = b"\x40\x00\x77\x02UN\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff\
        \x08\x00\x05\x00\x02\0\0\0ab\xfe\xff\x0d\xe0\0\0\0\0\xfe\xff\xdd\xe0\0\0\0\0";
    let file = label_map(EXPLICIT);
    let more = [&unknown[..], &nested, open, bare].concat();
    assert_eq!(Segmentation { more, ..file.clone() }.read(), file.read());
}

#[test]
fn traps_fail_before_memory_or_the_stack_does() {
    let file = Segmentation::new("BINARY", 1, 1);
    let with = |more: Vec<u8>| Segmentation { more, ..file.clone() }.refusal();
    let level = b"\x40\x00\x75\x02SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff";
    assert!(with(level.repeat(100_000)).contains("more than 32 deep"));
    let kept = b"\x00\x52\x29\x92SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff";
    assert!(with(kept.repeat(100_000)).contains("more than 32 deep"));
    let long = b"\x40\x00\x75\x02OB\0\0\xfe\xff\xff\xff1234".to_vec();
    assert!(with(long).contains("the file ends before the pixels"));
    let bytes = file.bytes();
    // Pixels of four gigabytes by their length, in a file of a few hundred bytes.
    let mut huge = Segmentation { columns: 65535, rows: 65535, ..file.clone() }.bytes();
    let place = huge.len() - file.pixels.len().next_multiple_of(2) - 4;
    huge[place..place + 4].copy_from_slice(&(u32::MAX - 1).to_le_bytes());
    let refusal = Folder::new().refusal("a.dcm", &huge);
    assert!(refusal.contains("expected 536854529 bytes of voxel data, found 2"), "{refusal}");
    assert!(Folder::new().volume("a.dcm", &bytes).is_ok());
}
