//! The same volume on another lattice.

use std::ops::Range;

use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;
use crate::volume::runs::set_run;

/// Most samples per axis that are averaged over one voxel.
const MOST_SAMPLES: usize = 64;
/// Most rows, and most words of each, that are looked at to find sixty-four points on one side.
const MOST_ROWS: usize = 16;
const MOST_WORDS: usize = 8;
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
            let within = samples.within(start, nx);
            for first in (within.start / 64 * 64..within.end).step_by(64) {
                let points = first.max(within.start)..within.end.min(first + 64);
                let is_inside = |i: usize| {
                    let middle = samples.map.along_x(start, i);
                    match interpolation {
                        Interpolation::Nearest => source.nearest(middle),
                        Interpolation::Linear => samples.mean(&source, middle) >= HALF,
                    }
                };
                match source.common_side(samples.ends(start, &points)) {
                    Some(false) => {}
                    Some(true) => set_run(words, points),
                    None => {
                        let bit = |i: usize| u64::from(is_inside(i)) << (i % 64);
                        words[first / 64] = points.map(bit).fold(0, |bits, bit| bits | bit);
                    }
                }
            }
        });
        Ok(result)
    }

    /// The side of all lattice points around the indices from one corner of a box to the other, if they
    /// have one in common and are not too many to look at.
    fn common_side(&self, [low, high]: [[f64; 3]; 2]) -> Option<bool> {
        let dims = self.grid().dims();
        if (0..3).any(|d| high[d] < 0.0 || low[d] > dims[d] as f64) {
            return Some(false);
        }
        // Beyond the lattice is what its outermost layer is, outside. Casts saturate.
        let [x, y, z] = [0, 1, 2]
            .map(|d| (low[d] as usize).min(dims[d] - 1)..dims[d].min(high[d] as usize + 2));
        if y.len() * z.len() > MOST_ROWS {
            return None;
        }
        let mut mask = [0; MOST_WORDS];
        let own = x.start / 64..x.end.div_ceil(64);
        let mask = mask.get_mut(..own.len())?;
        set_run(mask, x.start - 64 * own.start..x.end - 64 * own.start);
        let (mut all, mut any) = (true, false);
        for row in z.flat_map(|k| y.clone().map(move |j| (j, k))).map(|(j, k)| self.row(j, k)) {
            for (bits, mask) in row[own.clone()].iter().zip(&*mask) {
                all &= bits & mask == *mask;
                any |= bits & mask != 0;
            }
            if any && !all {
                return None;
            }
        }
        Some(any)
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
        let (words, per_row) = self.words();
        let (first, shift) = ((k * dims[1] + j) * per_row + i / 64, i % 64);
        // The bits of points i and i + 1, which may lie in the next word.
        let pair = |word: usize| {
            let next = if shift == 63 { words[word + 1] << 1 } else { 0 };
            (words[word] >> shift | next) & 3
        };
        let rows = [0, 1, dims[1], dims[1] + 1].map(|row| pair(first + row * per_row));
        match rows {
            [0, 0, 0, 0] => return 0.0,
            [3, 3, 3, 3] => return 1.0,
            _ => {}
        }
        let [x, y, z] = [index[0] - i as f64, index[1] - j as f64, index[2] - k as f64];
        let [a, b, c, d] = rows.map(|pair| (pair & 1) as f64 * (1.0 - x) + (pair >> 1) as f64 * x);
        (a * (1.0 - y) + b * y) * (1.0 - z) + (c * (1.0 - y) + d * y) * z
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

    /// The smallest and the largest old indices of the samples of some points of a row, a little apart.
    fn ends(&self, start: [f64; 3], points: &Range<usize>) -> [[f64; 3]; 2] {
        let [a, b] = [points.start, points.end - 1].map(|i| self.map.along_x(start, i));
        let margin = self.extent.map(|extent| extent + 1e-6);
        let low = std::array::from_fn(|d| a[d].min(b[d]) - margin[d]);
        [low, std::array::from_fn(|d| a[d].max(b[d]) + margin[d])]
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
