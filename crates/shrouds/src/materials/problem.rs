//! The energy of all planar curves and how it changes with the unknowns.
//!
//! A crossing moves along its grid edge, by `x` from the low end; a junction point moves in its face,
//! by two numbers from the lowest corner along the two axes. All are in edge lengths and lie between
//! 0 and 1. Every curve is summed over its crossings: junctions are the free ends of curves.

use std::sync::Arc;

use crate::energy::{CurveEnergy, LANES, Lanes, Stencil, Support};
use crate::materials::interfaces::{Interfaces, across};
use crate::materials::network::{JUNCTION, Network, normal};
use crate::parallel::{self, NONE};

/// The least Meusnier weight, before powers.
const LEAST_SHARE: f32 = 1e-4;
/// The steepest slope over a grid edge that is told apart.
const STEEPEST: f64 = 1e6;

/// One measure on the curves of a volume.
pub(super) struct Problem<'a> {
    interfaces: &'a Interfaces,
    pub(super) network: &'a Network,
    measure: Arc<dyn CurveEnergy>,
    /// Distances of lattice points in units of the smallest.
    spacing: [f64; 3],
    /// Of every place; 0 where the stencil lacks a point.
    weights: Vec<f32>,
}

/// The residuals at a place and their derivatives by the first unknowns of the four points, all with
/// the root of the weight.
#[derive(Clone, Copy, Default)]
pub(super) struct Row {
    pub(super) residual: [f32; 2],
    pub(super) slope: [[f32; 4]; 2],
}

impl Row {
    pub(super) fn energy(&self) -> f32 {
        let [a, b] = self.residual;
        a * a + b * b
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        interfaces: &'a Interfaces,
        network: &'a Network,
        measure: Arc<dyn CurveEnergy>,
    ) -> Self {
        let unit = interfaces.grid().min_spacing();
        let spacing = interfaces.grid().spacing().map(|spacing| spacing / unit);
        let weights = vec![1.0; network.beside.len()];
        Self { interfaces, network, measure, spacing, weights }
    }

    pub(super) fn measure(&self) -> &dyn CurveEnergy {
        &*self.measure
    }

    /// Where a point lies in the plane normal to an axis, and how it moves with its unknown number
    /// `which`.
    #[inline]
    fn point(&self, point: u32, normal: usize, which: usize, x: &[f64]) -> ([f64; 2], [f64; 2]) {
        let axes = across(normal);
        let mut moves = [0.0; 2];
        if point & JUNCTION == 0 {
            let v = point as usize / 2;
            let crossing = self.interfaces.crossings()[v];
            let (low, own) = (crossing.low(), usize::from(crossing.axis() == axes[1]));
            let mut place = axes.map(|axis| low[axis] as f64);
            place[own] += x[v];
            moves[own] = self.spacing[axes[own]];
            ([place[0] * self.spacing[axes[0]], place[1] * self.spacing[axes[1]]], moves)
        } else {
            let junction = self.interfaces.junctions()[(point & !JUNCTION) as usize];
            let first = self.network.unknown(point);
            let coordinate = |n: usize| {
                (f64::from(junction.low[axes[n]]) + x[first + n]) * self.spacing[axes[n]]
            };
            moves[which] = self.spacing[axes[which]];
            ([coordinate(0), coordinate(1)], moves)
        }
    }

    /// The stencils of places side by side. Junctions move with their unknown number `which`.
    fn stencils(
        &self,
        places: impl Iterator<Item = usize>,
        which: usize,
        x: &[f64],
    ) -> Stencil<Lanes<f64>> {
        let zeros = [[[0.0; LANES]; 2]; 4];
        let mut stencils = Stencil { points: zeros, moves: zeros };
        let count = if self.measure.support() == Support::NextTwo { 4 } else { 3 };
        for (lane, place) in places.enumerate() {
            let normal = self.normal(place);
            let points = self.network.stencil(place);
            for (n, point) in points.into_iter().enumerate().take(count) {
                let (place, moves) = self.point(point, normal, which, x);
                for a in 0..2 {
                    stencils.points[n][a][lane] = place[a];
                    stencils.moves[n][a][lane] = moves[a];
                }
            }
        }
        stencils
    }

    #[inline]
    fn normal(&self, place: usize) -> usize {
        normal(self.interfaces.crossings()[place / 2].axis(), place)
    }

    /// The residuals and derivatives at all places. Returns the energy.
    pub(super) fn linearise(&self, x: &[f64], rows: &mut [Row]) -> f64 {
        parallel::update_blocks(rows, NONE, |first, rows, []| {
            let mut energy = 0.0;
            for (n, rows) in rows.chunks_mut(LANES).enumerate() {
                let start = first + n * LANES;
                let places = start..start + rows.len();
                let terms = self.measure.terms_double(&self.stencils(places, 0, x));
                for (lane, row) in rows.iter_mut().enumerate() {
                    let root = f64::from(self.weights[start + lane]).sqrt();
                    let at = |values: &Lanes<f64>| (root * values[lane]) as f32;
                    if root == 0.0 {
                        *row = Row::default();
                        continue;
                    }
                    let residual = [0, 1].map(|r| root * terms.residual[r][lane]);
                    energy += residual[0] * residual[0] + residual[1] * residual[1];
                    row.residual = residual.map(|r| r as f32);
                    row.slope = [0, 1].map(|r| [0, 1, 2, 3].map(|p| at(&terms.slope[r][p])));
                }
            }
            energy
        })
    }

    /// The derivatives by the second unknowns of the junctions, touch by touch.
    pub(super) fn linearise_touches(&self, x: &[f64], slopes: &mut [[f32; 2]]) {
        let touches = &self.network.touches;
        parallel::update_blocks(slopes, NONE, |first, slopes, []| {
            for (n, slopes) in slopes.chunks_mut(LANES).enumerate() {
                let start = first + n * LANES;
                let touches = &touches[start..start + slopes.len()];
                let places = touches.iter().map(|touch| touch.place as usize);
                let terms = self.measure.terms_double(&self.stencils(places, 1, x));
                for (lane, (slope, touch)) in slopes.iter_mut().zip(touches).enumerate() {
                    let weight = self.weights[touch.place as usize];
                    let root = f64::from(weight).sqrt();
                    let of = |r: usize| root * terms.slope[r][usize::from(touch.slot)][lane];
                    *slope = if weight > 0.0 { [of(0), of(1)].map(|s| s as f32) } else { [0.0; 2] };
                }
            }
            0.0
        });
    }

    /// Where the crossing of a place lies in a face, by the unknowns of the face's junction.
    pub(super) fn in_face(&self, place: usize, junction: usize, x: &[f64]) -> [f64; 2] {
        let junction = self.interfaces.junctions()[junction];
        let crossing = self.interfaces.crossings()[place / 2];
        let (low, from) = (crossing.low(), junction.low);
        junction.axes().map(|axis| {
            let along = if axis == crossing.axis() { x[place / 2] } else { 0.0 };
            low[axis] as f64 - f64::from(from[axis]) + along
        })
    }

    /// The energy at the places whose stencils have a crossing in them.
    pub(super) fn energy_around(&self, crossing: usize, x: &[f64]) -> f64 {
        let places = [2 * crossing, 2 * crossing + 1].map(|p| self.network.stencils_of(p));
        let last = if self.measure.support() == Support::NextTwo { 3 } else { 2 };
        let places = places.iter().flatten().flatten().filter(|(_, slot)| *slot <= last);
        places.map(|&(place, _)| self.energy_at(place, x)).sum()
    }

    fn energy_at(&self, place: usize, x: &[f64]) -> f64 {
        let weight = f64::from(self.weights[place]);
        if weight == 0.0 {
            return 0.0;
        }
        let normal = self.normal(place);
        let points = self.network.stencil(place).map(|point| self.point(point, normal, 0, x).0);
        weight * self.measure.rho(&points)
    }

    /// The chords before and after a place.
    pub(super) fn chords(&self, place: usize, x: &[f64]) -> [[f64; 2]; 2] {
        let normal = self.normal(place);
        let [before, own, after, _] = self.network.stencil(place);
        let [a, b, c] = [before, own, after].map(|point| self.point(point, normal, 0, x).0);
        [[b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]]
    }

    /// How far the tangent of a place's curve runs along its grid edge for each unit across it: that of
    /// the circle through three points.
    fn slope(&self, place: usize, x: &[f64]) -> f64 {
        let [a, b] = self.chords(place, x);
        let (wb, wa) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
        let tangent = [wa * a[0] + wb * b[0], wa * a[1] + wb * b[1]];
        let axis = self.interfaces.crossings()[place / 2].axis();
        let own = usize::from(across(self.normal(place))[1] == axis);
        tangent[own] / tangent[1 - own]
    }

    /// The slopes of both curves of every crossing over its grid edge, see
    /// [`Optimum`](crate::materials::Optimum).
    pub(super) fn slopes(&self, x: &[f64]) -> Vec<[f32; 2]> {
        let mut slopes = vec![[0.0; 2]; self.network.crossing_count()];
        parallel::fill(&mut slopes, |v| {
            [2 * v, 2 * v + 1].map(|place| self.slope(place, x).clamp(-STEEPEST, STEEPEST) as f32)
        });
        slopes
    }

    /// Sets the Meusnier weights for the interfaces at `x`.
    pub(super) fn freeze(&mut self, x: &[f64]) {
        // The normal is (−1, s₁, s₀) along the grid edge and the normals of the two planes.
        let mut shares = self.slopes(x);
        parallel::update(&mut shares, |_, shares| {
            let [a, b] = shares.map(|slope| slope * slope);
            let inverse = 1.0 / (1.0 + a + b);
            *shares = [(1.0 + a) * inverse, (1.0 + b) * inverse].map(|s| s.max(LEAST_SHARE));
        });
        let half = 0.5 * self.measure.meusnier_exponent();
        let needs_fourth = self.measure.support() == Support::NextTwo;
        let mut weights = std::mem::take(&mut self.weights);
        parallel::fill(&mut weights, |place| {
            let mut share = f64::from(shares[place / 2][place % 2]);
            if needs_fourth {
                if !self.network.has_fourth(place) {
                    return 0.0;
                }
                let next = self.network.beside[place][1] as usize;
                share = 0.5 * (share + f64::from(shares[next / 2][next % 2]));
            }
            (share.powf(half) * self.spacing[self.normal(place)]) as f32
        });
        self.weights = weights;
    }
}
