//! Volumes that several tests share.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

use proptest::prelude::*;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy};

/// Random volumes of a few lattice points a side, at every density; some rows cross a word boundary.
pub fn volumes() -> impl Strategy<Value = Occupancy> {
    (prop_oneof![3 => 2usize..7, 1 => 62usize..68], 2usize..7, 2usize..7, 0.1..0.9f64)
        .prop_flat_map(|(nx, ny, nz, density)| {
            proptest::collection::vec(proptest::bool::weighted(density), nx * ny * nz).prop_map(
                move |bits| {
                    let grid = Grid::new([nx, ny, nz], [1.0, 1.5, 2.5]).unwrap();
                    Occupancy::from_slice(grid, &bits, |inside| inside).unwrap()
                },
            )
        })
}

/// Both face rules with both borders.
pub const CONVENTIONS: [(FaceRule, Border); 4] = [
    (FaceRule::Separate, Border::Closed),
    (FaceRule::Join, Border::Closed),
    (FaceRule::Separate, Border::Open),
    (FaceRule::Join, Border::Open),
];
