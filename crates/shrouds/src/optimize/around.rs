//! The energy as a function of the position of one vertex.

use std::ops::Add;

use crate::energy::{LANES, Lanes, Stencil};
use crate::optimize::barrier::Barrier;
use crate::optimize::problem::{Problem, WeightedPart};
use crate::optimize::real::Real;

/// The first lanes of the stencils on curves 0 and 1: the vertex is the last point of the first of
/// them, and so on.
const CURVES: [usize; 2] = [0, TERMS];
const TERMS: usize = LANES / 2;
/// Places on either side of a vertex that its terms depend on.
const REACH: usize = 3;
const PLACES: usize = 2 * REACH + 1;

/// The part of the energy that depends on one vertex.
pub(crate) struct Around<'a, R> {
    parts: &'a [WeightedPart<'a, R>],
    barrier: &'a Barrier,
    vertex: usize,
    /// Its places on both curves.
    places: [usize; 2],
    /// The stencils that the vertex is part of, seen from the low end of its grid edge.
    stencils: Stencil<Lanes<R>>,
}

/// A function of one position to second order.
#[derive(Clone, Copy, Default)]
pub(crate) struct Univariate {
    pub(crate) value: f64,
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
}

impl Add for Univariate {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
            curvature: self.curvature + other.curvature,
        }
    }
}

impl<R: Real> Around<'_, R> {
    /// Value, slope and Gauss–Newton curvature with the vertex at `x`.
    pub(crate) fn at(&mut self, x: R) -> Univariate {
        let Stencil { points, moves } = &mut self.stencils;
        for lane in CURVES {
            for n in 0..TERMS {
                for k in 0..2 {
                    let point = TERMS - 1 - n;
                    points[point][k][lane + n] = x * moves[point][k][lane + n];
                }
            }
        }
        let (slope, curvature) = self.barrier.slopes(self.vertex, x.to_f64());
        let value = self.barrier.value(self.vertex, x.to_f64());
        let mut sum = Univariate { value, slope, curvature };
        for part in self.parts {
            let weights = part.around(self.places);
            let term = R::terms(part.measure, &self.stencils);
            let [p, q] = &term.residual;
            let [a, b] = &term.slope.each_ref().map(by_the_vertex);
            let product = |u, v| R::weighted_sum(&weights, u, v);
            sum.value += product([p, q], [p, q]);
            sum.slope += 2.0 * product([p, q], [a, b]);
            sum.curvature += 2.0 * product([a, b], [a, b]);
        }
        sum
    }
}

/// Of the derivatives by the four vertices of each stencil those by the one in question.
#[inline(always)]
fn by_the_vertex<R: Real>(slopes: &[Lanes<R>; 4]) -> Lanes<R> {
    let mut own = slopes[0];
    for lane in CURVES {
        for n in 0..TERMS {
            own[lane + n] = slopes[TERMS - 1 - n][lane + n];
        }
    }
    own
}

impl<R: Real> WeightedPart<'_, R> {
    /// The weights of the terms that depend on the vertex with these places.
    #[inline(always)]
    fn around(&self, places: [usize; 2]) -> Lanes<R> {
        let mut weights = [R::default(); LANES];
        for (place, lane) in places.into_iter().zip(CURVES) {
            weights[lane..lane + TERMS].copy_from_slice(self.weights(place - 2..place + 2));
        }
        weights
    }
}

impl<R: Real> Problem<'_, R> {
    /// The energy as a function of the position of vertex `v` alone.
    pub(crate) fn around(&self, x: &[R], v: u32) -> Around<'_, R> {
        let zeros = [[[R::default(); LANES]; 2]; 4];
        let mut stencils = Stencil { points: zeros, moves: zeros };
        let places = [0, 1].map(|c| self.network.place(v, c));
        for (place, first) in places.into_iter().zip(CURVES) {
            let (points, moves) = self.polygon(x, place);
            for n in 0..TERMS {
                for m in 0..4 {
                    for k in 0..2 {
                        stencils.points[m][k][first + n] = points[n + m][k];
                        stencils.moves[m][k][first + n] = moves[n + m][k];
                    }
                }
            }
        }
        let (parts, barrier, vertex) = (&self.parts[..], &self.barrier, v as usize);
        Around { parts, barrier, vertex, places, stencils }
    }

    /// The vertices from some before a place to as many after it, seen from the start of its grid
    /// edge, and how they move.
    #[inline(always)]
    fn polygon(&self, x: &[R], place: usize) -> ([[R; 2]; PLACES], [[R; 2]; PLACES]) {
        let window = place - REACH..place + REACH + 1;
        let mut shifts = [[R::default(); 2]; PLACES];
        let (mut points, mut moves) = (shifts, shifts);
        for (n, step) in self.network.steps()[window.clone()].iter().enumerate() {
            [moves[n], shifts[n]] = self.lengths.of_step(*step);
        }
        for k in 0..2 {
            let mut starts = [R::default(); PLACES];
            for n in 0..REACH {
                starts[REACH + n + 1] = starts[REACH + n] + shifts[REACH + n][k];
                starts[REACH - n - 1] = starts[REACH - n] - shifts[REACH - n - 1][k];
            }
            for (n, x) in self.network.at_places(window.clone(), x).enumerate() {
                points[n][k] = starts[n] + x * moves[n][k];
            }
        }
        (points, moves)
    }
}
