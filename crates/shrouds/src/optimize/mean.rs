//! How far a shape is from what its energy likes best: means of the energies of vertices.

use std::collections::BTreeMap;

/// Lattice points along the edge of a cell in which energies are gathered.
const EDGE: usize = 8;

/// Mean energies of vertices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MeanEnergy {
    /// That of all vertices.
    OfAll(f64),
    /// Those around every place of a lattice.
    Around(Cells),
}

/// Energies of vertices by the cells of a lattice in which their grid edges start, as sums.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Gathered(BTreeMap<[usize; 3], Sum>);

/// The sum of some energies, and their number.
type Sum = [f64; 2];

/// Mean energies around the cells of a lattice.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cells {
    counts: [usize; 3],
    /// Energy and number of the vertices in a cell and those next to it; x fastest.
    sums: Vec<[f32; 2]>,
    of_all: f64,
}

impl Gathered {
    /// Gathers the energies of vertices whose grid edges start at these lattice points.
    pub(crate) fn new(vertices: impl Iterator<Item = ([usize; 3], f64)>) -> Self {
        let mut gathered = Self::default();
        for (point, energy) in vertices {
            gathered.add(point.map(|index| index / EDGE), [energy, 1.0]);
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
    /// The means around every place of a lattice with so many points along its axes.
    pub(crate) fn around(dims: [usize; 3], gathered: &Gathered) -> Self {
        let counts = dims.map(|points| points.div_ceil(EDGE));
        let mut sums = vec![[0.0; 2]; counts.iter().product()];
        for (&[i, j, k], sum) in &gathered.0 {
            sums[i + counts[0] * (j + counts[1] * k)] = sum.map(|sum| sum as f32);
        }
        let all = gathered.0.values().fold([0.0; 2], |all, sum| [0, 1].map(|n| all[n] + sum[n]));
        let mut cells = Cells { counts, sums, of_all: mean(all) };
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
        let count = self.counts[axis];
        let stride: usize = self.counts[..axis].iter().product();
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
        let place = |axis: usize| {
            let place = (point[axis] as f64 + 0.5) / EDGE as f64 - 0.5;
            let place = place.clamp(0.0, (self.counts[axis] - 1) as f64);
            (place as usize, place.fract())
        };
        let places = [0, 1, 2].map(place);
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let (mut weight, mut index, mut stride) = (1.0, 0, 1);
            for (axis, (low, part)) in places.into_iter().enumerate() {
                let high = corner >> axis & 1;
                weight *= if high == 1 { part } else { 1.0 - part };
                index += stride * (low + high).min(self.counts[axis] - 1);
                stride *= self.counts[axis];
            }
            sum = [0, 1].map(|n| sum[n] + weight * f64::from(self.sums[index][n]));
        }
        if sum[1] > 0.0 { mean(sum) } else { self.of_all }
    }
}

fn mean([sum, count]: Sum) -> f64 {
    sum / count.max(1.0)
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
        MeanEnergy::around(DIMS, &Gathered::new(points().map(|point| (point, energy(point)))))
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
            Gathered::new(own.map(|point| (point, point[0] as f64)))
        };
        let mut all = Gathered::default();
        (0..4).for_each(|part| all.merge(of(part)));
        assert_eq!(all, Gathered::new(points().map(|point| (point, point[0] as f64))));
    }

    #[test]
    fn far_from_all_vertices_the_mean_is_that_of_all() {
        let two = [([0, 0, 0], 1.0), ([1, 0, 0], 2.0)];
        let means = MeanEnergy::around(DIMS, &Gathered::new(two.into_iter()));
        assert_eq!(at(&means, [39, 23, 8]), 1.5);
        assert_eq!(at(&means, [0, 0, 0]), 1.5);
    }
}
