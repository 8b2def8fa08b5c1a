//! By what the energy counts at every place: Meusnier weights from the slopes of the curves, creases, thin parts.

use crate::energy::{Bending, LANES, Support};
use crate::network::{REPEATED, Step};
use crate::optimize::crease;
use crate::optimize::problem::{Problem, WeightedPart};
use crate::optimize::real::Real;
use crate::parallel::{self, NONE};

/// The least weight factor `1 − n_p²`.
const LEAST_WEIGHT: f64 = 1e-4;
/// What stands for the slope of a curve that runs straight along a grid edge.
const STEEPEST: f64 = 1e6;

impl<'a, R: Real> Problem<'a, R> {
    /// Puts bending in the place of measures that are blind to circles where parts are one voxel thin: nothing
    /// else would keep a rod from shrinking or growing. `thinness` is asked for if there are such.
    pub(crate) fn keep_thin_parts(&mut self, thinness: impl FnOnce() -> Vec<f32>) {
        let is_blind = |part: &WeightedPart<R>| part.measure.is_blind_to_circles();
        if self.creases.is_some() || !self.parts.iter().any(is_blind) {
            return;
        }
        let thinness = thinness();
        if thinness.iter().all(|&thin| thin == 0.0) {
            return;
        }
        let mut of_thin_parts = Vec::new();
        for part in self.parts.iter_mut().filter(|part| is_blind(part)) {
            let factors = part.factors.take().unwrap_or_else(|| vec![1.0; thinness.len()]);
            let shared = |share: fn(f32) -> f32| {
                let shares = factors.iter().zip(&thinness).map(|(a, &thin)| a * share(thin));
                Some(shares.collect())
            };
            part.factors = shared(|thin| 1.0 - thin);
            let (measure, weight, factors) = (&Bending, part.weight, shared(|thin| thin));
            let weights = vec![R::default(); part.weights.len()];
            of_thin_parts.push(WeightedPart { measure, weight, factors, weights });
        }
        self.parts.extend(of_thin_parts);
    }

    /// Sets the Meusnier weights for the surface at `x`.
    pub(crate) fn freeze_weights(&mut self, x: &[R]) {
        if !self.has_weights() {
            return;
        }
        let slopes = self.place_slopes(x);
        self.weigh(x, &slopes);
    }

    /// Sets the Meusnier weights for curves with these slopes, place by place. Returns the shares
    /// `1 − n_p²` of all vertices for both their curves.
    pub(crate) fn weigh(&mut self, x: &[R], of_places: &[R]) -> Vec<[R; 2]> {
        // With slopes s of the two curves the normal is (−1, s₁, s₀) along the grid edge and along the
        // normals of curves 0 and 1.
        let mut shares = vec![[R::default(); 2]; x.len()];
        parallel::update_blocks(&mut shares, NONE, |first, shares, []| {
            let slopes = self.network.at_vertices(first..first + shares.len(), of_places);
            for (shares, [a, b]) in shares.iter_mut().zip(slopes) {
                let (a, b, one) = (a * a, b * b, R::from_f64(1.0));
                let inverse = one / (one + a + b);
                let least = R::from_f64(LEAST_WEIGHT);
                *shares = [(one + a) * inverse, (one + b) * inverse]
                    .map(|share| if share > least { share } else { least });
            }
            0.0
        });
        let straightness = self.straightness(x);
        self.set_weights(&shares, &straightness);
        shares
    }

    /// The slopes of both curves of every vertex over its grid edge: how far their tangents run along
    /// the edge for each unit across it, towards the high side. The tangent is that of the circle
    /// through three vertices.
    pub(crate) fn slopes(&self, x: &[R]) -> Vec<[f32; 2]> {
        self.slopes_of(&self.place_slopes(x))
    }

    /// The same from the slopes of the places.
    pub(crate) fn slopes_of(&self, of_places: &[R]) -> Vec<[f32; 2]> {
        let mut slopes = vec![[0.0; 2]; self.network.vertex_count()];
        parallel::update_blocks(&mut slopes, NONE, |first, slopes, []| {
            let found = self.network.at_vertices(first..first + slopes.len(), of_places);
            for (slopes, found) in slopes.iter_mut().zip(found) {
                *slopes = found.map(|slope| slope.to_f64().clamp(-STEEPEST, STEEPEST) as f32);
            }
            0.0
        });
        slopes
    }

    /// [`Problem::slopes`], place by place.
    pub(crate) fn place_slopes(&self, x: &[R]) -> Vec<R> {
        let mut slopes = vec![R::default(); self.network.vertices().len()];
        parallel::update_blocks(&mut slopes, NONE, |first, slopes, []| {
            self.strips(x, first..first + slopes.len(), |strip, places| {
                for n in (0..places.len()).step_by(LANES) {
                    let values = strip.slopes(n + REPEATED);
                    let out = places.start - first + n;
                    let count = LANES.min(places.len() - n);
                    slopes[out..out + count].copy_from_slice(&values[..count]);
                }
            });
            0.0
        });
        slopes
    }

    /// Weighs each place by a power of the share `1 − n_p²` of its vertex for its curve, and by
    /// nothing where its curve ends. A measure that looks at the next two vertices stands between its
    /// own vertex and the next. See [`Problem::straightness`] for the rest.
    pub(super) fn set_weights(&mut self, shares: &[[R; 2]], straightness: &[[f32; 2]]) {
        let (network, lengths) = (self.network, &self.lengths);
        let steps = network.steps();
        for part in &mut self.parts {
            let (exponent, support) = (part.measure.meusnier_exponent(), part.measure.support());
            let exponent = match self.creases {
                Some(_) => exponent.min(crease::MEUSNIER_EXPONENT),
                None => exponent,
            };
            let (weight, factors) = (R::from_f64(part.weight), part.factors.as_deref());
            parallel::update_blocks(&mut part.weights, NONE, |first, weights, []| {
                let end = first + weights.len();
                let after = end.min(steps.len() - 1);
                let next = steps[first + 1..=after].iter().chain(&steps[after..end]);
                let of_next = network.at_places(first + 1..after + 1, shares);
                let of_next = of_next.chain(network.at_places(after..end, shares));
                let mut is_linked = first > 0 && steps[first - 1].is_linked();
                let own = steps[first..end].iter().zip(network.at_places(first..end, shares));
                let factor = |n: usize| match factors {
                    Some(factors) => factors[network.vertices()[first + n] as usize],
                    None => 1.0,
                };
                let straight = |n: usize, step: &Step| {
                    let v = network.vertices()[(first + n).min(steps.len() - 1)] as usize;
                    straightness.get(v).map_or(1.0, |weights| weights[step.curve()])
                };
                for (n, ((step, shares), (next, of_next))) in own.zip(next.zip(of_next)).enumerate()
                {
                    let was_linked = std::mem::replace(&mut is_linked, step.is_linked());
                    let (mut share, mut is_whole) = (shares[step.curve()], was_linked && is_linked);
                    let mut factor = factor(n) * straight(n, step);
                    if support == Support::NextTwo {
                        factor *= straight(n + 1, next);
                        share = R::from_f64(0.5) * (share + of_next[next.curve()]);
                        is_whole &= next.is_linked();
                    }
                    let full = weight
                        * R::from_f64(f64::from(factor))
                        * power_of_root(share, exponent)
                        * lengths.between_planes(step.normal());
                    weights[n] = if is_whole { full } else { R::default() };
                }
                0.0
            });
        }
    }

    /// By what both places of every vertex count less for the creases there; nothing without creases.
    fn straightness(&self, x: &[R]) -> Vec<[f32; 2]> {
        let Some(creases) = self.creases else { return Vec::new() };
        let of_places = self.mark_places(x, |_, cosine| creases.weight(cosine));
        let of_vertices = self.network.at_vertices(0..x.len(), &of_places);
        let with_thin = |(weights, &thin): ([f32; 2], &f32)| weights.map(|w| w.max(thin));
        of_vertices.zip(&self.thinness).map(with_thin).collect()
    }
}

/// The square root of `x` to a power.
pub(crate) fn power_of_root<R: Real>(x: R, exponent: f64) -> R {
    match exponent {
        0.0 => return R::from_f64(1.0),
        5.0 => return x * x * x.sqrt(),
        7.0 => return x * x * x * x.sqrt(),
        _ => {}
    }
    R::from_f64(x.to_f64().powf(0.5 * exponent))
}
