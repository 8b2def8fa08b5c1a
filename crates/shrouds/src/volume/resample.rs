//! The same volume on another lattice.

use std::ops::Range;

use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// Most samples per axis that are averaged over one voxel.
const MOST_SAMPLES: usize = 64;
/// What counts as half: a tie must not depend on rounding.
const HALF: f64 = 0.5 - 1e-9;

/// How the side of a point between lattice points is found. Beyond the lattice everything is outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Interpolation {
    /// That of the nearest lattice point along each axis, of two equally near ones that with the larger
    /// index.
    Nearest,
    /// Inside where the trilinear interpolation of 1 (inside) and 0 (outside) is at least one half.
    ///
    /// Where the new lattice is coarser it is the mean over the new voxel that is at least one half: of
    /// as many samples along each of its axes, evenly spread, as the voxel is old lattice steps long, at
    /// most 64.
    #[default]
    Linear,
}

impl Occupancy {
    /// This volume on the lattice `grid`, which may lie anywhere in the world:
    /// [`Grid::with_spacing`] makes a finer or a coarser one in the same place.
    ///
    /// # Errors
    /// [`Error::Memory`] when the new volume does not fit into memory, [`Error::Dimensions`] when the
    /// lattice of this one has no room for a layer of outside points.
    pub fn resample(&self, grid: &Grid, interpolation: Interpolation) -> Result<Self, Error> {
        let mut result = Self::try_empty(grid.clone())?;
        // With a layer around it every sample has eight lattice points.
        let source = self.padded(1)?;
        let samples = Samples::new(source.grid(), grid, interpolation);
        let [nx, _, nz] = grid.dims();
        result.fill_slices(0..nz, |j, k, words| {
            let start = samples.map.point([0.0, j as f64, k as f64]);
            for i in samples.within(start, nx) {
                let middle = samples.map.along_x(start, i);
                let inside = match interpolation {
                    Interpolation::Nearest => source.nearest(middle),
                    Interpolation::Linear => samples.mean(&source, middle) >= HALF,
                };
                words[i / 64] |= u64::from(inside) << (i % 64);
            }
        });
        Ok(result)
    }

    /// Whether the lattice point nearest to an index is inside; none beyond the lattice is.
    fn nearest(&self, index: [f64; 3]) -> bool {
        // Ties go up whatever the rounding. Casts saturate, and what is negative is beyond, too.
        let index = index.map(|x| (x + 0.5 + 1e-9).floor());
        let is_within = (0..3).all(|d| index[d] >= 0.0 && index[d] < self.grid().dims()[d] as f64);
        is_within && self.get(index.map(|x| x as usize))
    }

    /// The trilinear interpolation of 1 inside and 0 outside at an index, 0 beyond the lattice.
    fn linear(&self, index: [f64; 3]) -> f64 {
        let dims = self.grid().dims();
        if (0..3).any(|d| !(index[d] >= 0.0 && index[d] < (dims[d] - 1) as f64)) {
            return 0.0;
        }
        let [i, j, k] = index.map(|x| x as usize);
        let [x, y, z] = [index[0] - i as f64, index[1] - j as f64, index[2] - k as f64];
        let row = |j: usize, k: usize| {
            let row = self.row(j, k);
            let bit = |i: usize| (row[i / 64] >> (i % 64) & 1) as f64;
            bit(i) * (1.0 - x) + bit(i + 1) * x
        };
        let slice = |k: usize| row(j, k) * (1.0 - y) + row(j + 1, k) * y;
        slice(k) * (1.0 - z) + slice(k + 1) * z
    }
}

/// Where the points of a new lattice, and the samples around each, lie in an old one.
struct Samples {
    map: Map,
    /// From the point itself to its samples, in old indices.
    offsets: Vec<[f64; 3]>,
    /// How far these go at most.
    extent: [f64; 3],
    dims: [usize; 3],
}

impl Samples {
    fn new(from: &Grid, to: &Grid, interpolation: Interpolation) -> Self {
        let map = Map::between(to, from);
        let counts: [usize; 3] = std::array::from_fn(|d| {
            let steps = map.0.iter().map(|row| row[d].abs()).fold(0.0, f64::max);
            match interpolation {
                Interpolation::Nearest => 1,
                // One by rounding is one.
                Interpolation::Linear => ((steps - 1e-6).ceil() as usize).clamp(1, MOST_SAMPLES),
            }
        });
        let place = |n: usize, d: usize| (n as f64 + 0.5) / counts[d] as f64 - 0.5;
        let [x, y, z] = counts;
        let offsets: Vec<[f64; 3]> = (0..x * y * z)
            .map(|n| map.vector([place(n % x, 0), place(n / x % y, 1), place(n / x / y, 2)]))
            .collect();
        let extent = std::array::from_fn(|r| offsets.iter().map(|o| o[r]).fold(0.0, f64::max));
        Self { map, offsets, extent, dims: from.dims() }
    }

    /// Which of the `count` points along x from the old index `start` on may have samples within the old
    /// lattice.
    fn within(&self, start: [f64; 3], count: usize) -> Range<usize> {
        let mut within = [0.0, count as f64 - 1.0];
        for (r, start) in start.into_iter().enumerate() {
            let step = self.map.0[r][0];
            let low = -1.0 - self.extent[r] - start;
            let high = self.dims[r] as f64 + self.extent[r] - start;
            if step.abs() < 1e-12 {
                // Along the whole row the index changes by less than the margin of one.
                if low > 0.0 || high < 0.0 {
                    return 0..0;
                }
                continue;
            }
            let [a, b] = [low / step, high / step];
            within = [within[0].max(a.min(b)), within[1].min(a.max(b))];
        }
        // Casts saturate.
        within[0].ceil() as usize..(within[1].floor() + 1.0) as usize
    }

    /// The mean of the samples around an old index.
    fn mean(&self, source: &Occupancy, middle: [f64; 3]) -> f64 {
        let at = |o: &[f64; 3]| source.linear(std::array::from_fn(|d| middle[d] + o[d]));
        self.offsets.iter().map(at).sum::<f64>() / self.offsets.len() as f64
    }
}

/// An affine map from indices of one lattice to those of another.
struct Map([[f64; 4]; 3]);

impl Map {
    fn between(from: &Grid, to: &Grid) -> Self {
        let (a, inverse) = (from.affine(), to.inverse_affine());
        Self(inverse.map(|row| {
            std::array::from_fn(|c| {
                let shift = if c == 3 { row[3] } else { 0.0 };
                (0..3).map(|m| row[m] * a[m][c]).sum::<f64>() + shift
            })
        }))
    }

    fn point(&self, index: [f64; 3]) -> [f64; 3] {
        let vector = self.vector(index);
        std::array::from_fn(|r| vector[r] + self.0[r][3])
    }

    fn vector(&self, step: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * step[0] + row[1] * step[1] + row[2] * step[2])
    }

    /// The place `i` steps along x from `start`.
    fn along_x(&self, start: [f64; 3], i: usize) -> [f64; 3] {
        std::array::from_fn(|r| start[r] + self.0[r][0] * i as f64)
    }
}
