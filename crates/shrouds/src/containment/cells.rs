//! The cells of lattice points: boxes as large as the spacing, around each of them.

use crate::volume::Occupancy;

/// A volume with all the lattice points next to its own: along the axes, along the diagonals of faces, and
/// along those of boxes.
///
/// Two cells are nearer to each other than a distance, or as near, just when a neighbour of one lattice point,
/// or the point itself, is as near to the other: neighbours take away a spacing along each axis.
pub(super) fn with_neighbours(volume: &Occupancy) -> Occupancy {
    let [nx, ny, nz] = volume.grid().dims();
    Occupancy::from_rows(volume.grid().clone(), |j, k, words| {
        for k in k.saturating_sub(1)..(k + 2).min(nz) {
            for j in j.saturating_sub(1)..(j + 2).min(ny) {
                words.iter_mut().zip(volume.row(j, k)).for_each(|(word, bits)| *word |= bits);
            }
        }
        let mut before = 0;
        for w in 0..words.len() {
            let (bits, after) = (words[w], words.get(w + 1).copied().unwrap_or(0));
            words[w] = bits | bits << 1 | before >> 63 | bits >> 1 | after << 63;
            before = bits;
        }
        if let (Some(last), 1..) = (words.last_mut(), nx % 64) {
            *last &= (1 << (nx % 64)) - 1;
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::volume::phantom::noise;

    #[test]
    fn neighbours_are_those_one_step_away() {
        for nx in [1, 63, 64, 65, 130] {
            let grid = Grid::new([nx, 4, 5], [1.0; 3]).unwrap();
            let volume = noise(&grid, 0.03, 7).unwrap();
            let near = |a: usize, b: usize| a.abs_diff(b) <= 1;
            let points = |n: usize| [n % nx, n / nx % 4, n / nx / 4];
            let expected = Occupancy::from_fn(grid.clone(), |[i, j, k]| {
                (0..grid.point_count()).map(points).any(|[a, b, c]| {
                    near(a, i) && near(b, j) && near(c, k) && volume.get([a, b, c])
                })
            });
            assert_eq!(with_neighbours(&volume), expected, "{nx}");
        }
    }
}
