//! TIFF files of every layout, folders of slices, and what ImageJ and OME say of them.

use std::cell::RefCell;

use shrouds_io::{Error, Values, VolumeOptions, read_contents, volume_format};

use crate::common::{Folder, Tiff, cases, read_both, tiff, tiff_page, tiff_text, zlib};

/// Number of the tag format of a case.
fn format_of(name: &str) -> u64 {
    match &name[..1] {
        "u" => 1,
        "i" => 2,
        _ => 3,
    }
}

fn with(mut tags: Tiff, more: &[(u16, u16, Vec<u64>)]) -> Tiff {
    tags.retain(|tag| more.iter().all(|other| other.0 != tag.0));
    tags.extend(more.iter().cloned());
    tags
}

fn lzw(bytes: &[u8]) -> Vec<u8> {
    weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(bytes).unwrap()
}

fn pack_bits(bytes: &[u8]) -> Vec<u8> {
    bytes.chunks(100).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect()
}

fn layer(layer: usize) -> VolumeOptions<'static> {
    VolumeOptions { layer: Some(layer), ..VolumeOptions::default() }
}

#[test]
fn every_type_in_both_orders_classic_and_big() {
    let folder = Folder::new();
    for n in 0..4 {
        let (big, wide) = (n & 1 > 0, n & 2 > 0);
        for case in cases(big) {
            let size = case.bytes.len() / 24;
            let page = tiff_page(4, 3, 8 * size as u64, format_of(case.name));
            let pages: Vec<_> = case
                .bytes
                .chunks(12 * size)
                .map(|slice| (page.clone(), vec![slice.to_vec()]))
                .collect();
            let volume = folder.volume("a.tiff", &tiff(&pages, big, wide)).unwrap();
            assert_eq!((volume.grid.dims(), &volume.values), ([4, 3, 2], &case.values));
            assert_eq!((volume.frame.name.as_str(), volume.grid.spacing()), ("index", [1.0; 3]));
        }
    }
}

#[test]
fn strips_of_every_compression_hold_the_same() {
    let folder = Folder::new();
    // Rows in strips of 2, the last one shorter.
    let values: Vec<u8> = (0..35).map(|n| n / 3 * 7).collect();
    type Pack = fn(&[u8]) -> Vec<u8>;
    let methods: [(u64, Pack); 5] =
        [(1, |b| b.into()), (5, lzw), (8, zlib), (32946, zlib), (32773, pack_bits)];
    for (code, pack) in methods {
        let page = with(tiff_page(5, 7, 8, 1), &[(259, 3, vec![code]), (278, 3, vec![2])]);
        let strips: Vec<_> = values.chunks(10).map(pack).collect();
        let volume = folder.volume("a.tif", &tiff(&[(page, strips)], false, false)).unwrap();
        assert_eq!(volume.values, Values::U8(values.clone()), "{code}");
    }
}

#[test]
fn tiles_are_put_together_and_their_margins_left_out() {
    let folder = Folder::new();
    let value = |x: u64, y: u64| (100 * y + x) as u16;
    let tile = |tx: u64, ty: u64| {
        let places = (0..16).flat_map(|y| (0..16).map(move |x| (x, y)));
        let values = places.map(|(x, y)| value(16 * tx + x, 16 * ty + y));
        zlib(&values.flat_map(u16::to_be_bytes).collect::<Vec<_>>())
    };
    let page = with(
        tiff_page(20, 35, 16, 1),
        &[(259, 3, vec![8]), (322, 3, vec![16]), (323, 3, vec![16])],
    );
    let tiles = (0..6).map(|n| tile(n % 2, n / 2)).collect();
    let volume = folder.volume("a.tif", &tiff(&[(page, tiles)], true, false)).unwrap();
    let expected = (0..700).map(|n| value(n % 20, n / 20)).collect();
    assert_eq!(volume.values, Values::U16(expected));
}

#[test]
fn predictors_are_undone() {
    let folder = Folder::new();
    let values = [7u16, 9, 3, 60_000, 1, 2];
    let page = with(tiff_page(3, 2, 16, 1), &[(317, 3, vec![2])]);
    for big in [false, true] {
        let differences = [7u16, 2, 3u16.wrapping_sub(9), 60_000, 1u16.wrapping_sub(60_000), 1];
        let bytes: Vec<u8> = differences
            .iter()
            .flat_map(|n| if big { n.to_be_bytes() } else { n.to_le_bytes() })
            .collect();
        let volume = folder.volume("a.tif", &tiff(&[(page.clone(), vec![bytes])], big, false));
        assert_eq!(volume.unwrap().values, Values::U16(values.into()));
    }
}

#[test]
fn small_bits_are_numbers_of_their_own() {
    let folder = Folder::new();
    let read = |bits: u64, photometric: u64, order: u64, bytes: &[u8]| {
        let tags = [(262, 3, vec![photometric]), (266, 3, vec![order])];
        let page = with(tiff_page(3, 2, bits, 1), &tags);
        folder.volume("a.tif", &tiff(&[(page, vec![bytes.to_vec()])], false, false)).unwrap()
    };
    let volume = read(1, 0, 1, &[0b1010_0000, 0b0111_1111]);
    assert_eq!(volume.values, Values::U8(vec![1, 0, 1, 0, 1, 1]));
    assert!(volume.contents.warnings[0].contains("white"));
    assert_eq!(read(1, 1, 2, &[0b0000_0101, 0b0000_0110]).values, volume.values);
    let volume = read(2, 3, 1, &[0b11_10_01_00, 0b00_01_11_11]);
    assert_eq!(volume.values, Values::U8(vec![3, 2, 1, 0, 1, 3]));
    assert!(volume.contents.warnings.is_empty());
    assert_eq!(read(4, 1, 1, &[0x12, 0x3f, 0x45, 0x60]).values, Values::U8(vec![1, 2, 3, 4, 5, 6]));
}

/// Pages of one value each, with a description in the first.
fn described(count: u8, text: &str, more: &[(u16, u16, Vec<u64>)]) -> Vec<u8> {
    let pages: Vec<_> = (0..count)
        .map(|n| {
            let page = tiff_page(2, 1, 8, 1);
            let page = if n == 0 { with(with(page, &[tiff_text(270, text)]), more) } else { page };
            (page, vec![vec![n; 2]])
        })
        .collect();
    tiff(&pages, true, false)
}

#[test]
fn imagej_hyperstacks_have_layers_and_a_lattice() {
    let folder = Folder::new();
    let text =
        "ImageJ=1.54f\nimages=12\nchannels=2\nslices=3\nframes=2\nunit=\\u00B5m\nspacing=2.5\n";
    let more = [(282, 5, vec![4, 1]), (283, 5, vec![200, 100]), (296, 3, vec![1])];
    let path = folder.file("a.tif", &described(12, text, &more));
    for n in 0..4u8 {
        let volume = read_both(&path, &layer(n.into())).unwrap();
        assert_eq!((volume.contents.layers, volume.grid.dims()), (4, [2, 1, 3]));
        assert_eq!(volume.grid.spacing(), [0.25, 0.5, 2.5]);
        let frame = (volume.frame.unit.as_str(), volume.frame.source);
        assert_eq!(frame, ("um", "ImageJ description"));
        let page = |slice: u8| n % 2 + 2 * slice + 6 * (n / 2);
        assert_eq!(volume.values, Values::U8((0..6).map(|i| page(i / 2)).collect()));
    }
    assert!(matches!(read_both(&path, &VolumeOptions::default()), Err(Error::Choice { .. })));
    let wrong = text.replace("slices=3", "slices=4");
    let volume = folder.volume("a.tif", &described(12, &wrong, &more)).unwrap();
    assert_eq!(volume.grid.dims(), [2, 1, 12]);
    assert!(volume.contents.warnings[0].contains("tells of 16 pages, but there are 12"));
    let signed = "ImageJ=1.54f\nimages=2\nslices=2\ncf=0\nc0=-5\nc1=1\n";
    let volume = folder.volume("a.tif", &described(2, signed, &[])).unwrap();
    assert_eq!(volume.values, Values::F64(vec![-5.0, -5.0, -4.0, -4.0]));
}

#[test]
fn large_imagej_stacks_have_one_directory() {
    let folder = Folder::new();
    let text = tiff_text(270, "ImageJ=1.53t\nimages=3\nslices=3\n");
    let page = with(tiff_page(2, 2, 16, 1), &[text]);
    let all: Vec<u16> = (0..12).map(|n| n * 300).collect();
    let bytes: Vec<u8> = all.iter().flat_map(|n| n.to_be_bytes()).collect();
    // The one strip has the length of a page.
    let mut file = tiff(&[(page.clone(), vec![bytes[..8].into()])], true, false);
    // What is before the directory is no block: there is but one page.
    let volume = folder.volume("a.tif", &file).unwrap();
    assert_eq!(volume.grid.dims(), [2, 2, 1]);
    assert!(volume.contents.warnings[0].contains("tells of 3 pages, but there are 1"));
    let place = (file.len() as u32).to_be_bytes();
    let at = file.windows(4).position(|w| w == [1, 17, 0, 4]).unwrap() + 8;
    file[at..at + 4].copy_from_slice(&place);
    file.extend(&bytes);
    let volume = folder.volume("a.tif", &file).unwrap();
    assert_eq!((volume.grid.dims(), volume.values), ([2, 2, 3], Values::U16(all)));
    let refused = folder.refusal("a.tif", &file[..file.len() - 2]);
    assert!(refused.contains("expected 24 bytes of voxel data, found 22"), "{refused}");
}

#[test]
fn ome_gives_sizes_units_and_the_order_of_planes() {
    let folder = Folder::new();
    let text = "<?xml version='1.0'?><OME xmlns='x'><Image><Pixels DimensionOrder='XYTZC' Type='uint8' \
        SizeX='2' SizeY='1' SizeZ='3' SizeC='2' SizeT='1' PhysicalSizeX='0.5' PhysicalSizeY='0.25' \
        PhysicalSizeZ='0.002' PhysicalSizeZUnit='mm'><TiffData/></Pixels></Image></OME>";
    let path = folder.file("a.ome.tif", &described(6, text, &[]));
    for n in 0..2u8 {
        let volume = read_both(&path, &layer(n.into())).unwrap();
        assert_eq!(volume.grid.spacing(), [0.5, 0.25, 2.0]);
        assert_eq!((volume.frame.unit.as_str(), volume.frame.source), ("um", "OME-XML"));
        assert_eq!(volume.values, Values::U8((0..6).map(|i| 3 * n + i / 2).collect()));
    }
    let short = described(4, text, &[]);
    let (grid, _, contents) =
        read_contents(folder.file("a.tif", &short), &VolumeOptions::default()).unwrap();
    assert_eq!((grid.dims(), contents.layers), ([2, 1, 4], 1));
    assert!(contents.warnings[0].contains("tells of 6 pages, but there are 4"));
}

#[test]
fn a_folder_is_read_in_the_order_of_its_numbers() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("scan")).unwrap();
    assert!(matches!(volume_format(folder.path("scan")), Err(Error::Extension { .. })));
    let slice = |n: u8| tiff(&[(tiff_page(2, 1, 8, 1), vec![vec![n, n]])], false, false);
    for (n, name) in ["s1.tif", "s2.TIF", "s10.tif", "s11.tiff"].into_iter().enumerate() {
        folder.file(&format!("scan/{name}"), &slice(n as u8));
    }
    folder.file("scan/notes.txt", b"");
    folder.file("scan/.hidden.tif", b"");
    let read = || read_both(&folder.path("scan"), &VolumeOptions::default());
    let volume = read().unwrap();
    assert_eq!(volume.values, Values::U8(vec![0, 0, 1, 1, 2, 2, 3, 3]));
    assert_eq!(volume.grid.dims(), [2, 1, 4]);
    let warnings = &volume.contents.warnings;
    assert!(warnings[0].contains("Between s2.TIF and s10.tif"), "{warnings:?}");
    assert!(warnings[1].contains("1 other files"), "{warnings:?}");
    let slices = ["scan/s1.tif", "scan/s10.tif", "scan/s11.tiff", "scan/s2.TIF"];
    assert_eq!(folder.files_of("scan"), slices);
    let wider = tiff(&[(tiff_page(3, 1, 8, 1), vec![vec![1; 3]])], false, false);
    folder.file("scan/s3.tif", &wider);
    let error = read().unwrap_err().to_string();
    assert!(error.contains("s3.tif") && error.contains("2 x 1 U8 and 3 x 1 U8"), "{error}");
    let page = (tiff_page(2, 1, 8, 1), vec![vec![1, 1]]);
    folder.file("scan/s3.tif", &tiff(&[page.clone(), page], false, false));
    assert!(read().unwrap_err().to_string().contains("2 pages in a folder"));
}

#[test]
fn smaller_copies_are_left_out() {
    let folder = Folder::new();
    let page = |n: u8| (tiff_page(2, 1, 8, 1), vec![vec![n; 2]]);
    let small = (with(tiff_page(1, 1, 8, 1), &[(254, 4, vec![1])]), vec![vec![9]]);
    let file = tiff(&[page(1), small, page(2)], false, false);
    let volume = folder.volume("a.tif", &file).unwrap();
    assert_eq!(volume.values, Values::U8(vec![1, 1, 2, 2]));
    assert!(volume.contents.warnings[0].contains("1 smaller copies"));
}

#[test]
fn what_cannot_be_read_is_said() {
    let folder = Folder::new();
    let one = |more: &[(u16, u16, Vec<u64>)]| {
        tiff(&[(with(tiff_page(2, 1, 8, 1), more), vec![vec![1; 6]])], false, false)
    };
    let tag = |tag: u16, value: u64| one(&[(tag, 4, vec![value])]);
    let cases = [
        (one(&[(277, 3, vec![3]), (262, 3, vec![2])]), "3 samples a pixel (colour model 2)"),
        (tag(259, 7), "JPEG (code 7)"),
        (tag(259, 50000), "Zstandard"),
        (tag(258, 12), "12 bits in format 1"),
        (tag(339, 6), "8 bits in format 6"),
        (tag(317, 3), "predictor 3"),
        (tag(32997, 5), "5 slices"),
        (tag(256, 0), "0 x 1 pixels"),
        (tag(278, 0), "strips of 2 x 0"),
        (one(&[(257, 4, vec![5]), (278, 4, vec![5])]), "bytes of a strip or tile cannot be 10"),
        (tag(322, 1), "more or fewer strips"),
        (tag(256, u32::MAX.into()), "cannot be 4294967295"),
        (b"II\x2a\0\0\0\0\0".into(), "no pages"),
        (b"II\x2a\0\x08\0\0\0\xff\xff".into(), "file ends"),
        (b"II\x2b\0".into(), "file ends"),
        (b"\x89PNG".into(), "not a TIFF"),
    ];
    for (file, word) in cases {
        let refusal = folder.refusal("a.tif", &file);
        assert!(refusal.contains(word), "{refusal} lacks {word}");
    }
}

#[test]
fn pages_that_go_round_or_share_their_bytes_are_refused() {
    let folder = Folder::new();
    let page = (tiff_page(64, 64, 8, 1), vec![vec![7; 4096]]);
    let file = tiff(&[page.clone(), page.clone(), page], false, false);
    let links: Vec<usize> = (0..3)
        .scan(4, |link, _| {
            let place = u32::from_le_bytes(file[*link..*link + 4].try_into().unwrap()) as usize;
            let entries = usize::from(file[place]) + 256 * usize::from(file[place + 1]);
            *link = place + 2 + 12 * entries;
            Some(*link)
        })
        .collect();
    let mut round = file.clone();
    round.copy_within(4..8, links[2]);
    assert!(folder.refusal("a.tif", &round).contains("circle"));
    // All pages show the same compressed data: a small file of many large slices.
    let (tags, packed) = (tiff_page(1 << 10, 1 << 10, 8, 1), zlib(&vec![0; 1 << 20]));
    let packed = (with(tags, &[(259, 3, vec![8])]), vec![packed]);
    let mut shared = tiff(&vec![packed; 50], false, false);
    let places: Vec<usize> = (0..shared.len() - 8)
        .filter(|at| shared[*at..at + 8] == [17, 1, 4, 0, 1, 0, 0, 0])
        .collect();
    let first: [u8; 4] = shared[places[0] + 8..places[0] + 12].try_into().unwrap();
    for place in places {
        shared[place + 8..place + 12].copy_from_slice(&first);
    }
    // Still as long as it was: the same bytes may be named once each.
    let volume = folder.volume("a.tif", &shared).unwrap();
    assert_eq!(volume.grid.dims()[2], 50);
    let end = tiff(&vec![(tiff_page(64, 64, 8, 1), vec![vec![7; 4096]]); 9], false, false);
    let mut end = [end, vec![]].concat();
    for at in 0..end.len() - 8 {
        if end[at..at + 8] == [17, 1, 4, 0, 1, 0, 0, 0] {
            end[at + 8..at + 12].copy_from_slice(&8u32.to_le_bytes());
        }
        // Every strip is twice as long as the page needs.
        if end[at..at + 8] == [23, 1, 4, 0, 1, 0, 0, 0] {
            end[at + 8..at + 12].copy_from_slice(&8192u32.to_le_bytes());
        }
    }
    assert!(folder.refusal("a.tif", &end).contains("overlap"));
}

#[test]
fn progress_is_reported_page_by_page() {
    let folder = Folder::new();
    let path = folder.file("a.tif", &described(5, "", &[]));
    let calls = RefCell::new(Vec::new());
    let progress = |read, length| calls.borrow_mut().push((read, length));
    let options = VolumeOptions { progress: Some(&progress), ..VolumeOptions::default() };
    shrouds_io::read_volume(path, &options).unwrap();
    assert_eq!(calls.into_inner(), [(2, 10), (4, 10), (6, 10), (8, 10), (10, 10)]);
}
