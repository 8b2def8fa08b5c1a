//! How far a shape is from what its energy likes best: means of the energies of vertices.

use std::collections::BTreeMap;

/// Lattice points along the edge of a cell in which energies are gathered.
const EDGE: usize = 8;

/// Mean energies of vertices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MeanEnergy {
    /// That of all vertices.
    OfAll(f64),
    /// Those around every place.
    Around(Cells),
}

/// Cells of a lattice that hold the vertices of a surface. They begin where it begins, so that it does not matter where in
/// a volume it lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellGrid {
    /// The lowest lattice point.
    first: [usize; 3],
    /// Cells along x, y, z.
    counts: [usize; 3],
}

/// Energies of vertices by the cells in which their grid edges start, as sums.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Gathered(BTreeMap<[usize; 3], Sum>);

/// The sum of some energies, and their number.
type Sum = [f64; 2];

/// Mean energies around the cells.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cells {
    grid: CellGrid,
    /// Energy and number of the vertices in a cell and those next to it; x fastest.
    sums: Vec<[f32; 2]>,
    of_all: f64,
}

impl CellGrid {
    /// That of the vertices whose grid edges start at these lattice points.
    pub(crate) fn of(mut points: impl Iterator<Item = [usize; 3]>) -> Self {
        let first = points.next().unwrap_or_default();
        let mut ends = [first; 2];
        for point in points {
            for (axis, x) in point.into_iter().enumerate() {
                ends[0][axis] = ends[0][axis].min(x);
                ends[1][axis] = ends[1][axis].max(x);
            }
        }
        let counts = [0, 1, 2].map(|axis| (ends[1][axis] - ends[0][axis]) / EDGE + 1);
        Self { first: ends[0], counts }
    }
}

impl Gathered {
    /// Gathers the energies of vertices whose grid edges start at these lattice points.
    pub(crate) fn new(grid: CellGrid, vertices: impl Iterator<Item = ([usize; 3], f64)>) -> Self {
        let mut gathered = Self::default();
        for (point, energy) in vertices {
            let cell = [0, 1, 2].map(|axis| (point[axis] - grid.first[axis]) / EDGE);
            gathered.add(cell, [energy, 1.0]);
        }
        gathered
    }

    /// Takes in what was gathered elsewhere.
    pub(crate) fn merge(&mut self, other: Self) {
        for (cell, sum) in other.0 {
            self.add(cell, sum);
        }
    }

    fn add(&mut self, cell: [usize; 3], more: Sum) {
        let sum = self.0.entry(cell).or_default();
        *sum = [0, 1].map(|n| sum[n] + more[n]);
    }
}

impl MeanEnergy {
    /// The means around every place.
    pub(crate) fn around(grid: CellGrid, gathered: &Gathered) -> Self {
        let counts = grid.counts;
        let mut sums = vec![[0.0; 2]; counts.iter().product()];
        for (&[i, j, k], sum) in &gathered.0 {
            sums[i + counts[0] * (j + counts[1] * k)] = sum.map(|sum| sum as f32);
        }
        let all = gathered.0.values().fold([0.0; 2], |all, sum| [0, 1].map(|n| all[n] + sum[n]));
        let mut cells = Cells { grid, sums, of_all: all[0] / all[1].max(1.0) };
        for axis in 0..3 {
            cells.widen(axis);
        }
        Self::Around(cells)
    }

    /// The means around `count` lattice points at which grid edges of vertices start.
    pub(crate) fn at(&self, count: usize, points: impl Iterator<Item = [usize; 3]>) -> Vec<f32> {
        match self {
            Self::OfAll(mean) => vec![*mean as f32; count],
            Self::Around(cells) => points.map(|point| cells.mean(point) as f32).collect(),
        }
    }
}

impl Cells {
    /// Adds half of what the cells before and after along an axis have.
    fn widen(&mut self, axis: usize) {
        let count = self.grid.counts[axis];
        let stride: usize = self.grid.counts[..axis].iter().product();
        let before = self.sums.clone();
        for (n, sums) in self.sums.iter_mut().enumerate() {
            let at = n / stride % count;
            let lower = (at > 0).then(|| before[n - stride]);
            let upper = (at + 1 < count).then(|| before[n + stride]);
            for other in lower.into_iter().chain(upper) {
                *sums = [0, 1].map(|n| sums[n] + 0.5 * other[n]);
            }
        }
    }

    /// Between the centres of cells sums change evenly. Far from all vertices the mean is that of all.
    fn mean(&self, point: [usize; 3]) -> f64 {
        let CellGrid { first, counts } = self.grid;
        let place = |axis: usize| {
            let place = (point[axis] as f64 - first[axis] as f64 + 0.5) / EDGE as f64 - 0.5;
            let place = place.clamp(0.0, (counts[axis] - 1) as f64);
            (place as usize, place.fract())
        };
        let places = [0, 1, 2].map(place);
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let (mut weight, mut index, mut stride) = (1.0, 0, 1);
            for (axis, (low, part)) in places.into_iter().enumerate() {
                let high = corner >> axis & 1;
                weight *= if high == 1 { part } else { 1.0 - part };
                index += stride * (low + high).min(counts[axis] - 1);
                stride *= counts[axis];
            }
            sum = [0, 1].map(|n| sum[n] + weight * f64::from(self.sums[index][n]));
        }
        if sum[1] > 0.0 { sum[0] / sum[1] } else { self.of_all }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMS: [usize; 3] = [40, 24, 9];

    fn points() -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = DIMS;
        let row = move |j, k| (0..nx).map(move |i| [i, j, k]);
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| row(j, k)))
    }

    fn around(energy: impl Fn([usize; 3]) -> f64) -> MeanEnergy {
        let grid = CellGrid::of(points());
        MeanEnergy::around(grid, &Gathered::new(grid, points().map(|point| (point, energy(point)))))
    }

    fn at(means: &MeanEnergy, point: [usize; 3]) -> f64 {
        f64::from(means.at(1, [point].into_iter())[0])
    }

    #[test]
    fn means_of_equal_energies_are_these() {
        let means = around(|_| 3.0);
        for point in points() {
            assert!((at(&means, point) - 3.0).abs() < 1e-5, "{point:?}");
        }
    }

    #[test]
    fn means_follow_energies_nearby_and_change_evenly() {
        // A rough end of a smooth body.
        let means = around(|[i, ..]| if i < 8 { 1.0 } else { 0.0 });
        assert!(at(&means, [0, 12, 4]) > 0.5);
        assert_eq!(at(&means, [32, 12, 4]), 0.0);
        let along: Vec<f64> = (0..DIMS[0]).map(|i| at(&means, [i, 12, 4])).collect();
        for pair in along.windows(2) {
            assert!(pair[0] >= pair[1] && pair[0] - pair[1] < 0.1, "{along:?}");
        }
    }

    #[test]
    fn what_is_gathered_in_parts_is_what_is_gathered_at_once() {
        let of = |part: usize| {
            let own = points().filter(move |[i, ..]| i / 13 == part);
            Gathered::new(CellGrid::of(points()), own.map(|point| (point, point[0] as f64)))
        };
        let mut all = Gathered::default();
        (0..4).for_each(|part| all.merge(of(part)));
        let grid = CellGrid::of(points());
        assert_eq!(all, Gathered::new(grid, points().map(|point| (point, point[0] as f64))));
    }

    #[test]
    fn far_from_all_vertices_the_mean_is_that_of_all() {
        let ends = [([1, 0, 0], 1.0), ([79, 23, 8], 2.0)];
        let grid = CellGrid::of(ends.iter().map(|end| end.0));
        let means = MeanEnergy::around(grid, &Gathered::new(grid, ends.into_iter()));
        assert_eq!(at(&means, [40, 12, 4]), 1.5);
        assert_eq!(at(&means, [79, 23, 8]), 2.0);
        // Beyond the vertices, as after a change.
        assert_eq!(at(&means, [0, 0, 0]), 1.0);
    }

    #[test]
    fn means_move_with_the_vertices() {
        let energy = |[i, j, k]: [usize; 3]| (i * i + 3 * j + k) as f64;
        let here = around(energy);
        let moved = |point: [usize; 3]| [point[0] + 3, point[1] + 5, point[2] + 9];
        let grid = CellGrid::of(points().map(moved));
        let vertices = points().map(|point| (moved(point), energy(point)));
        let there = MeanEnergy::around(grid, &Gathered::new(grid, vertices));
        for point in points() {
            assert_eq!(at(&here, point), at(&there, moved(point)), "{point:?}");
        }
    }
}
