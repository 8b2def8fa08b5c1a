//! Volumes from stretches of depth in every lattice column.

use std::ops::Range;

use crate::containment::step::Membership;
use crate::grid::Grid;
use crate::parallel;
use crate::vector::subtract;
use crate::volume::Occupancy;

/// A depth of a lattice point counts as within a stretch this part of a spacing beyond its ends.
const ROUNDING: f64 = 1e-9;
/// Rows of columns that a thread takes at a time.
const ROWS: usize = 4;

/// Stretches of depth, in any order.
#[derive(Debug, Default, Clone)]
pub(super) struct Stretches {
    list: Vec<[f64; 2]>,
}

/// A vertical column of lattice points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    /// Smallest and largest x and y of what counts: the column alone, or its cells.
    pub(super) area: [[f64; 2]; 2],
}

impl Column {
    /// The least and the greatest squared horizontal distance from a place.
    pub(super) fn squares(&self, place: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.area.map(|corner| subtract(corner, place));
        let square = |d: usize| {
            let ends = [low[d] * low[d], high[d] * high[d]];
            let passes = low[d] < 0.0 && high[d] > 0.0;
            [if passes { 0.0 } else { ends[0].min(ends[1]) }, ends[0].max(ends[1])]
        };
        let [x, y] = [square(0), square(1)];
        [x[0] + y[0], x[1] + y[1]]
    }
}

/// The columns of a part of a lattice.
pub(super) struct Columns<'a> {
    grid: &'a Grid,
    /// Indices along x, y.
    part: [Range<usize>; 2],
    membership: Membership,
}

impl Stretches {
    /// One more stretch, if it has its ends in order.
    pub(super) fn add(&mut self, stretch: [f64; 2]) {
        if stretch[0] <= stretch[1] {
            self.list.push(stretch);
        }
    }

    pub(super) fn extend(&mut self, stretches: &[[f64; 2]]) {
        self.list.extend_from_slice(stretches);
    }

    pub(super) fn clear(&mut self) {
        self.list.clear();
    }

    /// The stretches in order, those that meet made one.
    pub(super) fn merged(&mut self) -> &[[f64; 2]] {
        self.list.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        self.list.dedup_by(|next, last| {
            let meet = next[0] <= last[1];
            if meet {
                last[1] = last[1].max(next[1]);
            }
            meet
        });
        &self.list
    }
}

impl<'a> Columns<'a> {
    pub(super) fn all(grid: &'a Grid, membership: Membership) -> Self {
        let [nx, ny, _] = grid.dims();
        Self { grid, part: [0..nx, 0..ny], membership }
    }

    /// The columns with these indices.
    pub(super) fn of(grid: &'a Grid, part: [Range<usize>; 2], membership: Membership) -> Self {
        Self { grid, part, membership }
    }

    /// The volume of the lattice points whose depths are in the stretches that `find` adds for their column;
    /// or whose cells reach into them.
    pub(super) fn volume(&self, find: impl Fn(&Column, &mut Stretches) + Sync) -> Occupancy {
        let [nx, _, nz] = self.grid.dims();
        let words = nx.div_ceil(64);
        let [xs, ys] = &self.part;
        // A plane across y at a time, slice after slice: small enough for the first cache.
        let planes: Vec<Vec<u64>> = parallel::blocks(ys.len(), ROWS, |block| {
            let mut found = Stretches::default();
            let plane = |n: usize| {
                let mut plane = vec![0; words * nz];
                for i in xs.clone() {
                    found.clear();
                    find(&self.column(i, ys.start + n), &mut found);
                    self.mark(&mut found, i, &mut plane);
                }
                // Until here bits are those of slices in which a stretch begins or has ended.
                for k in 1..nz {
                    let (below, slice) = plane.split_at_mut(k * words);
                    let below = &below[(k - 1) * words..];
                    slice.iter_mut().zip(below).for_each(|(bits, below)| *bits ^= below);
                }
                plane
            };
            block.map(plane).collect::<Vec<_>>()
        })
        .into_iter()
        .flatten()
        .collect();
        Occupancy::from_rows(self.grid.clone(), |j, k, row| {
            if ys.contains(&j) {
                row.copy_from_slice(&planes[j - ys.start][k * words..(k + 1) * words]);
            }
        })
    }

    /// Smallest and largest x and y of all that counts.
    pub(super) fn area(&self) -> [[f64; 2]; 2] {
        let [xs, ys] = &self.part;
        let [first, last] = [
            self.column(xs.start, ys.start),
            self.column(xs.end.saturating_sub(1), ys.end.saturating_sub(1)),
        ];
        [first.area[0], last.area[1]]
    }

    fn column(&self, i: usize, j: usize) -> Column {
        let [x, y, _] = self.grid.point([i as f64, j as f64, 0.0]);
        let [reach_x, reach_y, _] = self.reach();
        Column { area: [[x - reach_x, y - reach_y], [x + reach_x, y + reach_y]] }
    }

    /// How far from a lattice point along x, y, z something still counts.
    fn reach(&self) -> [f64; 3] {
        match self.membership {
            Membership::Centre => [0.0; 3],
            Membership::Cell => self.grid.spacing().map(|step| step / 2.0),
        }
    }

    /// Changes the bit of column `i` in the slices where stretches begin and after they end.
    fn mark(&self, found: &mut Stretches, i: usize, plane: &mut [u64]) {
        let [nx, _, nz] = self.grid.dims();
        let words = nx.div_ceil(64);
        let step = self.grid.spacing()[2];
        let bottom = -self.grid.point([0.0; 3])[2];
        let beyond = self.reach()[2] + ROUNDING * step;
        for stretch in &mut found.list {
            *stretch = [stretch[0] - beyond, stretch[1] + beyond];
        }
        // Casts saturate at the lattice's first slice.
        let slice = |depth: f64| ((bottom - depth) / step).max(-1.0);
        let mut done = nz;
        for [least, most] in found.merged() {
            let first = (slice(*most).ceil() as usize).min(done);
            let end = ((slice(*least).floor() + 1.0) as usize).min(done);
            if first < end {
                for k in [first, end] {
                    if k < nz {
                        plane[k * words + i / 64] ^= 1 << (i % 64);
                    }
                }
            }
            // Deeper stretches come later and end below this one.
            done = done.min(first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_those_within_the_stretches() {
        let affine = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.7, -6.3]];
        let grid = Grid::with_affine([70, 2, 11], affine).unwrap();
        let of = |column: &Column| {
            let x = (column.area[0][0] + column.area[1][0]) / 2.0;
            [
                [x / 10.0, x / 10.0 + 1.0],
                [4.1, 4.6],
                [4.5, 5.0 - x / 30.0],
                [6.2, 90.0],
                [-5.0, -0.4],
            ]
        };
        for (membership, reach) in [(Membership::Centre, 0.0), (Membership::Cell, 0.35)] {
            let volume = Columns::all(&grid, membership).volume(|column, found| {
                of(column).into_iter().for_each(|stretch| found.add(stretch));
            });
            for n in 0..grid.point_count() {
                let [i, j, k] = [n % 70, n / 70 % 2, n / 140];
                let depth = 6.3 - 0.7 * k as f64;
                let column = Columns::all(&grid, membership).column(i, j);
                let inside = of(&column).iter().any(|[least, most]| {
                    least <= most && depth >= least - reach - 1e-9 && depth <= most + reach + 1e-9
                });
                assert_eq!(volume.get([i, j, k]), inside, "{i} {k} {depth}");
            }
        }
    }
}
