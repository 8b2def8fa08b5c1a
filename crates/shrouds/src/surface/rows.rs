//! Crossings of whole rows of lattice points, one word at a time.

use crate::volume::Occupancy;

/// The crossings of rows of a volume and the vertex numbers they get.
pub(super) struct Rows<'a> {
    volume: &'a Occupancy,
    /// Number of the first vertex of row `(j, k)` on grid edges along each axis.
    first: Vec<[u32; 3]>,
}

impl<'a> Rows<'a> {
    /// Numbers the crossings of a volume. Returns the number of crossings, and the rows if those can
    /// be numbered by 32 bits.
    pub(super) fn number(volume: &'a Occupancy) -> (u64, Option<Self>) {
        let [_, ny, nz] = volume.grid().dims();
        let mut rows = Self { volume, first: vec![[0; 3]; ny * nz] };
        let mut next = 0u64;
        for k in 0..nz {
            for j in 0..ny {
                for axis in 0..3 {
                    rows.first[k * ny + j][axis] = next as u32;
                    let words = rows.word_count();
                    next += (0..words)
                        .map(|w| u64::from(rows.word(axis, j, k, w).count_ones()))
                        .sum::<u64>();
                }
            }
        }
        let fits = next <= crate::surface::Surface::MAX_VERTICES;
        (next, fits.then_some(rows))
    }

    /// Words in a row.
    pub(super) fn word_count(&self) -> usize {
        self.volume.grid().dims()[0].div_ceil(64)
    }

    /// Number of the first vertex of row `(j, k)` on grid edges along `axis`.
    pub(super) fn first(&self, axis: usize, j: usize, k: usize) -> u32 {
        self.first[k * self.volume.grid().dims()[1] + j][axis]
    }

    /// Bits `64·w ..` of the crossings of row `(j, k)` along `axis`: bit `i` is set when the lattice
    /// points `[i, j, k]` and one step along `axis` lie on different sides.
    pub(super) fn word(&self, axis: usize, j: usize, k: usize, w: usize) -> u64 {
        let [nx, ny, nz] = self.volume.grid().dims();
        let row = self.volume.row(j, k);
        match axis {
            0 => (row[w] ^ shifted(row, w)) & mask_below(nx - 1, w),
            1 if j + 1 < ny => row[w] ^ self.volume.row(j + 1, k)[w],
            2 if k + 1 < nz => row[w] ^ self.volume.row(j, k + 1)[w],
            _ => 0,
        }
    }
}

/// Word `w` of a row moved down by one bit: bit `i` is lattice point `i + 1`.
pub(super) fn shifted(row: &[u64], w: usize) -> u64 {
    row[w] >> 1 | row.get(w + 1).map_or(0, |next| next << 63)
}

/// The bits of word `w` that stand for indices below `end`.
pub(super) fn mask_below(end: usize, w: usize) -> u64 {
    match end.saturating_sub(64 * w) {
        0 => 0,
        n if n >= 64 => u64::MAX,
        n => (1 << n) - 1,
    }
}

/// The positions of the set bits of a word, lowest first.
pub(super) fn set_bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (word != 0).then(|| {
            let bit = word.trailing_zeros() as usize;
            word &= word - 1;
            bit
        })
    })
}
