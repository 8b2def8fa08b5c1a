//! What the tests share.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub)]

use shrouds::{Grid, Occupancy};
use shrouds_codec::{Profile, Settings, pack};

/// A number for a place, always the same.
pub fn number(seed: u64, index: [usize; 3]) -> u64 {
    index.iter().fold(seed, |state, &i| {
        let mut z = (state ^ i as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

/// A volume of random blocks.
pub fn solid(dims: [usize; 3], density: f64, blocks: usize, seed: u64) -> Occupancy {
    Occupancy::from_fn(Grid::new(dims, [1.0; 3]).unwrap(), |index| {
        number(seed, index.map(|i| i / blocks)) as f64 / 2f64.powi(64) < density
    })
}

pub fn settings(profile: Profile) -> Settings {
    Settings { profile, ..Settings::default() }
}

pub fn packed(volume: &Occupancy, settings: &Settings) -> Vec<u8> {
    let mut bytes = Vec::new();
    let packed = pack(volume, settings, &mut bytes).unwrap();
    assert_eq!(packed.bytes, bytes.len() as u64);
    bytes
}
