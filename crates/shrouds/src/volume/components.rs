//! Connected components of lattice points, joined run by run.

use std::ops::Range;

use crate::grid::Grid;
use crate::volume::runs::{runs, set_run};
use crate::volume::{FaceRule, Occupancy};

/// The connected components of the inside points of a volume, numbered in the order of their first
/// points (x fastest, then y, then z).
#[derive(Debug, Clone, PartialEq)]
pub struct Components {
    grid: Grid,
    /// Stretches of points along x, row after row.
    runs: Vec<Range<u32>>,
    /// Those of row `r` are `rows[r]..rows[r + 1]`.
    rows: Vec<usize>,
    /// The component of each.
    of_run: Vec<usize>,
    sizes: Vec<u64>,
}

impl Occupancy {
    /// The connected components of the inside points: what hangs together in the surface made by the
    /// same rule. [`FaceRule::Separate`] connects along grid edges (6-connected), [`FaceRule::Join`] also
    /// across lattice faces (18-connected).
    ///
    /// Time and memory (24 bytes) are for stretches of inside points along x, not for points.
    pub fn components(&self, rule: FaceRule) -> Components {
        Components::find(self, rule == FaceRule::Join)
    }
}

impl Components {
    /// Number of components.
    pub fn count(&self) -> usize {
        self.sizes.len()
    }

    /// Number of lattice points of each.
    pub fn sizes(&self) -> &[u64] {
        &self.sizes
    }

    /// The volume of the components that `chosen` chooses by their numbers.
    pub fn select(&self, chosen: impl Fn(usize) -> bool + Sync) -> Occupancy {
        let [_, ny, _] = self.grid.dims();
        Occupancy::from_rows(self.grid.clone(), |j, k, words| {
            for (component, run) in self.row(k * ny + j) {
                if chosen(component) {
                    set_run(words, run.start as usize..run.end as usize);
                }
            }
        })
    }

    /// The runs of row `r`, each with its component.
    fn row(&self, r: usize) -> impl Iterator<Item = (usize, &Range<u32>)> {
        let own = self.rows[r]..self.rows[r + 1];
        self.of_run[own.clone()].iter().copied().zip(&self.runs[own])
    }

    /// Whether each component has a point at the border of the lattice.
    pub(super) fn reach_border(&self) -> Vec<bool> {
        let [nx, ny, nz] = self.grid.dims();
        let mut reached = vec![false; self.count()];
        for (j, k) in (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))) {
            let outermost = j == 0 || j + 1 == ny || k == 0 || k + 1 == nz;
            for (component, run) in self.row(k * ny + j) {
                reached[component] |= outermost || run.start == 0 || run.end as usize == nx;
            }
        }
        reached
    }

    /// The components of the inside points, connected along grid edges and, if `diagonal`, across lattice
    /// faces.
    pub(super) fn find(volume: &Occupancy, diagonal: bool) -> Self {
        let [_, ny, nz] = volume.grid().dims();
        let mut joined = Joined::default();
        let reach = u32::from(diagonal);
        for (j, k) in (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))) {
            joined.add_row(volume.row(j, k));
            let row = k * ny + j;
            if j > 0 {
                joined.join_rows(row - 1, row, reach);
            }
            if k > 0 {
                joined.join_rows(row - ny, row, reach);
            }
            if diagonal && k > 0 && j > 0 {
                joined.join_rows(row - ny - 1, row, 0);
            }
            if diagonal && k > 0 && j + 1 < ny {
                joined.join_rows(row - ny + 1, row, 0);
            }
        }
        joined.number(volume.grid().clone())
    }
}

/// Runs with the sets they are joined to: every run names one before it, or itself when it is the first
/// of its set.
struct Joined {
    runs: Vec<Range<u32>>,
    rows: Vec<usize>,
    parents: Vec<usize>,
}

impl Default for Joined {
    fn default() -> Self {
        Self { runs: Vec::new(), rows: vec![0], parents: Vec::new() }
    }
}

impl Joined {
    fn add_row(&mut self, words: &[u64]) {
        self.runs.extend(runs(words).map(|run| run.start as u32..run.end as u32));
        self.parents.extend(self.parents.len()..self.runs.len());
        self.rows.push(self.runs.len());
    }

    /// Joins the runs of two rows that overlap when those of one are `reach` longer at both ends.
    fn join_rows(&mut self, a: usize, b: usize, reach: u32) {
        let (mut a, end_a) = (self.rows[a], self.rows[a + 1]);
        let (mut b, end_b) = (self.rows[b], self.rows[b + 1]);
        while a < end_a && b < end_b {
            let (run_a, run_b) = (&self.runs[a], &self.runs[b]);
            let (touch, a_ends) = (
                run_a.start < run_b.end + reach && run_b.start < run_a.end + reach,
                run_a.end <= run_b.end,
            );
            if touch {
                self.join(a, b);
            }
            if a_ends {
                a += 1;
            } else {
                b += 1;
            }
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.parents[a.max(b)] = a.min(b);
    }

    /// The first of the set of a run; shortens the way for the next time.
    fn first(&mut self, mut run: usize) -> usize {
        while self.parents[run] != run {
            self.parents[run] = self.parents[self.parents[run]];
            run = self.parents[run];
        }
        run
    }

    fn number(self, grid: Grid) -> Components {
        let Self { runs, rows, parents: mut of_run } = self;
        let mut sizes = Vec::new();
        for (r, run) in runs.iter().enumerate() {
            // The one before has its number by now.
            of_run[r] = if of_run[r] == r {
                sizes.push(0);
                sizes.len() - 1
            } else {
                of_run[of_run[r]]
            };
            sizes[of_run[r]] += u64::from(run.end - run.start);
        }
        Components { grid, runs, rows, of_run, sizes }
    }
}
