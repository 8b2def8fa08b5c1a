//! The energy of all planar curves as a function of the positions along the grid edges.

use std::ops::Range;

use crate::energy::{CurveEnergy, Lanes, Term};
use crate::network::{Network, REPEATED};
use crate::optimize::strip::{SHORT, STRIP, StepTable, Strip, WIDTH};
use crate::parallel::{self, NONE};
use crate::surface::Surface;
use crate::vector::{Vector, add, cross, dot, subtract};

/// Largest barrier strength, and the least weight factor `1 − n_p²`.
const BARRIER_CAP: f64 = 0.01;
const LEAST_WEIGHT: f64 = 1e-4;

/// The function to minimise. Weights and barrier depend on the surface; they are frozen while
/// solving and refreshed by [`Problem::freeze`]. Lengths are in units of the smallest spacing.
pub(super) struct Problem<'a> {
    pub(super) surface: &'a Surface,
    pub(super) network: &'a Network,
    energy: &'a dyn CurveEnergy,
    spacing: [f64; 3],
    table: StepTable,
    pub(super) bounds: [f64; 2],
    /// Weight of ρ at each vertex on both of its curves, but for the distance of the slices; 0 where
    /// a neighbour is missing.
    weights: Vec<[f32; 2]>,
    /// Strength μ of the barrier.
    barrier: f64,
}

/// A function of one position to second order.
#[derive(Clone, Copy, Default)]
pub(super) struct Univariate {
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl<'a> Problem<'a> {
    /// The problem with weights as if every slice cut the surface at a right angle, and no barrier.
    pub(super) fn new(
        surface: &'a Surface,
        network: &'a Network,
        energy: &'a dyn CurveEnergy,
        bounds: [f64; 2],
    ) -> Self {
        let grid = surface.grid();
        let spacing = grid.spacing().map(|h| h / grid.min_spacing());
        let weights = vec![[0.0; 2]; network.vertex_count()];
        let table = StepTable::new(spacing);
        let mut problem =
            Self { surface, network, energy, spacing, table, bounds, weights, barrier: 0.0 };
        problem.set_weights(|_| [1.0; 2]);
        problem
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.network.vertex_count()
    }

    /// Whether weights or barrier depend on the surface.
    pub(super) fn needs_freezing(&self) -> bool {
        self.energy.meusnier_exponent() != 0.0 || self.energy.barrier() != 0.0
    }

    /// Sets the Meusnier weights, and the barrier from the energy they give, for the surface at `x`.
    pub(super) fn freeze(&mut self, x: &[f64]) {
        let exponent = self.energy.meusnier_exponent();
        if exponent != 0.0 {
            let network = self.network;
            if std::env::var("PATCHN").is_ok() {
            let normals = patch_normals(self.surface, self.spacing, x);
            self.set_weights(|v| {
                let normal = normals[v as usize];
                let squared = dot(normal, normal).max(f64::MIN_POSITIVE);
                [0, 1].map(|c| {
                    let along = normal[network.curve_axes(v, c).0];
                    power_of_root((1.0 - along * along / squared).max(LEAST_WEIGHT), exponent)
                })
            });
            } else {
            // With slopes s of the two curves over the grid edge's ends, the normal is (−1, s₁, s₀)
            // along the edge and the normals of curves 0 and 1.
            let slopes = self.squared_slopes(x);
            self.set_weights(|v| {
                let slopes = [0, 1].map(|c| slopes[network.place(v, c)]);
                slopes.map(|own| {
                    let share = (1.0 + own) / (1.0 + slopes[0] + slopes[1]);
                    power_of_root(f64::from(share).max(LEAST_WEIGHT), exponent)
                })
            });
            }
        }
        let strength = self.energy.barrier();
        if strength != 0.0 {
            self.barrier = 0.0;
            let mean = self.value(x) / self.vertex_count().max(1) as f64;
            self.barrier = (strength * mean).min(BARRIER_CAP);
        }
    }

    /// The squared slope of the curve's tangent over its grid edge at every place: how far it runs
    /// along the edge for each unit across. The tangent is that of the circle through three vertices.
    fn squared_slopes(&self, x: &[f64]) -> Vec<f32> {
        let mut slopes = vec![0.0; self.network.vertices().len()];
        parallel::update_blocks(&mut slopes, NONE, |first, slopes, []| {
            self.strips(x, first..first + slopes.len(), |strip, places| {
                for n in (0..places.len()).step_by(WIDTH) {
                    let ([before, after], moves) = strip.chords_around(n + REPEATED);
                    let values: [f32; WIDTH] = std::array::from_fn(|l| {
                        let [a, b] = [before, after].map(|c| [c[0][l], c[1][l]]);
                        let [wa, wb] = [a, b].map(|c| 1.0 / (c[0] * c[0] + c[1] * c[1]));
                        let tangent = [0, 1].map(|k| wa * a[k] + wb * b[k]);
                        let second = moves[0][l] == 0.0;
                        let (along, across) = if second { (tangent[1], tangent[0]) } else { (tangent[0], tangent[1]) };
                        (along * along / (across * across)) as f32
                    });
                    let out = places.start - first + n;
                    let count = WIDTH.min(places.len() - n);
                    slopes[out..out + count].copy_from_slice(&values[..count]);
                }
            });
            0.0
        });
        slopes
    }

    /// Weighs each place by a factor of its vertex, and by nothing where its curve ends.
    fn set_weights(&mut self, factors: impl Fn(u32) -> [f64; 2] + Sync) {
        let network = self.network;
        parallel::fill(&mut self.weights, |v| {
            let v = v as u32;
            let factors = factors(v);
            [0, 1].map(|c| {
                let place = network.place(v, c);
                let within = network.steps()[place - 1..=place].iter().all(|s| s.is_linked());
                if within { factors[c] as f32 } else { 0.0 }
            })
        });
    }

    /// The weight of ρ at a place, by the distance to the next slice of its family too, so that the
    /// sum over slices is an integral.
    #[inline]
    fn weight(&self, place: usize) -> f64 {
        let step = self.network.steps()[place];
        let v = self.network.vertices()[place];
        f64::from(self.weights[v as usize][step.curve()]) * self.spacing[step.normal()]
    }

    /// The energy at `x`, barrier included.
    pub(super) fn value(&self, x: &[f64]) -> f64 {
        let places = self.network.vertices().len();
        let curves = parallel::sum_blocks(places, |range| {
            let mut rho = vec![0.0; range.len()];
            self.strips(x, range.clone(), |strip, places| {
                for n in (0..places.len()).step_by(WIDTH) {
                    let values = self.energy.rhos(&strip.points(n + REPEATED));
                    for (l, place) in places.clone().skip(n).take(WIDTH).enumerate() {
                        rho[place - range.start] = self.weight(place) * values[l];
                    }
                }
            });
            self.sum_over_curves(range, &rho)
        });
        curves + self.barrier_value(x)
    }

    /// The sum of the values of a range of places, those that repeat others left out.
    pub(super) fn sum_over_curves(&self, range: Range<usize>, values: &[f64]) -> f64 {
        let first = range.start;
        let sum = |part: Range<usize>| {
            values[part.start - first..part.end - first].iter().sum::<f64>()
        };
        self.network.curve_parts(range).map(sum).sum()
    }

    /// The barrier of all vertices.
    pub(super) fn barrier_value(&self, x: &[f64]) -> f64 {
        if self.barrier == 0.0 {
            return 0.0;
        }
        // One logarithm for several factors: their product stays far from the smallest number.
        const FACTORS: usize = 16;
        let logarithms = parallel::sum_blocks(x.len(), |range| {
            let logarithm = |x: &[f64]| {
                x.iter().map(|x| 4.0 * x * (1.0 - x)).product::<f64>().ln()
            };
            x[range].chunks(FACTORS).map(logarithm).sum()
        });
        -self.barrier * logarithms
    }

    /// Calls `f` with all strips of the places in `range`, but for the very first and last places of
    /// all, which only repeat others.
    pub(super) fn strips(
        &self,
        x: &[f64],
        range: Range<usize>,
        mut f: impl FnMut(&Strip, Range<usize>),
    ) {
        let total = self.network.vertices().len();
        let end = range.end.min(total - REPEATED);
        let mut strip = Strip::new();
        for start in (range.start.max(REPEATED)..end).step_by(STRIP) {
            let places = start..end.min(start + STRIP);
            let count = places.len() + 2 * REPEATED;
            strip.load(self.network, &self.table, x, start - REPEATED, count);
            f(&strip, places);
        }
    }

    /// ρ and its derivatives at four places of a strip.
    #[inline]
    pub(super) fn terms<const LENGTH: usize>(&self, strip: &Strip<LENGTH>, n: usize) -> Term<Lanes> {
        self.energy.terms(&strip.stencils(n))
    }

    /// Doubled weights of all places in a range.
    pub(super) fn doubled_weights(&self, range: Range<usize>, out: &mut [f64]) {
        for (place, weight) in range.zip(out) {
            *weight = 2.0 * self.weight(place);
        }
    }

    /// The barrier at one position.
    fn barrier(&self, x: f64) -> f64 {
        if self.barrier == 0.0 { 0.0 } else { -self.barrier * (4.0 * x * (1.0 - x)).ln() }
    }

    /// Slope and curvature of the barrier at one position.
    pub(super) fn barrier_slope(&self, x: f64) -> Univariate {
        let (low, high) = (1.0 / x, 1.0 / (1.0 - x));
        Univariate {
            slope: self.barrier * (high - low),
            curvature: self.barrier * (low * low + high * high),
        }
    }

    /// Whether the barrier keeps steps from reaching the bounds.
    pub(super) fn has_barrier(&self) -> bool {
        self.barrier > 0.0
    }

    /// The places around vertex `v` on its curve `c`, two to either side.
    fn surroundings(&self, x: &[f64], v: u32, c: usize) -> (Strip<SHORT>, [f64; 3]) {
        let place = self.network.place(v, c);
        let mut strip = Strip::new();
        strip.load(self.network, &self.table, x, place - 2, 5);
        (strip, [place - 1, place, place + 1].map(|place| self.weight(place)))
    }

    /// Slope and curvature of the energy in the position of vertex `v`.
    pub(super) fn slope_around(&self, x: &[f64], v: u32) -> Univariate {
        let mut sum = self.barrier_slope(x[v as usize]);
        for c in 0..2 {
            let (strip, weights) = self.surroundings(x, v, c);
            let terms = self.terms(&strip, 1);
            for (lane, weight) in weights.into_iter().enumerate().filter(|(_, w)| *w > 0.0) {
                for (residual, slopes) in terms.residual.iter().zip(&terms.slope) {
                    let slope = slopes[2 - lane][lane];
                    sum.slope += 2.0 * weight * residual[lane] * slope;
                    sum.curvature += 2.0 * weight * slope * slope;
                }
            }
        }
        sum
    }

    /// The part of the energy that depends on the position of vertex `v`.
    pub(super) fn value_around(&self, x: &[f64], v: u32) -> f64 {
        let on_curve = |c: usize| -> f64 {
            let (strip, weights) = self.surroundings(x, v, c);
            let values = self.energy.rhos(&strip.points(1));
            let weighted = |(l, w): (usize, f64)| if w > 0.0 { w * values[l] } else { 0.0 };
            weights.into_iter().enumerate().map(weighted).sum()
        };
        on_curve(0) + on_curve(1) + self.barrier(x[v as usize])
    }

    /// For every place of a range whether `bad` holds for the squared lengths of the chords before
    /// and after it and the cosine between them.
    pub(super) fn mark_places(
        &self,
        x: &[f64],
        range: Range<usize>,
        mut mark: impl FnMut(usize, f64, f64),
    ) {
        self.strips(x, range, |strip, places| {
            for n in (0..places.len()).step_by(WIDTH) {
                let [before, _, after] = strip.points(n + REPEATED);
                for (l, place) in places.clone().skip(n).take(WIDTH).enumerate() {
                    let [a, b] = [before, after].map(|p| [p[0][l], p[1][l]]);
                    let (l0, l1) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
                    let cosine = -(a[0] * b[0] + a[1] * b[1]) / (l0 * l1).sqrt();
                    mark(place, l0.min(l1), cosine);
                }
            }
        });
    }

    /// Whether the place counts in the energy.
    pub(super) fn counts(&self, place: usize) -> bool {
        self.weight(place) > 0.0
    }
}

/// The square root of `x` to a power.
fn power_of_root(x: f64, exponent: f64) -> f64 {
    let root = x.sqrt();
    if exponent.fract() == 0.0 { root.powi(exponent as i32) } else { root.powf(exponent) }
}

/// Normal of the surface at every vertex, of any length: the sum of the area vectors of its patches.
fn patch_normals(surface: &Surface, spacing: [f64; 3], x: &[f64]) -> Vec<Vector> {
    let crossings: Vec<_> = surface.crossings().collect();
    let position = |v: u32| {
        let crossing = crossings[v as usize];
        let mut point = crossing.low().map(|i| i as f64);
        point[crossing.axis()] += x[v as usize];
        std::array::from_fn(|k| point[k] * spacing[k])
    };
    let mut normals = vec![[0.0; 3]; x.len()];
    let mut add_patch = |patch: &[u32], _: &_| {
        let origin = position(patch[0]);
        let fan = patch[1..].windows(2).fold([0.0; 3], |sum, pair| {
            let [a, b] = [pair[0], pair[1]].map(|v| subtract(position(v), origin));
            add(sum, cross(a, b))
        });
        for &v in patch {
            normals[v as usize] = add(normals[v as usize], fan);
        }
    };
    (0..surface.layer_count()).for_each(|k| surface.for_each_patch(k, &mut add_patch));
    normals
}
