//! What the tables of the profile `dense` look at.

use crate::topology::fast::nearest;
use crate::topology::window::Window;

/// The number of tables.
pub(super) const CONTEXTS: usize = 7;
/// Binary logarithm of the number of entries of a table.
pub(super) const SIZE_BITS: u32 = 18;
/// The sets of each mixer, and the contexts of each refinement.
pub(super) const SETS: [usize; 2] = [8, 64];
pub(super) const REFINED: [usize; 2] = [1 << 10, 1 << REFINED_BITS];
const REFINED_BITS: u32 = 10;

/// Voxels by their row in a window and their bit in it, the lowest bit of a context first: those that
/// touch, less some of the corners.
const TOUCHING: [(usize, u32); 12] = [
    (0, 0),
    (0, 1),
    (1, 2),
    (1, 3),
    (1, 4),
    (2, 2),
    (2, 3),
    (2, 4),
    (3, 3),
    (4, 3),
    (5, 3),
    (6, 3),
];
/// What is next after the 18 nearest, and what is next after these.
const WIDER: [(usize, u32); 13] = [
    (0, 2),
    (0, 3),
    (5, 2),
    (5, 4),
    (4, 5),
    (6, 2),
    (6, 4),
    (7, 3),
    (9, 3),
    (10, 3),
    (11, 3),
    (1, 1),
    (2, 1),
];
const WIDEST: [(usize, u32); 15] = [
    (2, 6),
    (1, 6),
    (5, 5),
    (3, 5),
    (7, 2),
    (7, 4),
    (8, 3),
    (6, 5),
    (10, 2),
    (10, 4),
    (9, 2),
    (9, 4),
    (12, 3),
    (3, 1),
    (4, 1),
];
/// The last three layers in a cross along x and y, and what touches in this one.
const COLUMNS: [(usize, u32); 18] = [
    (2, 2),
    (2, 3),
    (2, 4),
    (6, 2),
    (6, 3),
    (6, 4),
    (11, 2),
    (11, 3),
    (11, 4),
    (3, 3),
    (9, 3),
    (15, 3),
    (4, 3),
    (10, 3),
    (16, 3),
    (0, 0),
    (0, 1),
    (1, 3),
];
/// The six nearest rows, of which it counts where the side changes.
const EDGES: [usize; 6] = [1, 2, 3, 4, 5, 6];

/// Rows of five voxels that are counted together, and their bits.
const LAYER_BEFORE: [usize; 5] = [2, 3, 4, 7, 8];
const LAYER_EARLIER: [usize; 5] = [6, 9, 10, 13, 14];
const ROWS_BESIDE: [usize; 3] = [1, 5, 12];
const FIVE: u8 = 0b11_1110;
const THREE_BEFORE: u8 = 0b111;

/// Places in the tables, the sets of the mixers, and the contexts of the refinements.
pub(super) struct Contexts {
    pub(super) places: [usize; CONTEXTS],
    pub(super) sets: [usize; 2],
    pub(super) refined: [usize; 2],
}

impl Contexts {
    #[inline]
    pub(super) fn of(window: &Window) -> Self {
        let touching = gather(window, &TOUCHING);
        let near = nearest(window) as u64;
        let wider = near | gather(window, &WIDER) << 18;
        let widest = wider | gather(window, &WIDEST) << 31;
        let before = count(window, &LAYER_BEFORE);
        let earlier = count(window, &LAYER_EARLIER);
        let beside =
            count(window, &ROWS_BESIDE) + u64::from((window[0] & THREE_BEFORE).count_ones());
        let edges = EDGES.iter().fold(u64::from(window[0]) & 7, |edges, &row| {
            edges << 4 | u64::from(EDGE[usize::from(window[row])])
        });
        let counts =
            before | (earlier / 2) << 5 | beside << 9 | (touching & 0b1010_0100_1011) << 14;
        let faces = touching & 1 | touching >> 2 & 2 | touching >> 4 & 4;
        let eighths = (before / 4).min(7) << 3 | (earlier / 4).min(7);
        Self {
            places: [
                touching as usize,
                near as usize,
                hash(wider, SIZE_BITS),
                hash(widest + 1, SIZE_BITS),
                hash(edges + 2, SIZE_BITS),
                gather(window, &COLUMNS) as usize,
                hash(counts + 3, SIZE_BITS),
            ],
            sets: [faces as usize, eighths as usize],
            refined: [
                touching as usize % REFINED[0],
                hash(before | beside << 5 | earlier << 10, REFINED_BITS),
            ],
        }
    }
}

/// Some voxels of a window, the first in the lowest bit.
#[inline(always)]
fn gather<const COUNT: usize>(window: &Window, voxels: &[(usize, u32); COUNT]) -> u64 {
    voxels.iter().rev().fold(0, |bits, &(row, bit)| bits << 1 | u64::from(window[row] >> bit & 1))
}

/// How many of the five nearest voxels of some rows are inside.
#[inline(always)]
fn count(window: &Window, rows: &[usize]) -> u64 {
    rows.iter().map(|&row| u64::from((window[row] & FIVE).count_ones())).sum()
}

/// The highest bits of a product: Fibonacci hashing.
#[inline(always)]
fn hash(context: u64, bits: u32) -> usize {
    (context.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - bits)) as usize
}

/// Steps from the middle of a row of a window, bit 3, to the nearer place where the side changes: 1 to 4
/// after it, 5 to 7 for 1 to 3 before it, 0 for none. Times two, and 1 more where the middle is inside.
static EDGE: [u8; 256] = {
    let mut table = [0; 256];
    let mut row = 0;
    while row < 256 {
        let inside = row as u8 >> 3 & 1;
        // 1 where the side is not that of the middle.
        let other = row as u8 ^ 0u8.wrapping_sub(inside);
        let after = (other >> 3).trailing_zeros();
        let before = (other << 4).leading_zeros() + 1;
        let steps = match (after, before) {
            (1..=4, _) if after <= before => after,
            (_, 1..=3) => before + 4,
            (1..=4, _) => after,
            _ => 0,
        };
        table[row] = (steps as u8) << 1 | inside;
        row += 1;
    }
    table
};
