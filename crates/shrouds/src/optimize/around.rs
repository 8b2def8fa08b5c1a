//! The energy as a function of the position of one vertex.

use crate::energy::LANES;
use crate::optimize::barrier::Barrier;
use crate::optimize::problem::{Problem, WeightedPart};
use crate::optimize::real::Real;
use crate::optimize::strip::Strip;

/// Places on either side of a vertex that its terms depend on.
const REACH: usize = 3;
/// The terms on one curve that depend on a vertex: those of the two places before it, of its own and
/// the next. The lanes hold those of both curves.
const TERMS: usize = LANES / 2;
/// Places that a strip around a vertex holds, and what the last lanes read beyond.
const LONG: usize = 2 * REACH + 1 + LANES;

/// The part of the energy that depends on one vertex.
pub(super) struct Around<'a, R> {
    parts: &'a [WeightedPart<'a, R>],
    barrier: &'a Barrier,
    vertex: usize,
    /// Its places on both curves.
    places: [usize; 2],
    strips: [Strip<R, LONG>; 2],
}

/// A function of one position to second order.
#[derive(Clone, Copy, Default)]
pub(super) struct Univariate {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl<R: Real> Around<'_, R> {
    /// Value, slope and Gauss–Newton curvature with the vertex at `x`.
    pub(super) fn at(&mut self, x: R) -> Univariate {
        self.strips.iter_mut().for_each(|strip| strip.move_to(REACH, x));
        let [first, second] = self.strips.each_ref().map(|strip| strip.stencils(1));
        let stencils = first.zip(&second, |a, b| {
            let mut lanes = a;
            lanes[TERMS..].copy_from_slice(&b[..TERMS]);
            lanes
        });
        let mut sum = Univariate::default();
        for part in self.parts {
            let term = R::terms(part.measure, &stencils);
            let ([p, q], [a, b]) = (term.residual, term.slope);
            for (curve, place) in self.places.into_iter().enumerate() {
                for (n, weight) in part.weights(place - 2..place + 2).iter().enumerate() {
                    let (lane, weight) = (curve * TERMS + n, weight.to_f64());
                    if weight <= 0.0 {
                        continue;
                    }
                    // The vertex is the last of the stencil two places before it, and so on.
                    let (a, b) = (a[3 - n][lane].to_f64(), b[3 - n][lane].to_f64());
                    let (p, q) = (p[lane].to_f64(), q[lane].to_f64());
                    sum.value += weight * (p * p + q * q);
                    sum.slope += 2.0 * weight * (p * a + q * b);
                    sum.curvature += 2.0 * weight * (a * a + b * b);
                }
            }
        }
        let (slope, curvature) = self.barrier.slopes(self.vertex, x.to_f64());
        Univariate {
            value: sum.value + self.barrier.value(self.vertex, x.to_f64()),
            slope: sum.slope + slope,
            curvature: sum.curvature + curvature,
        }
    }
}

impl<R: Real> Problem<'_, R> {
    /// The energy as a function of the position of vertex `v` alone.
    pub(super) fn around(&self, x: &[R], v: u32) -> Around<'_, R> {
        let places = [0, 1].map(|c| self.network.place(v, c));
        let strips = places.map(|place| {
            let mut strip = Strip::new();
            self.load(&mut strip, x, 0, place - REACH..place + REACH + 1);
            strip
        });
        Around { parts: &self.parts, barrier: &self.barrier, vertex: v as usize, places, strips }
    }
}
