//! How far the inside points of a slice reach into other slices.

use crate::grid::Grid;
use crate::volume::Occupancy;
use crate::volume::runs::runs;

/// A squared distance counts as reached when it is no more than this part larger.
const TOLERANCE: f64 = 1e-6;
/// Columns along y that are worked on at a time: a cache line of each row.
const COLUMNS: usize = 16;

/// A ball among lattice points whose axes are at right angles.
pub(super) struct Ball {
    spacing: [f64; 3],
    /// The square of the radius, with its tolerance.
    square: f64,
    steps: [usize; 3],
}

/// A point of a column along y with the point of its row that is nearest to the column.
struct Site {
    row: usize,
    /// Squared distance along x to that point.
    height: f64,
    /// Where along y this site becomes nearer than the one before.
    from: f64,
}

impl Ball {
    pub(super) fn new(grid: &Grid, radius: f64) -> Self {
        let square = radius * radius * (1.0 + TOLERANCE);
        let spacing = grid.spacing();
        // Casts saturate.
        let steps = spacing.map(|step| (square.sqrt() / step) as usize);
        Self { spacing, square, steps }
    }

    /// The same ball where no two points are farther apart than in a lattice of these dimensions.
    pub(super) fn within(self, dims: [usize; 3]) -> Self {
        Self { steps: std::array::from_fn(|d| self.steps[d].min(dims[d] - 1)), ..self }
    }

    /// How many lattice points it reaches along x, y, z from its centre.
    pub(super) fn steps(&self) -> [usize; 3] {
        self.steps
    }

    /// Fills `slice`, x fastest, with one more than the largest number of slices to the next lattice
    /// column that balls around the inside points of slice `k` reach up and down at each of its points,
    /// or 0 where they do not even reach the point itself.
    pub(super) fn reach_of_slice(&self, volume: &Occupancy, k: usize, slice: &mut [u32]) {
        let [nx, ny, _] = volume.grid().dims();
        let rows = || (0..ny).map(|j| volume.row(j, k));
        if rows().flatten().all(|bits| *bits == 0) {
            slice.fill(0);
            return;
        }
        for (row, words) in slice.chunks_exact_mut(nx).zip(rows()) {
            self.steps_to_nearest(words, row);
        }
        let step = |n: usize| (n as f64 * self.spacing[0]).powi(2);
        let heights: Vec<f64> = (0..=self.steps[0]).map(step).collect();
        let (mut columns, mut sites) = (vec![0; ny * COLUMNS], Vec::new());
        for first in (0..nx).step_by(COLUMNS) {
            let width = COLUMNS.min(nx - first);
            for (j, row) in slice.chunks_exact(nx).enumerate() {
                for (c, steps) in row[first..first + width].iter().enumerate() {
                    columns[c * ny + j] = *steps;
                }
            }
            for column in columns.chunks_exact_mut(ny).take(width) {
                self.reach_of_column(column, &heights, &mut sites);
            }
            for (j, row) in slice.chunks_exact_mut(nx).enumerate() {
                for (c, reach) in row[first..first + width].iter_mut().enumerate() {
                    *reach = columns[c * ny + j];
                }
            }
        }
    }

    /// Fills `steps` with the number of steps along x to the nearest set bit, one more than the ball
    /// reaches where they would be more.
    fn steps_to_nearest(&self, words: &[u64], steps: &mut [u32]) {
        let beyond = self.steps[0] as u32 + 1;
        let mut end = None;
        for run in runs(words) {
            fill_gap(&mut steps[end.unwrap_or(0)..run.start], end.is_some(), true, beyond);
            steps[run.clone()].fill(0);
            end = Some(run.end);
        }
        fill_gap(&mut steps[end.unwrap_or(0)..], end.is_some(), false, beyond);
    }

    /// Turns the steps along x of one column along y into its reach along z.
    fn reach_of_column(&self, column: &mut [u32], heights: &[f64], sites: &mut Vec<Site>) {
        self.find_sites(column, heights, sites);
        let (full, [_, y, z]) = (self.steps[2] as u32 + 1, self.spacing);
        let Some(mut site) = sites.first() else {
            column.fill(0);
            return;
        };
        let mut later = sites[1..].iter().peekable();
        for (j, reach) in column.iter_mut().enumerate() {
            while let Some(next) = later.next_if(|next| next.from < j as f64) {
                site = next;
            }
            if *reach == 0 {
                *reach = full;
                continue;
            }
            let left = self.square - site.height - (j.abs_diff(site.row) as f64 * y).powi(2);
            // Casts saturate.
            *reach =
                if left < 0.0 { 0 } else { full.min(((left.sqrt() / z) as u32).saturating_add(1)) };
        }
    }

    /// The sites of a column that are nearest somewhere, the lower envelope of the parabolas over y that
    /// are their squared distances.
    fn find_sites(&self, column: &[u32], heights: &[f64], sites: &mut Vec<Site>) {
        sites.clear();
        let scale = 0.5 / (self.spacing[1] * self.spacing[1]);
        let is_inside = |j: usize| column.get(j).is_none_or(|steps| *steps == 0);
        for (row, &steps) in column.iter().enumerate() {
            let Some(&height) = heights.get(steps as usize) else { continue };
            // Between inside points only the column itself is nearest to one, and needs no site.
            if steps == 0 && is_inside(row + 1) && is_inside(row.wrapping_sub(1)) && row > 0 {
                continue;
            }
            let mut from = f64::NEG_INFINITY;
            while let Some(last) = sites.last() {
                let between = (last.row + row) as f64 / 2.0;
                from = between + (height - last.height) * scale / (row - last.row) as f64;
                if from > last.from {
                    break;
                }
                sites.pop();
                from = f64::NEG_INFINITY;
            }
            sites.push(Site { row, height, from });
        }
    }
}

/// Counts the steps to the nearer end of a gap, as far as it has ends, up to `beyond`.
fn fill_gap(gap: &mut [u32], has_start: bool, has_end: bool, beyond: u32) {
    let length = gap.len() as u32;
    for (steps, i) in gap.iter_mut().zip(0..) {
        let left = if has_start { i + 1 } else { beyond };
        let right = if has_end { length - i } else { beyond };
        *steps = left.min(right).min(beyond);
    }
}
