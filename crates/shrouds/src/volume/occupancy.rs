//! The set of inside lattice points, one bit each.

use std::ops::Range;

use crate::error::Error;
use crate::grid::Grid;
use crate::parallel;

/// Which lattice points are inside, with the grid they lie on.
///
/// Bits are packed x fastest: each row of constant `(j, k)` starts a new 64-bit word and bit `i % 64`
/// of word `i / 64` is lattice point `i`. Bits past the end of a row are 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Occupancy {
    grid: Grid,
    words_per_row: usize,
    words: Vec<u64>,
}

impl Occupancy {
    /// A volume with nothing inside.
    pub fn empty(grid: Grid) -> Self {
        let [nx, ny, nz] = grid.dims();
        let words_per_row = nx.div_ceil(64);
        Self { grid, words_per_row, words: vec![0; words_per_row * ny * nz] }
    }

    /// The volume of all lattice points `[i, j, k]` for which `inside` holds.
    pub fn from_fn(grid: Grid, inside: impl Fn([usize; 3]) -> bool + Sync) -> Self {
        let mut volume = Self::empty(grid);
        let [nx, ny, _] = volume.grid.dims();
        let words_per_row = volume.words_per_row;
        parallel::fill(&mut volume.words, |index| {
            let (row, word) = (index / words_per_row, index % words_per_row);
            let (j, k) = (row % ny, row / ny);
            let first = word * 64;
            (first..nx.min(first + 64))
                .fold(0, |bits, i| bits | u64::from(inside([i, j, k])) << (i - first))
        });
        volume
    }

    /// The volume of all lattice points whose value satisfies `inside`.
    ///
    /// `values` holds one value per lattice point, x fastest, then y, then z.
    ///
    /// # Errors
    /// [`Error::Length`] when the number of values is not the number of lattice points.
    pub fn from_slice<T: Copy + Sync>(
        grid: Grid,
        values: &[T],
        inside: impl Fn(T) -> bool + Sync,
    ) -> Result<Self, Error> {
        if values.len() != grid.point_count() {
            return Err(Error::Length {
                values: values.len(),
                dims: grid.dims(),
                points: grid.point_count(),
            });
        }
        let [nx, ny, _] = grid.dims();
        Ok(Self::from_fn(grid, |[i, j, k]| inside(values[(k * ny + j) * nx + i])))
    }

    /// The lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Whether lattice point `[i, j, k]` is inside.
    ///
    /// # Panics
    /// When the index lies outside the grid.
    pub fn get(&self, [i, j, k]: [usize; 3]) -> bool {
        assert!(i < self.grid.dims()[0], "x index {i} outside {:?}", self.grid.dims());
        self.row(j, k)[i / 64] >> (i % 64) & 1 == 1
    }

    /// Puts lattice point `[i, j, k]` inside or outside.
    ///
    /// # Panics
    /// When the index lies outside the grid.
    pub fn set(&mut self, [i, j, k]: [usize; 3], inside: bool) {
        let [nx, ny, nz] = self.grid.dims();
        assert!(i < nx && j < ny && k < nz, "index [{i}, {j}, {k}] outside {:?}", [nx, ny, nz]);
        let word = &mut self.words[(k * ny + j) * self.words_per_row + i / 64];
        *word = *word & !(1 << (i % 64)) | u64::from(inside) << (i % 64);
    }

    /// The words of row `(j, k)`, bit `i` being lattice point `[i, j, k]`.
    ///
    /// # Panics
    /// When the row lies outside the grid.
    pub fn row(&self, j: usize, k: usize) -> &[u64] {
        let [_, ny, nz] = self.grid.dims();
        assert!(j < ny && k < nz, "row ({j}, {k}) outside {:?}", self.grid.dims());
        let start = (k * ny + j) * self.words_per_row;
        &self.words[start..start + self.words_per_row]
    }

    /// The lattice points in some rows of some slices, with a grid whose place is that of the whole.
    pub(crate) fn crop(&self, rows: Range<usize>, slices: Range<usize>) -> Self {
        let grid = self.grid.crop(rows.clone(), slices.clone());
        let [_, ny, _] = self.grid.dims();
        let row = |j: usize, k: usize| (k * ny + j) * self.words_per_row;
        let words = slices
            .flat_map(|k| &self.words[row(rows.start, k)..row(rows.end, k)])
            .copied()
            .collect();
        Self { grid, words_per_row: self.words_per_row, words }
    }

    /// Number of inside lattice points.
    pub fn count(&self) -> u64 {
        self.words.iter().map(|w| u64::from(w.count_ones())).sum()
    }

    /// The same volume with `margin` (at most 63) layers of outside points around it.
    ///
    /// # Errors
    /// [`Error::Dimensions`] when the padded grid is too large.
    ///
    /// # Panics
    /// When `margin` exceeds 63.
    pub fn padded(&self, margin: usize) -> Result<Self, Error> {
        assert!(margin < 64, "margin {margin} exceeds one word");
        let mut padded = Self::empty(self.grid.padded(margin)?);
        let [_, ny, nz] = self.grid.dims();
        let [_, padded_ny, _] = padded.grid.dims();
        for k in 0..nz {
            for j in 0..ny {
                let start = ((k + margin) * padded_ny + j + margin) * padded.words_per_row;
                let target = &mut padded.words[start..start + padded.words_per_row];
                for (w, &bits) in self.row(j, k).iter().enumerate() {
                    target[w] |= bits << margin;
                    if margin > 0 && w + 1 < target.len() {
                        target[w + 1] |= bits >> (64 - margin);
                    }
                }
            }
        }
        Ok(padded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern([i, j, k]: [usize; 3]) -> bool {
        (i * 7 + j * 5 + k * 3) % 4 == 0
    }

    #[test]
    fn bits_are_where_they_were_put() {
        let grid = Grid::new([131, 3, 4], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid.clone(), pattern);
        let values: Vec<u8> =
            (0..131 * 12).map(|n| pattern([n % 131, n / 131 % 3, n / 393]).into()).collect();
        assert_eq!(volume, Occupancy::from_slice(grid, &values, |v| v != 0).unwrap());
        assert_eq!(volume.count(), values.iter().map(|&v| u64::from(v)).sum::<u64>());
        assert!(volume.get([128, 0, 0]) == pattern([128, 0, 0]));
    }

    #[test]
    fn padding_moves_every_bit() {
        for nx in [1, 62, 63, 64, 65, 127, 130] {
            let grid = Grid::new([nx, 2, 3], [1.0; 3]).unwrap();
            let volume = Occupancy::from_fn(grid, pattern);
            let padded = volume.padded(1).unwrap();
            assert_eq!(padded.count(), volume.count());
            for i in 0..nx {
                assert_eq!(padded.get([i + 1, 2, 3]), volume.get([i, 1, 2]));
            }
        }
    }

    #[test]
    fn a_wrong_length_is_refused() {
        let grid = Grid::new([2, 2, 2], [1.0; 3]).unwrap();
        assert!(matches!(
            Occupancy::from_slice(grid, &[0u8; 7], |v| v > 0),
            Err(Error::Length { values: 7, points: 8, .. })
        ));
    }
}
