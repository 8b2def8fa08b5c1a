//! The occupancy blurred by one voxel, near the surface only.

use crate::surface::Surface;
use crate::volume::{Border, Occupancy};

/// The value on the surface: half the sum of all weights of the filter, 16³.
pub(super) const HALF: i32 = 2048;

/// Symmetric filters of five points with their variances in squared lattice steps. In integers; each
/// sums to 16.
const FILTERS: [(f64, Weights); 4] =
    [(1.0, [6, 4, 1]), (0.5, [8, 4, 0]), (0.25, [12, 2, 0]), (0.0, [16, 0, 0])];
/// Standard deviation of the blur, in units of the smallest spacing, as far as five points allow.
const DEVIATION: f64 = 1.5;

/// Weights of a point, of its two neighbours and of theirs.
type Weights = [u16; 3];

const REACH: usize = 2;
/// Lattice points per word.
const WORD: usize = 64;

/// The filters along the three axes.
pub(super) struct Filter {
    /// For twelve successive lattice points along x the filtered values of the middle eight.
    table: Vec<[u8; 8]>,
    y: Weights,
    z: Weights,
}

impl Filter {
    /// A blur as wide in the world along all axes, `spacing` being in units of the smallest one.
    pub(super) fn new(spacing: [f64; 3]) -> Self {
        let [x, y, z] = spacing.map(|spacing| {
            let wanted = (DEVIATION / spacing).powi(2);
            let nearest = |(a, _): &&(f64, Weights), (b, _): &&(f64, Weights)| {
                (a - wanted).abs().total_cmp(&(b - wanted).abs())
            };
            FILTERS.iter().min_by(nearest).map_or(FILTERS[0].1, |filter| filter.1)
        });
        let [a, b, c] = x;
        let weights = [c, b, a, b, c];
        let filter =
            |bits: usize| (0..5).map(|n| weights[n] * (bits >> n & 1) as u16).sum::<u16>() as u8;
        let table = (0..1 << 12).map(|bits| std::array::from_fn(|n| filter(bits >> n))).collect();
        Self { table, y, z }
    }
}

/// Blurred values of the lattice points of a word.
type Values = [u16; WORD];

/// Blurred slices, one after another.
///
/// The blur runs along x, then y, then z, on words of 64 lattice points that hold an end of a crossed
/// grid edge; values of others mean nothing. Beyond a closed border all is outside; beyond an open
/// one the last points are repeated.
pub(super) struct Blur<'a> {
    volume: &'a Occupancy,
    border: Border,
    filter: &'a Filter,
    words: usize,
    /// The last slices blurred along x and y: that of slice `k` is number `k` modulo their count.
    flat: Vec<Flat>,
}

/// A slice blurred along x, and along x and y, as far as it was needed.
struct Flat {
    slice: usize,
    along_x: Words,
    along_both: Words,
}

/// The values of some words of a slice.
pub(super) struct Words {
    /// For every word where its values are; [`NOWHERE`] if they are not known.
    at: Vec<u32>,
    values: Vec<Values>,
}

const NOWHERE: u32 = u32::MAX;

impl Words {
    fn new(count: usize) -> Self {
        Self { at: vec![NOWHERE; count], values: Vec::new() }
    }

    fn clear(&mut self) {
        self.at.fill(NOWHERE);
        self.values.clear();
    }

    fn is_known(&self, index: usize) -> bool {
        self.at[index] != NOWHERE
    }

    /// The values of a known word.
    #[inline(always)]
    fn of(&self, index: usize) -> &Values {
        &self.values[self.at[index] as usize]
    }

    fn insert(&mut self, index: usize, values: Values) {
        self.at[index] = self.values.len() as u32;
        self.values.push(values);
    }
}

impl<'a> Blur<'a> {
    pub(super) fn new(surface: &'a Surface, filter: &'a Filter) -> Self {
        let volume = surface.volume();
        let [nx, ny, _] = volume.grid().dims();
        let words = nx.div_ceil(WORD);
        let flat = || Flat {
            slice: usize::MAX,
            along_x: Words::new(words * ny),
            along_both: Words::new(words * ny),
        };
        let count = 2 * REACH + 1;
        Self {
            volume,
            border: surface.border(),
            filter,
            words,
            flat: (0..count).map(|_| flat()).collect(),
        }
    }

    /// A slice to blur into.
    pub(super) fn slice(&self) -> Words {
        Words::new(self.words * self.volume.grid().dims()[1])
    }

    /// The blurred value of point `i` of row `j` of a slice.
    #[inline(always)]
    pub(super) fn value(&self, slice: &Words, i: usize, j: usize) -> i32 {
        i32::from(slice.of(j * self.words + i / WORD)[i % WORD])
    }

    /// Blurs slice `k`.
    pub(super) fn fill(&mut self, k: usize, slice: &mut Words) {
        slice.clear();
        let volume = self.volume;
        let [_, ny, nz] = volume.grid().dims();
        for j in 0..ny {
            let row = volume.row(j, k);
            let beside = [
                volume.row(j.saturating_sub(1), k),
                volume.row((j + 1).min(ny - 1), k),
                volume.row(j, k.saturating_sub(1)),
                volume.row(j, (k + 1).min(nz - 1)),
            ];
            for w in (0..self.words).filter(|&w| is_near(row, beside, w)) {
                let near = neighbours(k, nz, self.border);
                for k in near.into_iter().flatten() {
                    self.flatten(j, k, w);
                }
                let index = j * self.words + w;
                let values = near.map(|k| k.map(|k| self.flat(k).along_both.of(index)));
                slice.insert(index, weighted(self.filter.z, &values));
            }
        }
    }

    fn flat(&self, k: usize) -> &Flat {
        &self.flat[k % self.flat.len()]
    }

    /// Blurs word `w` of row `(j, k)` along x and y, if that was not done yet.
    fn flatten(&mut self, j: usize, k: usize, w: usize) {
        let count = self.flat.len();
        let index = j * self.words + w;
        let flat = &mut self.flat[k % count];
        if flat.slice != k {
            flat.slice = k;
            flat.along_x.clear();
            flat.along_both.clear();
        }
        if flat.along_both.is_known(index) {
            return;
        }
        let [nx, ny, _] = self.volume.grid().dims();
        let rows = neighbours(j, ny, self.border);
        for j in rows.into_iter().flatten() {
            let index = j * self.words + w;
            if !flat.along_x.is_known(index) {
                let row = self.volume.row(j, k);
                let values = along_row(&self.filter.table, row, w, nx, self.border);
                flat.along_x.insert(index, values);
            }
        }
        let rows = rows.map(|j| j.map(|j| flat.along_x.of(j * self.words + w)));
        flat.along_both.insert(index, weighted(self.filter.y, &rows));
    }
}

/// Whether word `w` of a row with these four beside it holds an end of a crossed grid edge.
#[inline(always)]
fn is_near(row: &[u64], beside: [&[u64]; 4], w: usize) -> bool {
    let here = row[w];
    // A crossing along x reaches over a word's border.
    let crosses_border = w + 1 < row.len() && (here >> 63) != (row[w + 1] & 1)
        || w > 0 && (here & 1) != (row[w - 1] >> 63);
    let mixed = here != 0 && here != u64::MAX;
    mixed || crosses_border || beside.iter().any(|row| row[w] != here)
}

/// The indices around `at` in a row of `count`: none beyond a closed border, the last ones again
/// beyond an open one.
fn neighbours(at: usize, count: usize, border: Border) -> [Option<usize>; 5] {
    std::array::from_fn(|n| {
        let index = (at + n).checked_sub(REACH).filter(|&index| index < count);
        match border {
            Border::Closed => index,
            Border::Open => Some((at + n).saturating_sub(REACH).min(count - 1)),
        }
    })
}

/// The weighted sum of five words of values, absent ones being 0.
#[inline(always)]
fn weighted([near, next, far]: Weights, values: &[Option<&Values>; 5]) -> Values {
    const NOTHING: Values = [0; WORD];
    let [a, b, c, d, e] = values.map(|values| values.unwrap_or(&NOTHING));
    let mut sum = NOTHING;
    for n in 0..WORD {
        sum[n] = far * (a[n] + e[n]) + next * (b[n] + d[n]) + near * c[n];
    }
    sum
}

/// Word `w` of a row of `nx` lattice points, blurred along the row.
#[inline(always)]
fn along_row(table: &[[u8; 8]], row: &[u64], w: usize, nx: usize, border: Border) -> Values {
    let before = if w > 0 { row[w - 1] >> 62 } else { repeated(row[0] & 1, border) & 3 };
    let mut here = row[w];
    let mut after = row.get(w + 1).copied().unwrap_or_default();
    // Bits past the end of the row are 0, as a closed border has it.
    let last = repeated(row[(nx - 1) / WORD] >> ((nx - 1) % WORD) & 1, border);
    let past = |w: usize| match nx.saturating_sub(WORD * w) {
        points if points >= WORD => 0,
        points => u64::MAX << points,
    };
    here |= last & past(w);
    after |= last & past(w + 1);
    let bits = u128::from(before) | u128::from(here) << 2 | u128::from(after) << 66;
    let mut values = [0; WORD];
    for (n, values) in values.chunks_exact_mut(8).enumerate() {
        let filtered = table[(bits >> (8 * n)) as usize & 0xFFF];
        for (value, byte) in values.iter_mut().zip(filtered) {
            *value = u16::from(byte);
        }
    }
    values
}

/// All bits like a border point's on an open border; none on a closed one.
fn repeated(bit: u64, border: Border) -> u64 {
    if border == Border::Open && bit == 1 { u64::MAX } else { 0 }
}
