//! Marked places of the lattice, three of them at every lattice point, and their numbers.

use crate::parallel;
use crate::surface::bits::{rank, set_bits};

/// A bit for each of the three grid edges that start at a lattice point, or for each of the three
/// faces, with the number of marked ones before it: by z, then y, then axis, then x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Marks {
    dims: [usize; 3],
    /// Words of a row.
    words: usize,
    bits: Vec<u64>,
    /// Number of marked places before each word.
    before: Vec<u32>,
    count: u64,
}

impl Marks {
    /// Marks what `row` sets for rows `(j, k)`: the words of the three axes, one axis after another.
    pub(super) fn new(dims: [usize; 3], row: impl Fn(usize, usize, &mut [u64]) + Sync) -> Self {
        let [nx, ny, nz] = dims;
        let words = nx.div_ceil(64);
        let per_row = 3 * words;
        let mut bits = vec![0; per_row * ny * nz];
        let ends = (1..=nz).map(|k| k * ny * per_row);
        parallel::pieces(&mut bits, ends, |k, slice| {
            for (j, words) in slice.chunks_exact_mut(per_row).enumerate() {
                row(j, k, words);
            }
        });
        let mut count = 0u64;
        let number = |word: &u64| {
            let before = count as u32;
            count += u64::from(word.count_ones());
            before
        };
        let before = bits.iter().map(number).collect();
        Self { dims, words, bits, before, count }
    }

    /// How many places are marked.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Words of a row.
    pub(super) fn words(&self) -> usize {
        self.words
    }

    /// The words of a row for an axis.
    #[inline]
    pub(super) fn row(&self, axis: usize, j: usize, k: usize) -> &[u64] {
        let start = (3 * (k * self.dims[1] + j) + axis) * self.words;
        &self.bits[start..start + self.words]
    }

    /// The number of a marked place.
    #[inline]
    pub(super) fn number(&self, axis: usize, [i, j, k]: [usize; 3]) -> u32 {
        let word = (3 * (k * self.dims[1] + j) + axis) * self.words + i / 64;
        debug_assert!(self.bits[word] >> (i % 64) & 1 == 1, "{axis} {:?}", [i, j, k]);
        self.before[word] + rank(self.bits[word], (i % 64) as u32)
    }

    /// The number of a place if it is marked.
    #[inline]
    pub(super) fn number_if_marked(&self, axis: usize, place: [usize; 3]) -> Option<u32> {
        let [i, j, k] = place;
        let is_marked = self.row(axis, j, k)[i / 64] >> (i % 64) & 1 == 1;
        is_marked.then(|| self.number(axis, place))
    }

    /// All marked places in order, with their axes.
    pub(super) fn places<T: Send + Clone + Default>(
        &self,
        place: impl Fn(usize, [usize; 3]) -> T + Sync,
    ) -> Vec<T> {
        let [_, ny, nz] = self.dims;
        let mut places = vec![T::default(); self.count as usize];
        let per_slice = 3 * self.words * ny;
        let end =
            |k: usize| self.before.get(k * per_slice).map_or(self.count as usize, |&n| n as usize);
        parallel::pieces(&mut places, (1..=nz).map(end), |k, places| {
            let mut slots = places.iter_mut();
            for (j, axis) in (0..ny).flat_map(|j| (0..3).map(move |axis| (j, axis))) {
                for (w, &word) in self.row(axis, j, k).iter().enumerate() {
                    for (bit, slot) in set_bits(word).zip(slots.by_ref()) {
                        *slot = place(axis, [64 * w + bit as usize, j, k]);
                    }
                }
            }
        });
        places
    }
}
