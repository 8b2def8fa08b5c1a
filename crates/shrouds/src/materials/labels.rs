//! A volume of labels, with a frame of background around it.

use std::collections::BTreeSet;

use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// A label for every lattice point. Label 0 is the background, also of everything beyond the volume.
///
/// Labels are kept as *ranks*: 0 for the background, the others from 1 on in ascending order.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// That of the volume.
    inner: Grid,
    /// The same with one more layer on all sides.
    grid: Grid,
    /// The label of every rank.
    values: Vec<i64>,
    ranks: Vec<u32>,
}

impl Labels {
    /// The labels of the lattice points of a grid, x fastest.
    ///
    /// # Errors
    /// [`Error::Length`] when there is not one value for each lattice point; [`Error::Dimensions`]
    /// when there is no room for a layer more on all sides.
    pub fn new<T: Copy + Into<i64>>(grid: &Grid, values: &[T]) -> Result<Self, Error> {
        grid.check_length(values.len())?;
        let padded = grid.padded(1)?;
        let known = distinct(values);
        let mut ranks = vec![0; padded.point_count()];
        let ([nx, ny, _], [px, py, _]) = (grid.dims(), padded.dims());
        let rank = |value: i64| known.binary_search(&value).map_or(0, |found| found as u32 + 1);
        let mut last = (0, 0);
        for (row, values) in values.chunks_exact(nx).enumerate() {
            let (j, k) = (row % ny, row / ny);
            let start = ((k + 1) * py + j + 1) * px + 1;
            for (slot, &value) in ranks[start..start + nx].iter_mut().zip(values) {
                let value = value.into();
                if value != last.0 {
                    last = (value, rank(value));
                }
                *slot = last.1;
            }
        }
        let values = std::iter::once(0).chain(known).collect();
        Ok(Self { inner: grid.clone(), grid: padded, values, ranks })
    }

    /// The labels by rank: the background, then the others that occur, ascending.
    pub fn values(&self) -> &[i64] {
        &self.values
    }

    /// The lattice with a layer of background on all sides.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The lattice points of a label, on the grid of the volume.
    ///
    /// # Errors
    /// None for labels that are on a grid already.
    pub fn occupancy(&self, rank: u32) -> Result<Occupancy, Error> {
        let ([nx, ny, nz], strides) = (self.inner.dims(), self.strides());
        let rows =
            (1..=nz).flat_map(|k| (1..=ny).map(move |j| k * strides[2] + j * strides[1] + 1));
        let is_own =
            |start: usize| self.ranks[start..start + nx].iter().map(|&found| found == rank);
        let inside: Vec<bool> = rows.flat_map(is_own).collect();
        Occupancy::from_slice(self.inner.clone(), &inside, |inside| inside)
    }

    /// The lattice points of each label but the background, each in the smallest box around them.
    ///
    /// # Errors
    /// None for labels that are on a grid already.
    pub fn occupancies(&self) -> Result<Vec<Occupancy>, Error> {
        let [nx, ny, _] = self.grid.dims();
        let mut boxes = vec![[[usize::MAX, 0]; 3]; self.values.len()];
        for (row, ranks) in self.ranks.chunks_exact(nx).enumerate() {
            let mut at = 0;
            for same in ranks.chunk_by(|a, b| a == b) {
                let ends =
                    [[at, at + same.len()], [row % ny, row % ny + 1], [row / ny, row / ny + 1]];
                for (own, [low, high]) in boxes[same[0] as usize].iter_mut().zip(ends) {
                    *own = [own[0].min(low), own[1].max(high)];
                }
                at += same.len();
            }
        }
        let occupancy = |(rank, ranges): (usize, [[usize; 2]; 3])| {
            let grid = self.grid.crop(ranges.map(|[low, high]| low..high))?;
            let [x, y, z] = ranges;
            let rows = (z[0]..z[1]).flat_map(|k| (y[0]..y[1]).map(move |j| (k * ny + j) * nx));
            let own = rows.flat_map(|row| &self.ranks[row + x[0]..row + x[1]]);
            let inside: Vec<bool> = own.map(|&found| found as usize == rank).collect();
            Occupancy::from_slice(grid, &inside, |inside| inside)
        };
        boxes.into_iter().enumerate().skip(1).map(occupancy).collect()
    }

    /// The number of lattice points of every rank, those of the frame left out.
    pub fn counts(&self) -> Vec<u64> {
        let mut counts = vec![0; self.values.len()];
        for &rank in &self.ranks {
            counts[rank as usize] += 1;
        }
        let inside: usize = self.grid.dims().map(|n| n - 2).iter().product();
        counts[0] -= (self.ranks.len() - inside) as u64;
        counts
    }

    #[inline]
    pub(super) fn ranks(&self) -> &[u32] {
        &self.ranks
    }

    /// From a lattice point to the next one along each axis.
    #[inline]
    pub(super) fn strides(&self) -> [usize; 3] {
        let [nx, ny, _] = self.grid.dims();
        [1, nx, nx * ny]
    }
}

/// The labels other than 0, ascending.
fn distinct<T: Copy + Into<i64>>(values: &[T]) -> Vec<i64> {
    let (mut found, mut last) = (BTreeSet::new(), 0);
    for &value in values {
        let value = value.into();
        if value != last {
            found.insert(value);
            last = value;
        }
    }
    found.remove(&0);
    found.into_iter().collect()
}

/// Two ranks in the order of an interface: the background second, else ascending. The normals of the
/// interface point from the first to the second.
#[inline]
pub(super) fn pair(a: u32, b: u32) -> [u32; 2] {
    if a != 0 && (b == 0 || a < b) { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_follow_the_labels_and_the_frame_is_background() {
        let grid = Grid::new([3, 1, 2], [1.0; 3]).unwrap();
        let labels = Labels::new(&grid, &[7u16, 0, 300, 7, 7, 2]).unwrap();
        assert_eq!(labels.values(), [0, 2, 7, 300]);
        assert_eq!(labels.counts(), [1, 1, 3, 1]);
        assert_eq!(labels.grid().dims(), [5, 3, 4]);
        let at = |i: usize, j: usize, k: usize| labels.ranks()[(k * 3 + j) * 5 + i];
        assert_eq!(
            [at(1, 1, 1), at(2, 1, 1), at(3, 1, 1), at(3, 1, 2), at(0, 1, 1)],
            [2, 0, 3, 1, 0]
        );
        assert_eq!((pair(0, 2), pair(2, 0), pair(3, 1)), ([2, 0], [2, 0], [1, 3]));
    }
}
