//! The same points in a smaller or a larger lattice.

use std::ops::Range;

use crate::error::Error;
use crate::volume::Occupancy;
use crate::volume::combine::clear_past;

impl Occupancy {
    /// The lattice points whose indices along x, y, z lie in `ranges`, in their places in the world.
    ///
    /// # Errors
    /// [`Error::NoSuchPoints`] when a range is empty or leaves the lattice.
    pub fn crop(&self, ranges: [Range<usize>; 3]) -> Result<Self, Error> {
        let grid = self.grid().crop(ranges.clone())?;
        let first = ranges.map(|range| range.start as isize);
        Ok(self.window(first, Self::empty(grid)))
    }

    /// The lattice points in ranges within the lattice, in their places in the world.
    pub(crate) fn cut_out(&self, ranges: [Range<usize>; 3]) -> Self {
        let first = ranges.each_ref().map(|range| range.start as isize);
        let grid = self.grid().window(first, ranges.map(|range| range.len()));
        self.window(first, Self::empty(grid))
    }

    /// Puts every lattice point inside that is inside `part`, whose first point is point `first` here;
    /// those of it that lie beyond this volume are left out.
    pub(crate) fn paste(&mut self, first: [isize; 3], part: &Self) {
        let ([_, ny, nz], [nx, own_ny, own_nz]) = (part.grid().dims(), self.grid().dims());
        let within = |count: usize, first: isize, own: usize| {
            let place =
                move |n: usize| usize::try_from(n as isize + first).ok().filter(|&n| n < own);
            (0..count).filter_map(move |n| place(n).map(|there| (n, there)))
        };
        let mut words = vec![0; nx.div_ceil(64)];
        for (k, own_k) in within(nz, first[2], own_nz) {
            for (j, own_j) in within(ny, first[1], own_ny) {
                copy_bits(part.row(j, k), -first[0], &mut words);
                clear_past(&mut words, nx);
                self.row_mut(own_j, own_k).iter_mut().zip(&words).for_each(|(a, b)| *a |= b);
            }
        }
    }

    /// The same volume with `margin` layers of outside points around it.
    ///
    /// # Errors
    /// As for [`Occupancy::padded_by`].
    pub fn padded(&self, margin: usize) -> Result<Self, Error> {
        self.padded_by([[margin; 2]; 3])
    }

    /// The same volume with layers of outside points beyond the first and the last ones along x, y, z.
    /// Points keep their places in the world.
    ///
    /// # Errors
    /// [`Error::Dimensions`] when the padded grid is too large, [`Error::Memory`] when it does not fit
    /// into memory.
    pub fn padded_by(&self, margins: [[usize; 2]; 3]) -> Result<Self, Error> {
        let empty = Self::try_empty(self.grid().padded_by(margins)?)?;
        Ok(self.window(margins.map(|[before, _]| -(before as isize)), empty))
    }

    /// The smallest ranges of indices along x, y, z that hold all inside points, if there are any.
    pub fn bounding_box(&self) -> Option<[Range<usize>; 3]> {
        let [_, ny, nz] = self.grid().dims();
        let mut columns = vec![0; self.words().1];
        let (mut first, mut end) = ([usize::MAX; 2], [0; 2]);
        for (j, k) in (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))) {
            let row = self.row(j, k);
            if row.iter().any(|bits| *bits != 0) {
                columns.iter_mut().zip(row).for_each(|(columns, bits)| *columns |= bits);
                first = [first[0].min(j), first[1].min(k)];
                end = [end[0].max(j + 1), k + 1];
            }
        }
        let low = columns.iter().position(|bits| *bits != 0)?;
        let high = columns.iter().rposition(|bits| *bits != 0)?;
        let left = 64 * low + columns[low].trailing_zeros() as usize;
        let right = 64 * (high + 1) - columns[high].leading_zeros() as usize;
        Some([left..right, first[0]..end[0], first[1]..end[1]])
    }

    /// Puts into `empty` the points of this volume from index `first` on; those beyond this volume are
    /// outside.
    pub(super) fn window(&self, first: [isize; 3], mut empty: Self) -> Self {
        let [_, ny, nz] = self.grid().dims();
        let [nx, _, _] = empty.grid().dims();
        let slices = 0..empty.grid().dims()[2];
        empty.fill_slices(slices, |j, k, words| {
            let (j, k) = (j.wrapping_add_signed(first[1]), k.wrapping_add_signed(first[2]));
            // What stays empty is not written, so that memory which is zero by nature stays untouched.
            if j < ny && k < nz && self.row(j, k).iter().any(|bits| *bits != 0) {
                copy_bits(self.row(j, k), first[0], words);
                clear_past(words, nx);
            }
        });
        empty
    }
}

/// Bit `b` of `to` becomes bit `first + b` of `from`, 0 where there is none.
fn copy_bits(from: &[u64], first: isize, to: &mut [u64]) {
    let shift = first.rem_euclid(64);
    let start = first.div_euclid(64);
    let word = |w: usize| from.get(w.wrapping_add_signed(start)).copied().unwrap_or(0);
    let mut low = word(0);
    for (w, bits) in to.iter_mut().enumerate() {
        let high = word(w + 1);
        // In two steps, because a shift of 0 would have to be one by 64 to the left.
        *bits = low >> shift | high << 1 << (63 - shift);
        low = high;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;

    fn pattern([i, j, k]: [usize; 3]) -> bool {
        (i * 7 + j * 5 + k * 3) % 4 == 0
    }

    #[test]
    fn padding_and_cropping_move_every_bit() {
        for nx in [1, 62, 63, 64, 65, 127, 130] {
            let volume = Occupancy::from_fn(Grid::new([nx, 2, 3], [1.0; 3]).unwrap(), pattern);
            for [before, after] in [[1, 1], [0, 64], [63, 0], [64, 3], [130, 70]] {
                let padded = volume.padded_by([[before, after], [1, 0], [2, 5]]).unwrap();
                assert_eq!(padded.grid().dims(), [nx + before + after, 3, 10]);
                assert_eq!(padded.count(), volume.count());
                assert!((0..nx).all(|i| padded.get([before + i, 2, 4]) == pattern([i, 1, 2])));
                let back = padded.crop([before..before + nx, 1..3, 2..5]).unwrap();
                assert_eq!(back, volume);
            }
            for range in [0..1, nx / 3..nx, 0..nx.div_ceil(2)] {
                let part = volume.crop([range.clone(), 1..2, 0..3]).unwrap();
                let expected = Occupancy::from_fn(part.grid().clone(), |[i, j, k]| {
                    pattern([i + range.start, j + 1, k])
                });
                assert_eq!(part, expected);
            }
        }
    }

    #[test]
    fn a_box_holds_what_is_inside() {
        for n in [1, 63, 64, 65, 200] {
            let grid = Grid::new([n + 3, 5, 6], [1.0; 3]).unwrap();
            let mut volume = Occupancy::empty(grid);
            assert_eq!(volume.bounding_box(), None);
            volume.set([n, 3, 2], true);
            assert_eq!(volume.bounding_box(), Some([n..n + 1, 3..4, 2..3]));
            volume.set([n / 2, 1, 5], true);
            assert_eq!(volume.bounding_box(), Some([n / 2..n + 1, 1..4, 2..6]));
        }
    }

    #[test]
    fn a_volume_beyond_all_memory_is_refused() {
        let volume = Occupancy::empty(Grid::new([2; 3], [1.0; 3]).unwrap());
        let error = volume.padded(500_000).unwrap_err();
        assert!(matches!(error, Error::Memory { dims: [1_000_002, ..], .. }), "{error}");
    }
}
