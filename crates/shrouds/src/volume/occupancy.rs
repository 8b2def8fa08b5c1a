//! The set of inside lattice points, one bit each.

use std::ops::Range;

use crate::error::Error;
use crate::grid::Grid;
use crate::parallel;
use crate::volume::pack::pack_row;

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
        let [nx, _, _] = grid.dims();
        Self::from_rows(grid, |j, k, words| {
            for (word, first) in words.iter_mut().zip((0..nx).step_by(64)) {
                let bits = first..nx.min(first + 64);
                *word = bits.rev().fold(0, |bits, i| bits << 1 | u64::from(inside([i, j, k])));
            }
        })
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
        grid.check_length(values.len())?;
        let [nx, ny, _] = grid.dims();
        Ok(Self::from_rows(grid, |j, k, words| {
            let start = (k * ny + j) * nx;
            pack_row(&values[start..start + nx], words, |values, flags| {
                for (flag, &value) in flags.iter_mut().zip(values) {
                    *flag = inside(value);
                }
            });
        }))
    }

    /// The volume whose row `(j, k)` has the bits that `fill` puts into its words, which are 0.
    pub(crate) fn from_rows(grid: Grid, fill: impl Fn(usize, usize, &mut [u64]) + Sync) -> Self {
        let mut volume = Self::empty(grid);
        volume.fill_slices(0..volume.grid.dims()[2], fill);
        volume
    }

    /// Lets `fill` change the words of every row `(j, k)` of some slices. It has to leave bits past the
    /// end 0.
    pub(super) fn fill_slices(
        &mut self,
        slices: Range<usize>,
        fill: impl Fn(usize, usize, &mut [u64]) + Sync,
    ) {
        let [_, ny, _] = self.grid.dims();
        let words_per_row = self.words_per_row;
        let slice = ny * words_per_row;
        let words = &mut self.words[slices.start * slice..slices.end * slice];
        parallel::pieces(words, (1..=slices.len()).map(|k| k * slice), |k, words| {
            for (j, words) in words.chunks_exact_mut(words_per_row).enumerate() {
                fill(j, slices.start + k, words);
            }
        });
    }

    /// A volume with nothing inside, of a size that a caller may have got wrong.
    ///
    /// # Errors
    /// [`Error::Memory`] when it does not fit into memory.
    pub(super) fn try_empty(grid: Grid) -> Result<Self, Error> {
        Self::check_memory(&grid)?;
        Ok(Self::empty(grid))
    }

    /// Refuses a grid whose bits no memory can hold, before anything of their size is asked for.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub(crate) fn check_memory(grid: &Grid) -> Result<(), Error> {
        let dims = grid.dims();
        let words = dims[0].div_ceil(64) as u64 * dims[1] as u64 * dims[2] as u64;
        // Only asks: memory that is zero by nature cannot be had from what is reserved so.
        let asked = usize::try_from(words).map(|words| Vec::<u64>::new().try_reserve_exact(words));
        match asked {
            Ok(Ok(())) => Ok(()),
            _ => Err(Error::Memory { dims, bytes: words.saturating_mul(8) }),
        }
    }

    /// The volume with these words.
    pub(super) fn of_words(grid: Grid, words: Vec<u64>) -> Self {
        let words_per_row = grid.dims()[0].div_ceil(64);
        Self { grid, words_per_row, words }
    }

    /// The volume whose rows have these words, one row after another, each as [`Occupancy::row`] has
    /// it. Bits past the end of a row are cleared.
    ///
    /// # Errors
    /// [`Error::Length`], in words times 64, when the number of words does not fit the grid.
    pub fn from_words(grid: Grid, mut words: Vec<u64>) -> Result<Self, Error> {
        let [nx, ny, nz] = grid.dims();
        let words_per_row = nx.div_ceil(64);
        if words.len() != words_per_row * ny * nz {
            let (values, dims) = (64 * words.len(), grid.dims());
            return Err(Error::Length { values, dims, points: 64 * words_per_row * ny * nz });
        }
        if nx % 64 > 0 {
            let ends = words.iter_mut().skip(words_per_row - 1).step_by(words_per_row);
            ends.for_each(|word| *word &= (1 << (nx % 64)) - 1);
        }
        Ok(Self::of_words(grid, words))
    }

    /// The lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The same points on another lattice of the same dimensions.
    ///
    /// # Errors
    /// [`Error::Length`] when the dimensions differ.
    pub fn with_grid(self, grid: Grid) -> Result<Self, Error> {
        let (dims, points) = (grid.dims(), grid.point_count());
        if dims != self.grid.dims() {
            return Err(Error::Length { values: self.grid.point_count(), dims, points });
        }
        Ok(Self { grid, ..self })
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
    #[inline]
    pub fn row(&self, j: usize, k: usize) -> &[u64] {
        let [_, ny, nz] = self.grid.dims();
        assert!(j < ny && k < nz, "row ({j}, {k}) outside {:?}", self.grid.dims());
        let start = (k * ny + j) * self.words_per_row;
        &self.words[start..start + self.words_per_row]
    }

    /// The words of row `(j, k)`, to change; bits past the end have to stay 0.
    pub(super) fn row_mut(&mut self, j: usize, k: usize) -> &mut [u64] {
        let start = (k * self.grid.dims()[1] + j) * self.words_per_row;
        &mut self.words[start..start + self.words_per_row]
    }

    /// Puts every lattice point inside that is inside `other`.
    ///
    /// # Panics
    /// When the dimensions differ.
    pub fn unite(&mut self, other: &Self) {
        assert_eq!(self.grid.dims(), other.grid.dims(), "volumes of different dimensions");
        self.words.iter_mut().zip(&other.words).for_each(|(word, more)| *word |= more);
    }

    /// The words of all rows one after another, and how many make a row.
    pub(crate) fn words(&self) -> (&[u64], usize) {
        (&self.words, self.words_per_row)
    }

    /// The slice of lattice points with index `index` along `axis`, an image of one slice along z in
    /// its place in the world: its x is the axis after `axis` and its y the one after that, so that x
    /// and y stay what they are in a slice across z.
    ///
    /// # Errors
    /// [`Error::NoSlice`] when there is no such slice.
    ///
    /// # Panics
    /// When `axis` is not 0, 1 or 2.
    pub fn slice(&self, axis: usize, index: usize) -> Result<Self, Error> {
        let last = self.grid.dims()[axis] - 1;
        if index > last {
            return Err(Error::NoSlice { axis: ['x', 'y', 'z'][axis], index, last });
        }
        let at = |i, j| match axis {
            0 => [index, i, j],
            1 => [j, index, i],
            _ => [i, j, index],
        };
        Ok(Self::from_fn(self.grid.slice(axis, index), |[i, j, _]| self.get(at(i, j))))
    }

    /// Number of inside lattice points.
    pub fn count(&self) -> u64 {
        self.words.iter().map(|w| u64::from(w.count_ones())).sum()
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
    fn words_make_the_volume_they_came_from() {
        let grid = Grid::new([70, 3, 2], [1.0; 3]).unwrap();
        let volume = Occupancy::from_fn(grid.clone(), pattern);
        let mut words: Vec<u64> =
            (0..6).flat_map(|row| volume.row(row % 3, row / 3)).copied().collect();
        // Bits past the end of a row.
        words[3] |= 1 << 6 | 1 << 63;
        assert_eq!(Occupancy::from_words(grid.clone(), words.clone()).unwrap(), volume);
        words.pop();
        assert!(matches!(Occupancy::from_words(grid, words), Err(Error::Length { .. })));
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
