//! The energy as a function of the position of one vertex.

use crate::energy::{CurveEnergy, LANES, Lanes, Stencil};
use crate::optimize::problem::{Barrier, Problem};
use crate::optimize::real::Real;

/// The first lanes of the stencils on curves 0 and 1: the vertex is the next one of the first, the
/// middle one of the second and the previous one of the third.
const CURVES: [usize; 2] = [0, LANES / 2];

/// The part of the energy that depends on one vertex.
pub(super) struct Around<'a, R> {
    energy: &'a dyn CurveEnergy,
    barrier: Barrier,
    /// The stencils that the vertex is part of, seen from the low end of its grid edge.
    stencils: Stencil<Lanes<R>>,
    weights: Lanes<R>,
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
        let Stencil { points, moves } = &mut self.stencils;
        for lane in CURVES {
            for n in 0..3 {
                for k in 0..2 {
                    points[2 - n][k][lane + n] = x * moves[2 - n][k][lane + n];
                }
            }
        }
        let term = R::terms(self.energy, &self.stencils);
        let [p, q] = &term.residual;
        let [a, b] = &term.slope.each_ref().map(by_the_vertex);
        let sum = |u, v| R::weighted_sum(&self.weights, u, v);
        let (slope, curvature) = self.barrier.slopes(x.to_f64());
        Univariate {
            value: sum([p, q], [p, q]) + self.barrier.value(x.to_f64()),
            slope: 2.0 * sum([p, q], [a, b]) + slope,
            curvature: 2.0 * sum([a, b], [a, b]) + curvature,
        }
    }
}

/// Of the derivatives by the three vertices of each stencil those by the one in question.
#[inline(always)]
fn by_the_vertex<R: Real>([previous, own, next]: &[Lanes<R>; 3]) -> Lanes<R> {
    let mut slopes = *previous;
    for lane in CURVES {
        (slopes[lane], slopes[lane + 1]) = (next[lane], own[lane + 1]);
    }
    slopes
}

impl<R: Real> Problem<'_, R> {
    /// The energy as a function of the position of vertex `v` alone.
    pub(super) fn around(&self, x: &[R], v: u32) -> Around<'_, R> {
        let [zeros, ones, twos] = [0.0, 1.0, 2.0].map(|x| [R::from_f64(x); LANES]);
        // Lanes without weight hold a straight polygon: finite numbers.
        let points = [[zeros; 2], [ones, zeros], [twos, zeros]];
        let mut stencils = Stencil { points, moves: [[zeros; 2]; 3] };
        let mut weights = zeros;
        for (c, first) in CURVES.into_iter().enumerate() {
            let place = self.network.place(v, c);
            let (points, moves) = self.polygon(x, place);
            for n in 0..3 {
                let lane = first + n;
                weights[lane] = self.weight(place - 1 + n);
                for m in 0..3 {
                    for k in 0..2 {
                        stencils.points[m][k][lane] = points[n + m][k];
                        stencils.moves[m][k][lane] = moves[n + m][k];
                    }
                }
            }
        }
        Around { energy: self.energy, barrier: self.barrier, stencils, weights }
    }

    /// The vertices from two before a place to two after it, seen from the start of its grid edge, and
    /// how they move.
    #[inline(always)]
    fn polygon(&self, x: &[R], place: usize) -> ([[R; 2]; 5], [[R; 2]; 5]) {
        let window = place - 2..place + 3;
        let mut shifts = [[R::default(); 2]; 5];
        let (mut points, mut moves) = (shifts, shifts);
        for (n, step) in self.network.steps()[window.clone()].iter().enumerate() {
            [moves[n], shifts[n]] = self.lengths.of_step(*step);
        }
        let [a, b, c, d, _] = shifts;
        for k in 0..2 {
            let starts = [-(a[k] + b[k]), -b[k], R::default(), c[k], c[k] + d[k]];
            for (n, x) in self.network.at_places(window.clone(), x).enumerate() {
                points[n][k] = starts[n] + x * moves[n][k];
            }
        }
        (points, moves)
    }
}
