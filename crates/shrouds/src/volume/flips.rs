//! Lattice points that change their side.

use std::ops::Range;

use crate::volume::Occupancy;
use crate::volume::window::copy_bits;

/// Lattice points that change their side, in the smallest box that holds them.
pub(crate) struct Flips {
    /// Their indices along x, y, z.
    pub(crate) points: [Range<usize>; 3],
    /// Which of the points in the box they are.
    bits: Occupancy,
}

impl Flips {
    /// The same on a lattice that begins at point `first` of this one.
    pub(crate) fn seen_from(&self, first: [usize; 3]) -> Self {
        let points =
            [0, 1, 2].map(|d| self.points[d].start - first[d]..self.points[d].end - first[d]);
        Self { points, bits: self.bits.clone() }
    }
}

impl Occupancy {
    /// What makes the points of this volume in `ranges` those of `other`, the first point of which is the
    /// point `[margin; 3]` here; nothing where they are the same.
    pub(crate) fn flips_to(
        &self,
        ranges: &[Range<usize>; 3],
        other: &Self,
        margin: usize,
    ) -> Option<Flips> {
        let mut bits = self.cut_out(ranges);
        let theirs = other.cut_out(&ranges.clone().map(|r| r.start - margin..r.end - margin));
        let [_, rows, slices] = ranges.each_ref().map(|range| range.len());
        for (j, k) in (0..slices).flat_map(|k| (0..rows).map(move |j| (j, k))) {
            let pairs = bits.row_mut(j, k).iter_mut().zip(theirs.row(j, k));
            pairs.for_each(|(bits, theirs)| *bits ^= theirs);
        }
        let inner = bits.bounding_box()?;
        let points =
            [0, 1, 2].map(|d| ranges[d].start + inner[d].start..ranges[d].start + inner[d].end);
        Some(Flips { points, bits: bits.cut_out(&inner) })
    }

    /// Flips some points; a second time brings them back.
    pub(crate) fn flip(&mut self, flips: &Flips) {
        let [x, y, z] = &flips.points;
        let mut moved = vec![0; self.words().1];
        for (j, k) in z.clone().flat_map(|k| y.clone().map(move |j| (j, k))) {
            let row = flips.bits.row(j - y.start, k - z.start);
            copy_bits(row, -(x.start as isize), &mut moved);
            self.row_mut(j, k).iter_mut().zip(&moved).for_each(|(word, moved)| *word ^= moved);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;

    #[test]
    fn flips_make_the_other_volume_within_the_ranges() {
        for nx in [9, 64, 130] {
            let grid = Grid::new([nx, 5, 6], [1.0; 3]).unwrap();
            let before = Occupancy::from_fn(grid.clone(), |[i, j, k]| (i + j * k) % 3 == 0);
            let after = Occupancy::from_fn(grid, |[i, j, k]| (i * j + k) % 5 == 0);
            let mut padded = before.padded(1).unwrap();
            let (ranges, original) = ([3..nx - 1, 2..5, 1..4], padded.clone());
            let flips = padded.flips_to(&ranges, &after, 1).unwrap();
            padded.flip(&flips);
            assert!((0..3).all(|d| flips.points[d].start >= ranges[d].start));
            assert!((0..3).all(|d| flips.points[d].end <= ranges[d].end));
            for n in 0..padded.grid().point_count() {
                let point = [n % (nx + 2), n / (nx + 2) % 7, n / (nx + 2) / 7];
                let is_new = (0..3).all(|d| ranges[d].contains(&point[d]));
                let expected =
                    if is_new { after.get(point.map(|x| x - 1)) } else { original.get(point) };
                assert_eq!(padded.get(point), expected, "{point:?}");
            }
            assert!(padded.flips_to(&ranges, &after, 1).is_none());
            padded.flip(&flips);
            assert_eq!(padded, original);
        }
    }
}
