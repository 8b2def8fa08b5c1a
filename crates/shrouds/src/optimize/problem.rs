//! The energy of all planar curves as a function of the positions along the grid edges.

use crate::energy::{CurveEnergy, Point2, Stencil};
use crate::grid::Grid;
use crate::network::{Link, Network};
use crate::parallel;
use crate::vector::tangent;

/// Largest barrier strength, and the least weight factor `1 − n_p²`.
const BARRIER_CAP: f64 = 0.01;
const LEAST_WEIGHT: f64 = 1e-4;

/// The function to minimise. Weights and barrier depend on the surface; they are frozen while
/// solving and refreshed by [`Problem::freeze`]. Lengths are in units of the smallest spacing.
pub(super) struct Problem<'a> {
    pub(super) network: &'a Network,
    energy: &'a dyn CurveEnergy,
    spacing: [f64; 3],
    pub(super) bounds: [f64; 2],
    /// Weight of ρ at each vertex on both of its curves; 0 where a neighbour is missing.
    weights: Vec<[f64; 2]>,
    /// Strength μ of the barrier.
    barrier: f64,
}

/// A function of the three vertices of a stencil to second order (Gauss–Newton).
#[derive(Clone, Copy, Default)]
pub(super) struct Quadratic {
    pub(super) value: f64,
    pub(super) gradient: [f64; 3],
    pub(super) hessian: [[f64; 3]; 3],
}

/// A function of one position to second order.
#[derive(Clone, Copy, Default)]
pub(super) struct Univariate {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl<'a> Problem<'a> {
    /// The problem with weights as if every slice cut the surface at a right angle, and no barrier.
    pub(super) fn new(
        grid: &Grid,
        network: &'a Network,
        energy: &'a dyn CurveEnergy,
        bounds: [f64; 2],
    ) -> Self {
        let spacing = grid.spacing().map(|h| h / grid.min_spacing());
        let mut problem =
            Self { network, energy, spacing, bounds, weights: Vec::new(), barrier: 0.0 };
        problem.weights = vec![[0.0; 2]; network.vertex_count()];
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
            let spacing = self.spacing;
            self.set_weights(|v| {
                sines_squared(network, spacing, x, v)
                    .map(|s| s.max(LEAST_WEIGHT).powf(0.5 * exponent))
            });
        }
        let strength = self.energy.barrier();
        if strength != 0.0 {
            self.barrier = 0.0;
            let mean = self.value(x) / self.vertex_count().max(1) as f64;
            self.barrier = (strength * mean).min(BARRIER_CAP);
        }
    }

    /// Weighs each curve by a factor of the vertex and by the distance to the next slice of its
    /// family, so that the sum over slices is an integral.
    fn set_weights(&mut self, factors: impl Fn(u32) -> [f64; 2] + Sync) {
        let (network, spacing) = (self.network, self.spacing);
        parallel::fill(&mut self.weights, |v| {
            let v = v as u32;
            let factors = factors(v);
            [0, 1].map(|c| {
                let whole = (2 * c..2 * c + 2).all(|slot| network.neighbour(v, slot).is_some());
                let (normal, _) = network.curve_axes(v, c);
                if whole { factors[c] * spacing[normal] } else { 0.0 }
            })
        });
    }

    /// The energy at `x`, barrier included.
    pub(super) fn value(&self, x: &[f64]) -> f64 {
        parallel::sum(x.len(), |v| {
            let rho = |c: usize| match self.weights[v][c] {
                0.0 => 0.0,
                w => w * self.energy.rho(&self.stencil(x, v as u32, c).0.points),
            };
            rho(0) + rho(1) + self.barrier(x[v]).value
        })
    }

    /// ρ of vertex `v` on its curve `c`, weighted, with respect to the positions of the previous
    /// vertex, of `v` and of the next one.
    pub(super) fn term(&self, x: &[f64], v: u32, c: usize) -> Quadratic {
        let weight = self.weights[v as usize][c];
        if weight == 0.0 {
            return Quadratic::default();
        }
        let (stencil, edge_lengths) = self.stencil(x, v, c);
        let mut term = self.energy.term(&stencil);
        let mut quadratic = Quadratic::default();
        for (residual, slope) in term.residual.iter().zip(&mut term.slope) {
            for (s, length) in slope.iter_mut().zip(edge_lengths) {
                *s *= length;
            }
            quadratic.value += weight * residual * residual;
            for i in 0..3 {
                quadratic.gradient[i] += 2.0 * weight * residual * slope[i];
                for j in 0..3 {
                    quadratic.hessian[i][j] += 2.0 * weight * slope[i] * slope[j];
                }
            }
        }
        quadratic
    }

    /// The barrier of one vertex.
    pub(super) fn barrier(&self, x: f64) -> Univariate {
        if self.barrier == 0.0 {
            return Univariate::default();
        }
        let (low, high) = (1.0 / x, 1.0 / (1.0 - x));
        Univariate {
            value: -self.barrier * (4.0 * x * (1.0 - x)).ln(),
            slope: self.barrier * (high - low),
            curvature: self.barrier * (low * low + high * high),
        }
    }

    /// Whether the barrier keeps steps from reaching the bounds.
    pub(super) fn has_barrier(&self) -> bool {
        self.barrier > 0.0
    }

    /// Everything in the energy that depends on the position of vertex `v`.
    pub(super) fn around(&self, x: &[f64], v: u32) -> Univariate {
        let mut sum = self.barrier(x[v as usize]);
        let mut add = |term: Quadratic, place: usize| {
            sum.value += term.value;
            sum.slope += term.gradient[place];
            sum.curvature += term.hessian[place][place];
        };
        for c in 0..2 {
            add(self.term(x, v, c), 1);
        }
        for slot in 0..4 {
            if let Some((u, link)) = self.network.neighbour(v, slot) {
                let back = link.back_slot(slot);
                add(self.term(x, u, back / 2), 2 * (back % 2));
            }
        }
        sum
    }

    /// Smallest squared length of the chords at vertex `v`.
    pub(super) fn shortest_chord_squared(&self, x: &[f64], v: u32) -> f64 {
        let own = x[v as usize] * self.spacing[self.network.axis(v)];
        (0..4)
            .filter_map(|slot| neighbour_point(self.network, self.spacing, x, v, slot))
            .map(|(p, _, _)| (p[0] - own).powi(2) + p[1] * p[1])
            .fold(f64::INFINITY, f64::min)
    }

    /// The vertices around `v` on curve `c`, in the coordinates (along the grid edge of `v`, across
    /// it) of the curve's plane, and the lengths of the grid edges of the three.
    fn stencil(&self, x: &[f64], v: u32, c: usize) -> (Stencil, [f64; 3]) {
        let h = self.spacing[self.network.axis(v)];
        let own = ([x[v as usize] * h, 0.0], 0, h);
        let side = |slot| neighbour_point(self.network, self.spacing, x, v, slot).unwrap_or(own);
        let all = [side(2 * c), own, side(2 * c + 1)];
        (Stencil { points: all.map(|p| p.0), moves: all.map(|p| p.1) }, all.map(|p| p.2))
    }
}

/// The neighbour of `v` in a slot, in the coordinates (along the grid edge of `v`, across it) from
/// the low end of that edge; the coordinate it moves along; the length of its grid edge.
fn neighbour_point(
    network: &Network,
    spacing: [f64; 3],
    x: &[f64],
    v: u32,
    slot: usize,
) -> Option<(Point2, usize, f64)> {
    let (u, link) = network.neighbour(v, slot)?;
    let (_, across_axis) = network.curve_axes(v, slot / 2);
    let (along, across) = (spacing[network.axis(v)], spacing[across_axis]);
    let (x, high_side) = (x[u as usize], slot % 2 == 1);
    let sideways = if high_side { x * across } else { (x - 1.0) * across };
    Some(match link {
        Link::Parallel => ([x * along, if high_side { across } else { -across }], 0, along),
        Link::AcrossLow => ([0.0, sideways], 1, across),
        Link::AcrossHigh => ([along, sideways], 1, across),
    })
}

/// `1 − n_p²` for the planes of both curves of vertex `v`, `n` being the cross product of the
/// curves' tangents.
fn sines_squared(network: &Network, spacing: [f64; 3], x: &[f64], v: u32) -> [f64; 2] {
    let own = [x[v as usize] * spacing[network.axis(v)], 0.0];
    let [a, b] = [0, 1].map(|c| {
        let chord_to = |slot, sign: f64| {
            neighbour_point(network, spacing, x, v, slot)
                .map(|(p, _, _)| [sign * (p[0] - own[0]), sign * (p[1] - own[1])])
        };
        // A curve of one vertex has no direction; its weight is 0 anyway.
        tangent(chord_to(2 * c, -1.0), chord_to(2 * c + 1, 1.0)).unwrap_or([0.0, 1.0])
    });
    // In the frame (along the grid edge, across on curve 0, across on curve 1).
    let normal = [a[1] * b[1], -a[0] * b[1], -a[1] * b[0]];
    let squared = normal.map(|n| n * n);
    let length = squared.iter().sum::<f64>();
    [(squared[0] + squared[1]) / length, (squared[0] + squared[2]) / length]
}
