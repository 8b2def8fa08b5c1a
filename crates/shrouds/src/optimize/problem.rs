//! The energy of all planar curves as a function of the positions along the grid edges.

use std::iter::Sum;
use std::ops::{Add, Range};

use crate::energy::{CurveEnergy, Energy, LANES, Lanes, Support};
use crate::network::{Network, REPEATED};
use crate::optimize::real::Real;
use crate::optimize::settings::Settings;
use crate::optimize::strip::{Lengths, STRIP, Strip};
use crate::parallel::{self, NONE};
use crate::surface::Surface;

/// Largest barrier strength, and the least weight factor `1 − n_p²`.
const BARRIER_CAP: f64 = 0.01;
const LEAST_WEIGHT: f64 = 1e-4;
/// What stands for the slope of a curve that runs straight along a grid edge.
const STEEPEST: f64 = 1e6;

/// What a problem is made of besides the curves.
#[derive(Clone, Copy)]
pub(super) struct Conditions<'a> {
    pub(super) energy: &'a Energy,
    /// Of the lattice, in units of the smallest one.
    pub(super) spacing: [f64; 3],
    /// Between what the positions must stay.
    pub(super) bounds: [f64; 2],
}

impl<'a> Conditions<'a> {
    pub(super) fn new(surface: &Surface, settings: &Settings, energy: &'a Energy) -> Self {
        let grid = surface.grid();
        let spacing = grid.spacing().map(|h| h / grid.min_spacing());
        Self { energy, spacing, bounds: [settings.margin, 1.0 - settings.margin] }
    }
}

/// The function to minimise. Weights and barrier depend on the surface; they are frozen while
/// solving and refreshed by [`Problem::freeze`]. Lengths are in units of the smallest spacing.
pub(super) struct Problem<'a, R> {
    pub(super) network: &'a Network,
    energy: &'a Energy,
    pub(super) parts: Vec<WeightedPart<'a, R>>,
    lengths: Lengths<R>,
    pub(super) bounds: [R; 2],
    pub(super) barrier: Barrier,
    /// Whether a vertex must stay where it is.
    pub(super) is_fixed: Vec<bool>,
}

/// A measure with the weight of its ρ at every place, 0 where a vertex that it needs is missing.
pub(super) struct WeightedPart<'a, R> {
    pub(super) measure: &'a dyn CurveEnergy,
    weight: f64,
    /// By vertex; none stands for 1.
    factors: Option<Vec<f32>>,
    weights: Vec<R>,
}

/// The value of the energy, and the part of it that stands at vertices that are not fixed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Value {
    pub(super) all: f64,
    pub(super) own: f64,
}

impl Add for Value {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { all: self.all + other.all, own: self.own + other.own }
    }
}

impl Sum for Value {
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
    /// `local` takes what is known of the vertices of the surface to those of the network.
    pub(super) fn new(
        network: &'a Network,
        conditions: &Conditions<'a>,
        local: impl Fn(&[f32]) -> Vec<f32>,
    ) -> Self {
        let parts = conditions.energy.parts().iter().map(|part| WeightedPart {
            measure: part.measure.as_ref(),
            weight: part.weight,
            factors: part.factors.as_deref().map(&local),
            weights: vec![R::default(); network.vertices().len()],
        });
        let mut problem = Self {
            network,
            energy: conditions.energy,
            parts: parts.collect(),
            lengths: Lengths::new(conditions.spacing),
            bounds: conditions.bounds.map(R::from_f64),
            barrier: Barrier(0.0),
            is_fixed: vec![false; network.vertex_count()],
        };
        problem.set_weights(|_| R::from_f64(1.0));
        problem
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.network.vertex_count()
    }

    /// The largest support of the measures.
    pub(super) fn support(&self) -> Support {
        self.energy.support()
    }

    /// Whether weights or barrier depend on the surface.
    pub(super) fn needs_freezing(&self) -> bool {
        self.energy.has_meusnier_weights() || self.energy.barrier() != 0.0
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
        if !self.energy.has_meusnier_weights() {
            return;
        }
        // With slopes s of the two curves the normal is (−1, s₁, s₀) along the grid edge and along the
        // normals of curves 0 and 1.
        let (network, slopes) = (self.network, self.place_slopes(x));
        self.set_weights(|place| {
            let places = network.places()[network.vertices()[place] as usize];
            let curve = network.steps()[place].curve();
            let [own, other] = [curve, 1 - curve].map(|c| slopes[places[c] as usize]);
            let one = R::from_f64(1.0);
            let (own, other) = (own * own, other * other);
            let least = R::from_f64(LEAST_WEIGHT);
            let share = (one + own) / (one + own + other);
            if share > least { share } else { least }
        });
    }

    /// The slopes of both curves of every vertex over its grid edge: how far their tangents run along
    /// the edge for each unit across it, towards the high side. The tangent is that of the circle
    /// through three vertices.
    pub(super) fn slopes(&self, x: &[R]) -> Vec<[f32; 2]> {
        let of_places = self.place_slopes(x);
        let mut slopes = vec![[0.0; 2]; x.len()];
        parallel::fill(&mut slopes, |v| {
            let [a, b] = self.network.places()[v];
            let slopes = [of_places[a as usize], of_places[b as usize]];
            slopes.map(|slope| slope.to_f64().clamp(-STEEPEST, STEEPEST) as f32)
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
            self.strips(x, first..first + slopes.len(), |strip, places| {
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

    /// Weighs each place by a power of its share `1 − n_p²`, and by nothing where its curve ends.
    fn set_weights(&mut self, share: impl Fn(usize) -> R + Sync) {
        let (network, lengths) = (self.network, self.lengths);
        let is_linked = |place: usize| network.steps()[place].is_linked();
        for part in &mut self.parts {
            let (exponent, support) = (part.measure.meusnier_exponent(), part.measure.support());
            let (weight, factors) = (part.weight, part.factors.as_deref());
            parallel::fill(&mut part.weights, |place| {
                // Where a place repeats another one, that decides.
                let (v, step) = (network.vertices()[place], network.steps()[place]);
                let place = network.place(v, step.curve());
                let is_whole = is_linked(place - 1) && is_linked(place);
                if !is_whole || (support == Support::NextTwo && !is_linked(place + 1)) {
                    return R::default();
                }
                let share = match support {
                    Support::Neighbours => share(place),
                    Support::NextTwo => R::from_f64(0.5) * (share(place) + share(place + 1)),
                };
                let factor = weight * factors.map_or(1.0, |factors| f64::from(factors[v as usize]));
                let distance = lengths.between_planes(step.normal());
                power_of_root(share, exponent) * distance * R::from_f64(factor)
            });
        }
    }

    /// The energy at `x`, barrier included.
    pub(super) fn value(&self, x: &[R]) -> f64 {
        (self.curve_value(x) + self.barrier_value(x)).all
    }

    /// The energy of the curves at `x`.
    fn curve_value(&self, x: &[R]) -> Value {
        parallel::sum_blocks(self.network.vertices().len(), |range| {
            let mut rho = vec![R::default(); range.len()];
            self.strips(x, range.clone(), |strip, places| {
                for part in &self.parts {
                    part.load_weights(strip, places.clone());
                    for n in (0..places.len()).step_by(LANES) {
                        let term = R::terms(part.measure, &strip.stencils(n + REPEATED));
                        let weights = strip.weights(n + REPEATED);
                        let [a, b] = term.residual;
                        let out = &mut rho[places.start - range.start + n..];
                        for (l, out) in out.iter_mut().enumerate().take(LANES.min(places.len() - n))
                        {
                            *out = *out + weights[l] * (a[l] * a[l] + b[l] * b[l]);
                        }
                    }
                }
            });
            self.sum_over_curves(range, &rho)
        })
    }

    /// The sum of the values of a range of places, those that repeat others left out.
    pub(super) fn sum_over_curves(&self, range: Range<usize>, values: &[R]) -> Value {
        let first = range.start;
        let vertices = self.network.vertices();
        let part = |part: Range<usize>| {
            let mut sum = Value::default();
            for (value, &v) in values[part.start - first..].iter().zip(&vertices[part]) {
                let value = value.to_f64();
                sum.all += value;
                sum.own += if self.is_fixed[v as usize] { 0.0 } else { value };
            }
            sum
        };
        self.network.curve_parts(range).map(part).sum()
    }

    /// The barrier of all vertices.
    pub(super) fn barrier_value(&self, x: &[R]) -> Value {
        if self.barrier.0 == 0.0 {
            return Value::default();
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
            Value { all: -self.barrier.0 * all.ln(), own: -self.barrier.0 * own.ln() }
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
        mut f: impl FnMut(&mut Strip<R>, Range<usize>),
    ) {
        let total = self.network.vertices().len();
        let end = range.end.min(total.saturating_sub(REPEATED));
        let mut strip = Strip::new();
        for start in (range.start.max(REPEATED)..end).step_by(STRIP) {
            let places = start..end.min(start + STRIP);
            let loaded = places.start - REPEATED..places.end + REPEATED;
            self.load(&mut strip, x, 0, loaded);
            f(&mut strip, places);
        }
    }

    /// Loads some places to a strip from index `at` on.
    #[inline]
    pub(super) fn load<const LENGTH: usize>(
        &self,
        strip: &mut Strip<R, LENGTH>,
        x: &[R],
        at: usize,
        places: Range<usize>,
    ) {
        strip.load(at, self.network, places, &self.lengths, x);
    }

    /// A mark for every place: `mark` of the smaller squared length of the chords before and after it
    /// and the cosine between them. Where a curve ends the missing neighbour lies far away.
    pub(super) fn mark_places(&self, x: &[R], mark: impl Fn(f32, f32) -> u8 + Sync) -> Vec<u8> {
        let mut marks = vec![0; self.network.vertices().len()];
        parallel::update_blocks(&mut marks, NONE, |first, marks, []| {
            self.strips(x, first..first + marks.len(), |strip, places| {
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

impl<R: Real> WeightedPart<'_, R> {
    /// Sets the weights of a strip whose own places are these, and of those around them.
    pub(super) fn load_weights(&self, strip: &mut Strip<R>, places: Range<usize>) {
        strip.set_weights(0, &self.weights[places.start - REPEATED..places.end + REPEATED]);
    }

    pub(super) fn weights(&self, places: Range<usize>) -> &[R] {
        &self.weights[places]
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

/// The square root of `x` to a power.
fn power_of_root<R: Real>(x: R, exponent: f64) -> R {
    match exponent {
        0.0 => return R::from_f64(1.0),
        5.0 => return x * x * x.sqrt(),
        7.0 => return x * x * x * x.sqrt(),
        _ => {}
    }
    R::from_f64(x.to_f64().powf(0.5 * exponent))
}
