//! The energy of all planar curves as a function of the positions along the grid edges.

use std::iter::Sum;
use std::ops::{Add, Range};

use crate::energy::{CurveEnergy, LANES, Lanes};
use crate::network::{Network, REPEATED};
use crate::optimize::real::Real;
use crate::optimize::strip::{Lengths, STRIP, Strip};
use crate::parallel::{self, NONE};

/// Largest barrier strength, and the least weight factor `1 − n_p²`.
const BARRIER_CAP: f64 = 0.01;
const LEAST_WEIGHT: f64 = 1e-4;
/// What stands for the slope of a curve that runs straight along a grid edge.
const STEEPEST: f64 = 1e6;

/// What a problem is made of besides the curves.
pub(super) struct Conditions<'a> {
    pub(super) energy: &'a dyn CurveEnergy,
    /// Of the lattice, in units of the smallest one.
    pub(super) spacing: [f64; 3],
    /// Between what the positions must stay.
    pub(super) bounds: [f64; 2],
}

/// The function to minimise. Weights and barrier depend on the surface; they are frozen while
/// solving and refreshed by [`Problem::freeze`]. Lengths are in units of the smallest spacing.
pub(super) struct Problem<'a, R> {
    pub(super) network: &'a Network,
    pub(super) energy: &'a dyn CurveEnergy,
    pub(super) lengths: Lengths<R>,
    pub(super) bounds: [R; 2],
    /// Weight of ρ at each place; 0 where a neighbour is missing.
    weights: Vec<R>,
    pub(super) barrier: Barrier,
    /// Whether a vertex must stay where it is, and whether there is one that must.
    pub(super) is_fixed: Vec<bool>,
    has_fixed: bool,
}

/// The energy of a problem, and the part of it that stands at vertices that are not fixed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Energy {
    pub(super) all: f64,
    pub(super) own: f64,
}

impl Add for Energy {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { all: self.all + other.all, own: self.own + other.own }
    }
}

impl Sum for Energy {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::default(), |sum, term| sum + term)
    }
}

/// The barrier `−μ·log(4·x·(1 − x))` of strength μ at a position.
#[derive(Clone, Copy)]
pub(super) struct Barrier(f64);

impl Barrier {
    pub(super) fn value(self, x: f64) -> f64 {
        if self.0 == 0.0 { 0.0 } else { -self.0 * (4.0 * x * (1.0 - x)).ln() }
    }

    /// Slope and curvature.
    #[inline]
    pub(super) fn slopes(self, x: f64) -> (f64, f64) {
        let (low, high) = (1.0 / x, 1.0 / (1.0 - x));
        (self.0 * (high - low), self.0 * (low * low + high * high))
    }
}

impl<'a, R: Real> Problem<'a, R> {
    /// The problem with weights as if every slice cut the surface at a right angle, and no barrier.
    pub(super) fn new(network: &'a Network, conditions: &Conditions<'a>) -> Self {
        let mut problem = Self {
            network,
            energy: conditions.energy,
            lengths: Lengths::new(conditions.spacing),
            bounds: conditions.bounds.map(R::from_f64),
            weights: vec![R::default(); network.vertices().len()],
            barrier: Barrier(0.0),
            is_fixed: vec![false; network.vertex_count()],
            has_fixed: false,
        };
        problem.set_weights(&vec![[R::from_f64(1.0); 2]; network.vertex_count()]);
        problem
    }

    /// Lets some vertices stay where they are.
    pub(super) fn fix(&mut self, is_fixed: Vec<bool>) {
        self.has_fixed = is_fixed.contains(&true);
        self.is_fixed = is_fixed;
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.network.vertex_count()
    }

    /// Whether weights or barrier depend on the surface.
    pub(super) fn needs_freezing(&self) -> bool {
        self.energy.meusnier_exponent() != 0.0 || self.energy.barrier() != 0.0
    }

    /// Sets the Meusnier weights, and the barrier from the energy they give, for the surface at `x`.
    pub(super) fn freeze(&mut self, x: &[R]) {
        self.freeze_weights(x);
        if self.energy.barrier() != 0.0 {
            self.set_barrier(self.curve_value(x).all);
        }
    }

    /// Sets the Meusnier weights for the surface at `x`.
    pub(super) fn freeze_weights(&mut self, x: &[R]) {
        let exponent = self.energy.meusnier_exponent();
        if exponent == 0.0 {
            return;
        }
        // With slopes s of the two curves the normal is (−1, s₁, s₀) along the grid edge and along the
        // normals of curves 0 and 1.
        let of_places = self.place_slopes(x);
        let mut factors = vec![[R::default(); 2]; x.len()];
        parallel::update_blocks(&mut factors, NONE, |first, factors, []| {
            let slopes = self.network.at_vertices(first..first + factors.len(), &of_places);
            for (factors, [a, b]) in factors.iter_mut().zip(slopes) {
                let (a, b, one) = (a * a, b * b, R::from_f64(1.0));
                let inverse = one / (one + a + b);
                let least = R::from_f64(LEAST_WEIGHT);
                let weight =
                    |share: R| power_of_root(if share > least { share } else { least }, exponent);
                *factors = [weight((one + a) * inverse), weight((one + b) * inverse)];
            }
            0.0
        });
        self.set_weights(&factors);
    }

    /// The slopes of both curves of every vertex over its grid edge: how far their tangents run along
    /// the edge for each unit across it, towards the high side. The tangent is that of the circle
    /// through three vertices.
    pub(super) fn slopes(&self, x: &[R]) -> Vec<[f32; 2]> {
        let of_places = self.place_slopes(x);
        let mut slopes = vec![[0.0; 2]; x.len()];
        parallel::update_blocks(&mut slopes, NONE, |first, slopes, []| {
            let found = self.network.at_vertices(first..first + slopes.len(), &of_places);
            for (slopes, found) in slopes.iter_mut().zip(found) {
                *slopes = found.map(|slope| slope.to_f64().clamp(-STEEPEST, STEEPEST) as f32);
            }
            0.0
        });
        slopes
    }

    /// Sets the barrier for a surface whose curves have this energy.
    pub(super) fn set_barrier(&mut self, curve_value: f64) {
        let mean = curve_value / self.vertex_count().max(1) as f64;
        self.barrier = Barrier((self.energy.barrier() * mean).min(BARRIER_CAP));
    }

    /// [`Problem::slopes`], place by place.
    fn place_slopes(&self, x: &[R]) -> Vec<R> {
        let mut slopes = vec![R::default(); self.network.vertices().len()];
        parallel::update_blocks(&mut slopes, NONE, |first, slopes, []| {
            self.strips(x, first..first + slopes.len(), false, |strip, places| {
                for n in (0..places.len()).step_by(LANES) {
                    let values = slopes_along(strip, n + REPEATED);
                    let out = places.start - first + n;
                    let count = LANES.min(places.len() - n);
                    slopes[out..out + count].copy_from_slice(&values[..count]);
                }
            });
            0.0
        });
        slopes
    }

    /// Weighs each place by the distance of the planes and the factor of its vertex for its curve,
    /// and by nothing where its curve ends.
    fn set_weights(&mut self, factors: &[[R; 2]]) {
        let (network, lengths) = (self.network, &self.lengths);
        parallel::update_blocks(&mut self.weights, NONE, |first, weights, []| {
            let range = first..first + weights.len();
            let mut is_linked = first > 0 && network.steps()[first - 1].is_linked();
            let places =
                network.steps()[range.clone()].iter().zip(network.at_places(range, factors));
            for (weight, (step, [a, b])) in weights.iter_mut().zip(places) {
                let was_linked = std::mem::replace(&mut is_linked, step.is_linked());
                let factor = if step.curve() == 0 { a } else { b };
                let full = factor * lengths.between_planes(step.normal());
                *weight = if was_linked && is_linked { full } else { R::default() };
            }
            0.0
        });
    }

    /// The energy at `x`, barrier included.
    pub(super) fn value(&self, x: &[R]) -> f64 {
        (self.curve_value(x) + self.barrier_value(x)).all
    }

    /// The energy of the curves at `x`.
    fn curve_value(&self, x: &[R]) -> Energy {
        parallel::sum_blocks(self.network.vertices().len(), |range| {
            let mut rho = vec![R::default(); range.len()];
            self.strips(x, range.clone(), true, |strip, places| {
                for n in (0..places.len()).step_by(LANES) {
                    let term = R::terms(self.energy, &strip.stencils(n + REPEATED));
                    let weights = strip.weights(n + REPEATED);
                    let [a, b] = term.residual;
                    let mut values = weights;
                    for l in 0..LANES {
                        values[l] = weights[l] * (a[l] * a[l] + b[l] * b[l]);
                    }
                    let out = places.start - range.start + n;
                    let count = LANES.min(places.len() - n);
                    rho[out..out + count].copy_from_slice(&values[..count]);
                }
            });
            self.sum_over_curves(range, &rho)
        })
    }

    /// The sum of the values of a range of places, those that repeat others left out.
    pub(super) fn sum_over_curves(&self, range: Range<usize>, values: &[R]) -> Energy {
        let first = range.start;
        let part = |part: Range<usize>| {
            let values = &values[part.start - first..part.end - first];
            let all = sum_of(values);
            let fixed: f64 = if self.has_fixed {
                let is_fixed = self.network.at_places(part, &self.is_fixed);
                let fixed = values.iter().zip(is_fixed).filter(|(_, is_fixed)| *is_fixed);
                fixed.map(|(value, _)| value.to_f64()).sum()
            } else {
                0.0
            };
            Energy { all, own: all - fixed }
        };
        self.network.curve_parts(range).map(part).sum()
    }

    /// The barrier of all vertices.
    pub(super) fn barrier_value(&self, x: &[R]) -> Energy {
        if self.barrier.0 == 0.0 {
            return Energy::default();
        }
        // One logarithm for several factors: their product stays far from the smallest number.
        const FACTORS: usize = 16;
        let logarithm = |(x, is_fixed): (&[R], &[bool])| {
            let (mut all, mut own) = (1.0, 1.0);
            for (x, &is_fixed) in x.iter().zip(is_fixed) {
                let factor = 4.0 * x.to_f64() * (1.0 - x.to_f64());
                all *= factor;
                own *= if is_fixed { 1.0 } else { factor };
            }
            Energy { all: -self.barrier.0 * all.ln(), own: -self.barrier.0 * own.ln() }
        };
        parallel::sum_blocks(x.len(), |range| {
            let chunks = x[range.clone()].chunks(FACTORS);
            chunks.zip(self.is_fixed[range].chunks(FACTORS)).map(logarithm).sum()
        })
    }

    /// Calls `f` with all strips of the places in `range`, but for the very first and last places of
    /// all, which only repeat others.
    pub(super) fn strips(
        &self,
        x: &[R],
        range: Range<usize>,
        with_weights: bool,
        mut f: impl FnMut(&Strip<R>, Range<usize>),
    ) {
        let total = self.network.vertices().len();
        let end = range.end.min(total.saturating_sub(REPEATED));
        let mut strip = Strip::new();
        for start in (range.start.max(REPEATED)..end).step_by(STRIP) {
            let places = start..end.min(start + STRIP);
            let loaded = places.start - REPEATED..places.end + REPEATED;
            self.load(&mut strip, x, loaded, with_weights);
            f(&strip, places);
        }
    }

    /// Loads some places to a strip, with their weights if those are wanted.
    #[inline]
    fn load(&self, strip: &mut Strip<R>, x: &[R], places: Range<usize>, with_weights: bool) {
        strip.load(self.network, places.clone(), &self.lengths, x);
        if with_weights {
            strip.load_weights(&self.weights[places]);
        }
    }

    /// Weight of ρ at a place.
    #[inline(always)]
    pub(super) fn weight(&self, place: usize) -> R {
        self.weights[place]
    }

    /// A mark for every place: `mark` of the smaller squared length of the chords before and after it
    /// and the cosine between them. Where a curve ends the missing neighbour lies far away.
    pub(super) fn mark_places(&self, x: &[R], mark: impl Fn(f32, f32) -> u8 + Sync) -> Vec<u8> {
        let mut marks = vec![0; self.network.vertices().len()];
        parallel::update_blocks(&mut marks, NONE, |first, marks, []| {
            self.strips(x, first..first + marks.len(), false, |strip, places| {
                for n in (0..places.len()).step_by(LANES) {
                    let (lengths, cosines) = turnings(strip, n + REPEATED);
                    let mut values = [0; LANES];
                    for l in 0..LANES {
                        values[l] = mark(lengths[l], cosines[l]);
                    }
                    let out = places.start - first + n;
                    let count = LANES.min(places.len() - n);
                    marks[out..out + count].copy_from_slice(&values[..count]);
                }
            });
            0.0
        });
        marks
    }

    /// Whether the barrier keeps steps from reaching the bounds.
    pub(super) fn has_barrier(&self) -> bool {
        self.barrier.0 > 0.0
    }
}

/// See [`Problem::mark_places`]: squared lengths and cosines.
#[inline(always)]
fn turnings<R: Real>(strip: &Strip<R>, n: usize) -> (Lanes<f32>, Lanes<f32>) {
    let (before, after) = (single(strip.chords(n - 1)), single(strip.chords(n)));
    let (mut lengths, mut cosines) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        let [a, b] = [[before[0][l], before[1][l]], [after[0][l], after[1][l]]];
        let (l0, l1) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
        lengths[l] = if l0 < l1 { l0 } else { l1 };
        cosines[l] = (a[0] * b[0] + a[1] * b[1]) / (l0 * l1).sqrt();
    }
    (lengths, cosines)
}

#[inline(always)]
fn single<R: Real>([u, v]: [Lanes<R>; 2]) -> [Lanes<f32>; 2] {
    let mut single = [[0.0; LANES]; 2];
    for l in 0..LANES {
        single[0][l] = u[l].to_f64() as f32;
        single[1][l] = v[l].to_f64() as f32;
    }
    single
}

/// See [`Problem::slopes`].
#[inline(always)]
fn slopes_along<R: Real>(strip: &Strip<R>, n: usize) -> Lanes<R> {
    let (before, after, moves) = (strip.chords(n - 1), strip.chords(n), strip.moves(n));
    let mut slopes = [R::default(); LANES];
    for l in 0..LANES {
        let [a, b] = [[before[0][l], before[1][l]], [after[0][l], after[1][l]]];
        // Both tangents at a vertex are weighted by the inverse of their chords' squared lengths;
        // only the ratio matters, so by the other's.
        let (wb, wa) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
        let tangent = [wa * a[0] + wb * b[0], wa * a[1] + wb * b[1]];
        let along = tangent[0] * moves[0][l] + tangent[1] * moves[1][l];
        let across = tangent[0] * moves[1][l] + tangent[1] * moves[0][l];
        slopes[l] = along / across;
    }
    slopes
}

/// The sum in double precision, in partial sums side by side.
fn sum_of<R: Real>(values: &[R]) -> f64 {
    let mut sums = [0.0; LANES];
    let chunks = values.chunks_exact(LANES);
    let rest: f64 = chunks.remainder().iter().map(|value| value.to_f64()).sum();
    for chunk in chunks {
        for (sum, value) in sums.iter_mut().zip(chunk) {
            *sum += value.to_f64();
        }
    }
    sums.into_iter().sum::<f64>() + rest
}

/// The square root of `x` to a power.
fn power_of_root<R: Real>(x: R, exponent: f64) -> R {
    if exponent == 5.0 {
        return x * x * x.sqrt();
    }
    R::from_f64(x.to_f64().powf(0.5 * exponent))
}
