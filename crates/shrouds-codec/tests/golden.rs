//! Files of every profile, as the first version of the format has them. They are never edited: what
//! was packed once has to come back for ever, and be packed to the same bytes as long as the version
//! of the format is the same.
//!
//! `SHROUDS_WRITE_GOLDEN=1 cargo test -p shrouds-codec --test golden` writes those that are missing.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;
use std::path::Path;

use shrouds::volume::phantom;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy};
use shrouds_codec::{LabelMap, Profile, Settings, pack_labels, unpack, unpack_labels};

/// Bodies of integers alone, so that no platform rounds them otherwise.
fn body([i, j, k]: [usize; 3]) -> bool {
    let [x, y, z] = [i, j, k].map(|i| i as i64);
    let ball = |[a, b, c]: [i64; 3], radius: i64| {
        (x - a).pow(2) + (y - b).pow(2) + (z - c).pow(2) <= radius * radius
    };
    let speck = common::number(7, [i, j, k]).is_multiple_of(97) && i > 50;
    ball([20, 18, 14], 12) && !ball([26, 20, 14], 7) || ball([44, 12, 16], 9) || speck
}

fn volume() -> Occupancy {
    let affine = [[0.5, 0.0, 0.0, -10.0], [0.0, 0.75, 0.25, 3.0], [0.0, -0.25, 2.0, 0.125]];
    Occupancy::from_fn(Grid::with_affine([70, 36, 30], affine).unwrap(), body)
}

fn labels() -> LabelMap {
    let grid = Grid::new([24, 20, 16], [1.0, 1.0, 2.5]).unwrap();
    let values: Vec<i64> = (0..grid.point_count())
        .map(|n| {
            let [i, j, k] = [n % 24, n / 24 % 20, n / 480];
            if body([2 * i, 2 * j, 2 * k]) { 5 } else { [0, -2, 300][i * j * k / 900 % 3] }
        })
        .collect();
    LabelMap::new(grid, &values).unwrap()
}

fn golden(name: &str, bytes: &[u8]) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    if !path.exists() && std::env::var_os("SHROUDS_WRITE_GOLDEN").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
    }
    fs::read(&path).unwrap()
}

#[test]
fn volumes_are_packed_and_unpacked_as_ever() {
    for (name, profile, independent) in [
        ("fast.shroud", Profile::Fast, false),
        ("dense.shroud", Profile::Dense, false),
        ("dense-slabs.shroud", Profile::Dense, true),
    ] {
        let settings = Settings {
            profile,
            independent,
            slab_height: Some(if independent { 8 } else { 30 }),
            faces: FaceRule::Join,
            border: Border::Open,
            space: "RAS".into(),
            unit: "mm".into(),
        };
        let bytes = common::packed(&volume(), &settings);
        let golden = golden(name, &bytes);
        assert!(bytes == golden, "{name}: other bytes than ever");
        let unpacked = unpack(&golden[..]).unwrap();
        assert_eq!(unpacked.volume, volume());
        assert_eq!((unpacked.header.faces, unpacked.header.border), (FaceRule::Join, Border::Open));
    }
}

#[test]
fn labels_are_packed_and_unpacked_as_ever() {
    for (name, profile) in
        [("labels-fast.shroud", Profile::Fast), ("labels-dense.shroud", Profile::Dense)]
    {
        let settings = Settings { slab_height: Some(8), ..common::settings(profile) };
        let mut bytes = Vec::new();
        pack_labels(&labels(), &settings, &mut bytes).unwrap();
        let golden = golden(name, &bytes);
        assert!(bytes == golden, "{name}: other bytes than ever");
        assert_eq!(unpack_labels(&golden[..]).unwrap().1, labels());
    }
}

/// The bytes of a file that `docs/format.md` explains.
#[test]
fn the_page_about_the_format_is_right() {
    let page =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/format.md"))
            .unwrap();
    let dump: Vec<u8> = page
        .lines()
        .filter_map(|line| line.strip_prefix("| `").and_then(|rest| rest.split_once('`')))
        .filter(|(bytes, _)| bytes.split(' ').all(|byte| byte.len() == 2))
        .flat_map(|(bytes, _)| bytes.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()))
        .collect();
    let volume =
        phantom::block(&Grid::new([6, 5, 4], [1.0, 1.0, 2.0]).unwrap(), [1, 1, 1], [3, 2, 2]);
    let settings =
        Settings { space: "LPS".into(), unit: "mm".into(), ..common::settings(Profile::Fast) };
    let bytes = common::packed(&volume.unwrap(), &settings);
    let hex = |bytes: &[u8]| bytes.iter().map(|b| format!("{b:02x}")).collect::<Vec<_>>().join(" ");
    assert_eq!(hex(&dump), hex(&bytes));
}
