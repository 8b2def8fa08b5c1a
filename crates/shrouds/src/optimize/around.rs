//! The energy as a function of the position of one vertex.

use crate::energy::{CurveEnergy, LANES};
use crate::optimize::problem::{Barrier, Problem};
use crate::optimize::real::Real;
use crate::optimize::strip::Strip;

/// Where the places two before a vertex on its curves 0 and 1 stand in the strip around it. The
/// three terms of each that depend on the vertex are the first and last lanes from index 1 on.
const WINDOWS: [usize; 2] = [0, LANES - 3];

/// The part of the energy that depends on one vertex.
pub(super) struct Around<'a, R> {
    energy: &'a dyn CurveEnergy,
    barrier: Barrier,
    strip: Strip<R, { LANES + 4 }>,
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
        WINDOWS.iter().for_each(|at| self.strip.move_to(at + 2, x));
        let term = R::terms(self.energy, &self.strip.stencils(1));
        let weights = self.strip.weights(1);
        let mut sum = Univariate::default();
        let ([p, q], [a, b]) = (term.residual, term.slope);
        for at in WINDOWS {
            for n in 0..3 {
                let lane = at + n;
                if weights[lane] <= R::default() {
                    continue;
                }
                // The vertex is the next of the place before it, and so on.
                let (a, b) = (a[2 - n][lane].to_f64(), b[2 - n][lane].to_f64());
                let (p, q, weight) = (p[lane].to_f64(), q[lane].to_f64(), weights[lane].to_f64());
                sum.value += weight * (p * p + q * q);
                sum.slope += 2.0 * weight * (p * a + q * b);
                sum.curvature += 2.0 * weight * (a * a + b * b);
            }
        }
        let (slope, curvature) = self.barrier.slopes(x.to_f64());
        Univariate {
            value: sum.value + self.barrier.value(x.to_f64()),
            slope: sum.slope + slope,
            curvature: sum.curvature + curvature,
        }
    }
}

impl<R: Real> Problem<'_, R> {
    /// The energy as a function of the position of vertex `v` alone.
    pub(super) fn around(&self, x: &[R], v: u32) -> Around<'_, R> {
        let mut strip = Strip::new();
        for (c, at) in WINDOWS.into_iter().enumerate() {
            let place = self.network.place(v, c);
            self.load(&mut strip, x, at, place - 2..place + 3, true);
        }
        Around { energy: self.energy, barrier: self.barrier, strip }
    }
}
