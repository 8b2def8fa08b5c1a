//! What goes in comes out.

#![allow(clippy::unwrap_used)]

mod common;

use common::{packed, settings, solid};
use proptest::prelude::*;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Grid, Occupancy};
use shrouds_codec::{
    Content, LabelMap, Packer, Planes, Profile, Settings, pack, pack_labels, pack_with_planes,
    survey, unpack, unpack_labels, unpack_layers,
};

const PROFILES: [Profile; 2] = [Profile::Fast, Profile::Dense];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn volumes_come_back(
        dims in [1..140usize, 1..9usize, 1..9usize],
        density in 0.0..1.0f64,
        blocks in 1..12usize,
        seed in any::<u64>(),
        height in 1..5usize,
        independent: bool,
    ) {
        let volume = solid(dims, density, blocks, seed);
        for profile in PROFILES {
            let settings = Settings { independent, slab_height: Some(height), ..settings(profile) };
            let bytes = packed(&volume, &settings);
            let unpacked = unpack(&bytes[..]).unwrap();
            prop_assert_eq!(&unpacked.volume, &volume);
            prop_assert_eq!(unpacked.lost, None);
        }
    }

    #[test]
    fn labels_come_back(
        dims in [1..80usize, 1..7usize, 1..7usize],
        blocks in 1..12usize,
        labels in prop::collection::vec(any::<i64>(), 1..9),
        seed in any::<u64>(),
        height in 1..5usize,
        independent: bool,
    ) {
        let grid = Grid::new(dims, [1.0; 3]).unwrap();
        let values: Vec<i64> = (0..grid.point_count())
            .map(|n| {
                let [i, j, k] = [n % dims[0], n / dims[0] % dims[1], n / dims[0] / dims[1]];
                let number = common::number(seed, [i / blocks, j / blocks, k / blocks]);
                labels[number as usize % labels.len()]
            })
            .collect();
        let map = LabelMap::new(grid, &values).unwrap();
        prop_assert!(map.values().eq(values.iter().copied()));
        for profile in PROFILES {
            let settings = Settings { independent, slab_height: Some(height), ..settings(profile) };
            let mut bytes = Vec::new();
            pack_labels(&map, &settings, &mut bytes).unwrap();
            let (header, back) = unpack_labels(&bytes[..]).unwrap();
            prop_assert_eq!(&header.content, &Content::Labels(map.labels().to_vec()));
            prop_assert_eq!(&back, &map);
        }
    }
}

#[test]
fn empty_and_full_volumes_take_next_to_nothing() {
    for inside in [false, true] {
        let grid = Grid::new([300, 300, 300], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid, |_| inside);
        for profile in PROFILES {
            let bytes = packed(&volume, &settings(profile));
            assert!(bytes.len() < 400, "{} bytes", bytes.len());
            assert_eq!(unpack(&bytes[..]).unwrap().volume, volume);
        }
    }
}

#[test]
fn smooth_surfaces_take_a_fraction_of_a_bit() {
    let volume = phantom::linked_tori(64).unwrap();
    let [fast, dense] = PROFILES.map(|profile| packed(&volume, &settings(profile)).len());
    // The bits themselves are 32 768 bytes.
    assert!(fast < 1000 && dense < fast * 3 / 4, "{fast} and {dense} bytes");
}

#[test]
fn the_frame_and_the_conventions_come_back() {
    let frames = [
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        [[0.5, 0.0, 0.0, -3.0], [0.0, 0.25, 0.0, 7.0], [0.0, 0.0, -2.0, 1e-9]],
        [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]],
    ];
    for affine in frames {
        let grid = Grid::with_affine([5, 4, 3], affine).unwrap();
        let volume = Occupancy::from_fn(grid, |[i, j, k]| (i + j + k) % 3 == 0);
        let settings = Settings {
            space: "RAS".into(),
            unit: "µm".into(),
            faces: FaceRule::Join,
            border: Border::Open,
            ..Settings::default()
        };
        let unpacked = unpack(&packed(&volume, &settings)[..]).unwrap();
        assert_eq!(unpacked.volume, volume);
        let header = unpacked.header;
        assert_eq!((&*header.space, &*header.unit), ("RAS", "µm"));
        assert_eq!((header.faces, header.border), (FaceRule::Join, Border::Open));
    }
}

#[test]
fn layers_that_come_one_by_one_make_the_same_file() {
    let volume = solid([70, 9, 11], 0.3, 3, 5);
    for (profile, independent) in [(Profile::Fast, true), (Profile::Dense, false)] {
        let settings = Settings { independent, slab_height: Some(4), ..settings(profile) };
        let bytes = packed(&volume, &settings);
        let header = unpack(&bytes[..]).unwrap().header;
        let mut packer = Packer::new(header, Vec::new()).unwrap();
        for k in 0..11 {
            let layer: Vec<u64> = (0..9).flat_map(|j| volume.row(j, k)).copied().collect();
            packer.layer(&layer).unwrap();
        }
        assert!(packer.layer(&[0; 18]).is_err());
        assert_eq!(packer.finish().unwrap().1, bytes);
    }
}

#[test]
fn some_layers_are_a_volume_of_their_own() {
    let volume = solid([70, 9, 23], 0.3, 3, 6);
    for independent in [false, true] {
        let settings = Settings { independent, slab_height: Some(4), ..settings(Profile::Dense) };
        let bytes = packed(&volume, &settings);
        for range in [0..23, 0..1, 3..9, 4..8, 22..23] {
            let part = unpack_layers(&bytes[..], range.clone()).unwrap();
            assert_eq!(part, volume.crop([0..70, 0..9, range]).unwrap());
        }
        assert!(unpack_layers(&bytes[..], 20..24).is_err());
        assert!(unpack_layers(&bytes[..], 5..5).is_err());
    }
}

#[test]
fn planes_are_carried_as_they_are() {
    let volume = solid([20, 9, 11], 0.3, 3, 5);
    let planes =
        Planes { settings: vec![7, 8], payloads: vec![(vec![1, 2, 3], 4), (Vec::new(), 5)] };
    let mut bytes = Vec::new();
    let packed = pack_with_planes(&volume, &Settings::default(), &planes, &mut bytes).unwrap();
    assert_eq!((packed.planes, packed.bytes), (3, bytes.len() as u64));
    let unpacked = unpack(&bytes[..]).unwrap();
    assert_eq!((unpacked.header.planes, &unpacked.header.plane_settings), (2, &vec![7, 8]));
    let back: Vec<_> = unpacked.planes.into_iter().map(|p| (p.payload, p.decoded_sum)).collect();
    assert_eq!(back, planes.payloads);
    assert_eq!(survey(&bytes[..]).unwrap().1.len(), 3);
}

#[test]
fn what_cannot_be_packed_is_refused() {
    let volume = solid([5, 5, 5], 0.3, 1, 5);
    let settings = Settings { slab_height: Some(0), ..Settings::default() };
    assert!(pack(&volume, &settings, Vec::new()).is_err());
    let planes = Planes { payloads: vec![(Vec::new(), 0); 9], ..Planes::default() };
    assert!(pack_with_planes(&volume, &Settings::default(), &planes, Vec::new()).is_err());
    assert!(LabelMap::new(volume.grid().clone(), &[0; 124]).is_err());
}

#[test]
fn the_bytes_are_the_same_on_any_number_of_threads() {
    let volume = phantom::linked_tori(48).unwrap();
    for profile in PROFILES {
        let settings = Settings { independent: true, slab_height: Some(5), ..settings(profile) };
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let bytes = packed(&volume, &settings);
                assert_eq!(unpack(&bytes[..]).unwrap().volume, volume);
                bytes
            })
        });
        assert_eq!(one, three);
    }
}
