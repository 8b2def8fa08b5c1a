//! Lattices of half as many points, for what is looked at from afar.

use crate::error::Error;
use crate::volume::Occupancy;

impl Occupancy {
    /// The volume on [`Grid::halved`](crate::Grid::halved): a point is inside where at least two of the up to eight points
    /// around it are, that are its own.
    ///
    /// A quarter is enough, so that a rod of one voxel stays whole where a majority would lose it.
    /// Surfaces lie up to half a voxel of the new lattice further out.
    ///
    /// # Errors
    /// None for a volume on a grid of some points.
    pub fn halved(&self) -> Result<Self, Error> {
        let [_, ny, nz] = self.grid().dims();
        let row = |j: usize, k: usize| (j < ny && k < nz).then(|| self.row(j, k));
        Ok(Self::from_rows(self.grid().halved()?, |j, k, words| {
            let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
            let rows = corners.map(|[y, z]| row(2 * j + y, 2 * k + z));
            for (w, bits) in words.iter_mut().enumerate() {
                let half = |n: usize| {
                    let of_row = |row: Option<&[u64]>| row.and_then(|row| row.get(n).copied());
                    even_bits(two_of_eight(rows.map(|row| of_row(row).unwrap_or(0))))
                };
                *bits = half(2 * w) | half(2 * w + 1) << 32;
            }
        }))
    }
}

/// At the even bits, whether at least two are set of this bit and the next in all rows.
fn two_of_eight(rows: [u64; 4]) -> u64 {
    let (mut one, mut two) = (0, 0);
    for bits in rows.into_iter().flat_map(|row| [row, row >> 1]) {
        two |= one & bits;
        one |= bits;
    }
    two
}

/// The even bits of a word, one after another.
fn even_bits(word: u64) -> u64 {
    let mut bits = word & 0x5555_5555_5555_5555;
    bits = (bits | bits >> 1) & 0x3333_3333_3333_3333;
    bits = (bits | bits >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    bits = (bits | bits >> 4) & 0x00ff_00ff_00ff_00ff;
    bits = (bits | bits >> 8) & 0x0000_ffff_0000_ffff;
    (bits | bits >> 16) & 0x0000_0000_ffff_ffff
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::random::uniform;

    #[test]
    fn points_are_inside_where_two_of_their_own_are() {
        for dims in [[1, 1, 1], [7, 5, 3], [64, 2, 4], [131, 6, 5], [260, 3, 2]] {
            let grid = Grid::new(dims, [1.0, 2.0, 3.0]).unwrap();
            let [nx, ny, _] = dims;
            let values: Vec<bool> =
                (0..grid.point_count()).map(|n| uniform(3, n as u64) < 0.3).collect();
            let volume = Occupancy::from_slice(grid, &values, |inside| inside).unwrap();
            let halved = volume.halved().unwrap();
            let [mx, my, mz] = halved.grid().dims();
            assert_eq!([mx, my, mz], dims.map(|n| n.div_ceil(2)));
            for (i, j, k) in
                (0..mz).flat_map(|k| (0..my).flat_map(move |j| (0..mx).map(move |i| (i, j, k))))
            {
                let own = (0..8).map(|n| [2 * i + n % 2, 2 * j + n / 2 % 2, 2 * k + n / 4]);
                let own = own.filter(|index| (0..3).all(|d| index[d] < dims[d]));
                let count = own.filter(|[i, j, k]| values[(k * ny + j) * nx + i]).count();
                assert_eq!(halved.get([i, j, k]), count >= 2, "{dims:?} {i} {j} {k}");
            }
        }
    }

    #[test]
    fn a_point_lies_between_its_own() {
        let affine = [[0.0, -2.0, 0.0, 5.0], [1.0, 0.0, 0.5, 6.0], [0.0, 0.0, 3.0, 7.0]];
        let grid = Grid::with_affine([9, 8, 7], affine).unwrap();
        let between = grid.point([4.5, 2.5, 6.5]);
        assert_eq!(grid.halved().unwrap().point([2.0, 1.0, 3.0]), between);
    }
}
