//! What the tables of the profile `dense` look at.

use crate::topology::fast::nearest;
use crate::topology::window::Window;

/// The number of tables.
pub(super) const CONTEXTS: usize = 7;
/// Binary logarithm of the number of entries of a table.
pub(super) const SIZE_BITS: u32 = 18;

/// Places in the tables, the sets of the mixers, and the contexts of the refinements.
pub(super) struct Contexts {
    pub(super) places: [usize; CONTEXTS],
    pub(super) sets: [usize; 2],
    pub(super) refined: [usize; 2],
}

impl Contexts {
    pub(super) fn of(window: &Window) -> Self {
        let bits = |row: usize, first: u32, count: u32| {
            u64::from(window[row]) >> first & ((1 << count) - 1)
        };
        let touching = bits(0, 0, 2)
            | bits(1, 2, 3) << 2
            | bits(2, 2, 3) << 5
            | bits(3, 3, 1) << 8
            | bits(4, 3, 1) << 9
            | bits(5, 3, 1) << 10
            | bits(6, 3, 1) << 11;
        let near = nearest(window) as u64;
        let wider = near
            | bits(0, 2, 2) << 18
            | bits(5, 2, 1) << 20
            | bits(5, 4, 1) << 21
            | bits(4, 5, 1) << 22
            | bits(6, 2, 1) << 23
            | bits(6, 4, 1) << 24
            | bits(7, 3, 1) << 25
            | bits(9, 3, 1) << 26
            | bits(10, 3, 1) << 27
            | bits(11, 3, 1) << 28
            | bits(1, 1, 1) << 29
            | bits(2, 1, 1) << 30;
        let widest = wider
            | bits(2, 6, 1) << 31
            | bits(1, 6, 1) << 32
            | bits(5, 5, 1) << 33
            | bits(3, 5, 1) << 34
            | bits(7, 2, 1) << 35
            | bits(7, 4, 1) << 36
            | bits(8, 3, 1) << 37
            | bits(6, 5, 1) << 38
            | bits(10, 2, 1) << 39
            | bits(10, 4, 1) << 40
            | bits(9, 2, 1) << 41
            | bits(9, 4, 1) << 42
            | bits(12, 3, 1) << 43
            | bits(3, 1, 1) << 44
            | bits(4, 1, 1) << 45;
        let edge = |row: usize| u64::from(EDGE[usize::from(window[row])]);
        let rows = edge(1)
            | edge(2) << 4
            | edge(3) << 8
            | edge(4) << 12
            | edge(5) << 16
            | edge(6) << 20
            | bits(0, 0, 3) << 24;
        let columns = bits(2, 2, 3)
            | bits(6, 2, 3) << 3
            | bits(11, 2, 3) << 6
            | bits(3, 3, 1) << 9
            | bits(9, 3, 1) << 10
            | bits(15, 3, 1) << 11
            | bits(4, 3, 1) << 12
            | bits(10, 3, 1) << 13
            | bits(16, 3, 1) << 14
            | bits(0, 0, 2) << 15
            | bits(1, 3, 1) << 17;
        let count = |rows: &[usize], mask: u8| -> u64 {
            rows.iter().map(|&row| u64::from((window[row] & mask).count_ones())).sum()
        };
        let before = count(&[2, 3, 4, 7, 8], 0x3e);
        let earlier = count(&[6, 9, 10, 13, 14], 0x3e);
        let beside = count(&[1, 5, 12], 0x3e) + u64::from((window[0] & 7).count_ones());
        let counts = before | earlier / 2 << 5 | beside << 9 | (touching & 0x2a4b & 0xfff) << 14;
        let hash = |context: u64| {
            (context.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - SIZE_BITS)) as usize
        };
        let touched = (bits(0, 0, 1) | bits(1, 3, 1) << 1 | bits(2, 3, 1) << 2) as usize;
        Self {
            places: [
                touching as usize,
                near as usize,
                hash(wider),
                hash(widest + 1),
                hash(rows + 2),
                columns as usize,
                hash(counts + 3),
            ],
            sets: [touched, ((before / 4).min(7) * 8 + (earlier / 4).min(7)) as usize],
            refined: [
                (touching & 0x3ff) as usize,
                (hash(before | beside << 5 | earlier << 10) >> (SIZE_BITS - 10)) as usize,
            ],
        }
    }
}

/// Where the side changes next to the middle of a row of a window, and which side the middle is on.
static EDGE: [u8; 256] = {
    let mut table = [0; 256];
    let mut row = 0;
    while row < 256 {
        let middle = row >> 3 & 1;
        let flipped = (row ^ (if middle == 1 { 255 } else { 0 })) as u8;
        let after = (flipped >> 3).trailing_zeros();
        let before = (flipped << 4).leading_zeros();
        // Steps to the nearer change, odd after and even before; none within reach is 0.
        let after = if after > 5 { 6 } else { after };
        let before = if before > 4 { 6 } else { before + 1 };
        let steps = if after == 6 && before == 6 {
            0
        } else if after <= before {
            if after > 4 { 4 } else { after }
        } else if before > 3 {
            7
        } else {
            before + 3
        };
        table[row] = (steps as u8) << 1 | middle as u8;
        row += 1;
    }
    table
};
