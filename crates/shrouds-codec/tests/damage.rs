//! Damaged files: an error, or a coarser model that says so; never other bits, no panic, no memory
//! beyond what the bytes account for.

#![allow(clippy::unwrap_used)]

mod common;

use common::{packed, settings, solid};
use shrouds::{Grid, Occupancy};
use shrouds_codec::{
    Error, LabelMap, Planes, Profile, Settings, pack_labels, pack_with_planes, survey, unpack,
    unpack_labels, unpack_layers, unpack_partial,
};

/// A file with everything in it, its volume, and its planes. The profile `fast`, because what the other
/// needs to begin with takes longer than all else; chunks are the same.
fn file(independent: bool) -> (Vec<u8>, Occupancy, Planes) {
    let volume = solid([70, 12, 11], 0.4, 4, 3);
    let planes =
        Planes { settings: vec![1, 2], payloads: vec![(vec![9; 20], 1), (vec![8; 30], 2)] };
    let settings = Settings { independent, slab_height: Some(3), ..settings(Profile::Fast) };
    let mut bytes = Vec::new();
    pack_with_planes(&volume, &settings, &planes, &mut bytes).unwrap();
    (bytes, volume, planes)
}

/// What is unpacked is an error, or all of the volume and a beginning of its planes, and says when that
/// is not all.
fn check(bytes: &[u8], volume: &Occupancy, planes: &Planes) {
    match unpack(bytes) {
        Err(_) => {}
        Ok(unpacked) => {
            assert_eq!(&unpacked.volume, volume);
            let found: Vec<_> =
                unpacked.planes.into_iter().map(|p| (p.payload, p.decoded_sum)).collect();
            assert_eq!(found, planes.payloads[..found.len()]);
            // Nothing is whole but the file itself.
            assert_eq!(unpacked.lost.is_none(), found.len() == planes.payloads.len());
        }
    }
    let [nx, ny, nz] = volume.grid().dims();
    if let Ok(part) = unpack_partial(bytes) {
        let layers = part.volume.grid().dims()[2];
        assert_eq!(part.volume, volume.crop([0..nx, 0..ny, 0..layers]).unwrap());
        assert!(part.lost.is_some() || layers == nz);
    }
    if let Ok(part) = unpack_layers(bytes, 7..9) {
        assert_eq!(part, volume.crop([0..nx, 0..ny, 7..9]).unwrap());
    }
}

#[test]
fn every_truncation() {
    for independent in [false, true] {
        let (bytes, volume, planes) = file(independent);
        check(&bytes, &volume, &planes);
        for length in 0..bytes.len() {
            check(&bytes[..length], &volume, &planes);
            assert!(unpack(&bytes[..length]).map_or(true, |part| part.lost.is_some()), "{length}");
        }
    }
}

#[test]
fn ten_thousand_flips() {
    let (bytes, volume, planes) = file(true);
    for n in 0..10_000 {
        let mut damaged = bytes.clone();
        // One to four bits, anywhere.
        for flip in 0..=n % 4 {
            let at = common::number(n as u64, [flip, 0, 0]) as usize % (8 * bytes.len());
            damaged[at / 8] ^= 1 << (at % 8);
        }
        if damaged != bytes {
            check(&damaged, &volume, &planes);
        }
    }
}

#[test]
fn every_flip_and_truncation_of_labels_is_an_error() {
    let grid = Grid::new([20, 9, 8], [1.0; 3]).unwrap();
    let values: Vec<i64> = (0..grid.point_count())
        .map(|n| [0, 3, -7, 1 << 40][(n % 20 / 6 + n / 20 % 9 / 4 + n / 180 / 5) % 4])
        .collect();
    let map = LabelMap::new(grid, &values).unwrap();
    let mut bytes = Vec::new();
    pack_labels(&map, &settings(Profile::Fast), &mut bytes).unwrap();
    assert_eq!(unpack_labels(&bytes[..]).unwrap().1, map);
    for at in 0..8 * bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at / 8] ^= 1 << (at % 8);
        assert!(unpack_labels(&damaged[..]).is_err(), "bit {at}");
        assert!(unpack_labels(&bytes[..at / 8]).is_err(), "{} bytes", at / 8);
    }
    assert!(matches!(unpack(&bytes[..]), Err(Error::Content { .. })));
    let volume = packed(&solid([9, 9, 9], 0.4, 2, 3), &Settings::default());
    assert!(matches!(unpack_labels(&volume[..]), Err(Error::Content { .. })));
}

#[test]
fn damage_within_the_dense_profile() {
    let volume = solid([30, 9, 5], 0.4, 4, 3);
    let bytes = packed(&volume, &settings(Profile::Dense));
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(unpack(&damaged[..]).is_err() && unpack(&bytes[..at]).is_err(), "byte {at}");
    }
}

#[test]
fn messages_say_what_is_wrong() {
    let (bytes, ..) = file(false);
    let fails = |bytes: &[u8]| unpack(bytes).unwrap_err();
    assert!(matches!(fails(b"P5 12 12 255 not a volume"), Error::NotShroud));
    let mut other = bytes.clone();
    other[8] = 9;
    assert!(matches!(fails(&other), Error::Version { found: 9, known: 1 }));
    assert!(matches!(fails(&bytes[..20]), Error::Header(_)));
    let longer = [&bytes[..], &[0]].concat();
    assert!(matches!(fails(&longer), Error::Trailing));
    // The first slab is whole, and the file ends after it.
    let (header, chunks) = survey(&bytes[..]).unwrap();
    assert_eq!((header.slabs(), chunks.len()), (4, 6));
    let first = packed(&solid([70, 12, 11], 0.4, 4, 3), &Settings::default()).len();
    assert!(first < bytes.len());
    let lengths: Vec<_> = (0..bytes.len())
        .filter_map(|length| match unpack(&bytes[..length]) {
            Err(Error::Cut { layers, all: 11 }) => Some(layers),
            _ => None,
        })
        .collect();
    assert_eq!(lengths, [0, 3, 6, 9]);
}

/// A header with a sound check sum around these bytes.
fn header(body: &[u8]) -> Vec<u8> {
    let mut bytes = [b"\x89SHR\r\n\x1a\n\x01", &[body.len() as u8][..], body].concat();
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

#[test]
fn headers_that_make_no_sense() {
    // Content, profile, flags, planes; dims and slab height; frame; space, unit, plane settings, labels.
    let sound = [0, 1, 0, 0, 3, 3, 3, 3, 0, 0, 0, 0, 0];
    assert!(survey(&header(&sound)[..]).is_ok());
    for (place, value) in
        [(0, 1), (0, 2), (1, 2), (2, 8), (3, 9), (4, 0), (7, 0), (8, 5), (9, 1), (10, 200), (12, 1)]
    {
        let mut body = sound;
        body[place] = value;
        assert!(survey(&header(&body)[..]).is_err(), "byte {place} of {value}");
    }
    assert!(survey(&header(&sound[..12])[..]).is_err());
    assert!(survey(&header(&[&sound[..], &[0]].concat())[..]).is_err());
}

/// A sound header that claims a huge lattice, a sound chunk that claims to hold it, and one that claims a
/// huge payload.
#[test]
fn claims_are_not_believed() {
    // 2²⁰ − 2 by as many by 500 points, in one slab.
    let huge = [0xfe, 0xff, 0x3f];
    let dims = [&huge[..], &huge, &[0xf4, 0x03], &[0xf4, 0x03]].concat();
    for content in [0, 1] {
        // Profile, flags, planes; no frame, no names, no plane settings; the labels 0 and 1.
        let labels: &[u8] = if content == 1 { &[2, 0, 0] } else { &[0] };
        let body = [&[content, 0, 0, 0], &dims[..], &[0, 0, 0, 0], labels].concat();
        let mut bytes = self::header(&body);
        let (header, chunks) = survey(&bytes[..]).unwrap();
        assert_eq!((header.grid.dims()[2], chunks.len()), (500, 0));
        assert!(unpack(&bytes[..]).is_err() && unpack_labels(&bytes[..]).is_err());
        // A sound chunk of 20 bytes, which cannot hold them.
        let mut chunk = [&[2 * content + 1, 0, 20][..], &[7; 24]].concat();
        chunk.extend(crc32fast::hash(&chunk).to_le_bytes());
        let whole = [&bytes[..], &chunk].concat();
        let problem = match content {
            0 => unpack(&whole[..]).unwrap_err(),
            _ => unpack_labels(&whole[..]).unwrap_err(),
        };
        assert!(problem.to_string().contains("too short"), "{problem}");
        // A length of 2⁶² bytes that do not follow.
        bytes.extend([2 * content + 1, 0, 128, 128, 128, 128, 128, 128, 128, 128, 64]);
        assert!(unpack(&bytes[..]).is_err() && unpack_labels(&bytes[..]).is_err());
    }
}
