//! Winding numbers along the lattice lines of a closed mesh.

use crate::check::crossing::{Change, crossings, step};
use crate::grid::Grid;
use crate::mesh::TriMesh;
use crate::volume::{Border, Occupancy};
use crate::voxelize::rule::Sides;

/// The changes of the winding number along the lattice lines in the direction of x.
pub(super) struct Lines {
    dims: [usize; 3],
    /// Sorted; each at the first lattice point behind its crossing.
    changes: Vec<Change>,
}

impl Lines {
    /// `body` is closed and in units of the index.
    pub(super) fn new(body: &TriMesh, grid: &Grid) -> Self {
        let dims = grid.dims();
        Self { dims, changes: crossings(body, 0, dims, Border::Closed) }
    }

    /// The changes along line `(j, k)`: the first lattice point with another winding number than the
    /// one before it, and by how much it differs.
    fn line(&self, j: usize, k: usize) -> impl Iterator<Item = (usize, i64)> {
        let [nx, ny, _] = self.dims;
        let first = ((k * ny + j) * nx) as u64;
        let from = self.changes.partition_point(|&change| change / 2 < first);
        let own = move |&&change: &&Change| change / 2 < first + nx as u64;
        let changes = self.changes[from..].iter().take_while(own);
        changes.map(move |&change| ((change / 2 - first) as usize, step(change)))
    }

    /// The volume of the points that are inside.
    pub(super) fn fill(&self, grid: &Grid, sides: Sides) -> Occupancy {
        let nx = self.dims[0];
        Occupancy::from_rows(grid.clone(), |j, k, words| {
            let (mut winding, mut from) = (0, 0);
            for (i, step) in self.line(j, k).chain([(nx, 0)]) {
                if sides.inside(winding) {
                    set_bits(words, from, i);
                }
                (winding, from) = (winding + step, i);
            }
        })
    }

    /// The winding number of a point.
    pub(super) fn winding(&self, [i, j, k]: [usize; 3]) -> i64 {
        self.line(j, k).take_while(|&(at, _)| at <= i).map(|(_, step)| step).sum()
    }
}

/// Sets the bits `from..to` of a row.
fn set_bits(words: &mut [u64], from: usize, to: usize) {
    let mut at = from;
    while at < to {
        let end = to.min((at / 64 + 1) * 64);
        words[at / 64] |= (u64::MAX >> (64 - (end - at))) << (at % 64);
        at = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_bits_of_any_place_and_length() {
        for from in 0..130 {
            for to in from..=192 {
                let mut words = [0; 3];
                set_bits(&mut words, from, to);
                let bit = |i: usize| words[i / 64] >> (i % 64) & 1 == 1;
                assert!((0..192).all(|i| bit(i) == (from..to).contains(&i)), "{from}..{to}");
            }
        }
    }
}
