//! The profile `fast`: one table.

use crate::counter::Counter;
use crate::topology::window::{Model, Window};

/// Bits after which a counter begins to forget.
const MEMORY: u32 = 1000;

/// A counter for each pattern of the 18 nearest voxels.
#[derive(Debug, Clone)]
pub struct Fast {
    counters: Vec<Counter>,
    pattern: usize,
}

impl Default for Fast {
    fn default() -> Self {
        Self { counters: vec![Counter::default(); 1 << 18], pattern: 0 }
    }
}

impl Model for Fast {
    const ROWS: usize = 6;

    #[inline(always)]
    fn predict(&mut self, window: &Window) -> u16 {
        self.pattern = nearest(window);
        self.counters[self.pattern].probability()
    }

    #[inline(always)]
    fn update(&mut self, inside: bool) {
        self.counters[self.pattern].update(inside, MEMORY);
    }
}

/// The 18 nearest voxels of a window: two before, four in each of the two rows that touch, three in each
/// of those that touch by an edge in the layer before, and one two steps away along y and z.
#[inline(always)]
pub(super) fn nearest(window: &Window) -> usize {
    let bits =
        |row: usize, first: u32, count: u32| usize::from(window[row]) >> first & ((1 << count) - 1);
    bits(0, 0, 2)
        | bits(1, 2, 4) << 2
        | bits(2, 2, 4) << 6
        | bits(3, 2, 3) << 10
        | bits(4, 2, 3) << 13
        | bits(5, 3, 1) << 16
        | bits(6, 3, 1) << 17
}
