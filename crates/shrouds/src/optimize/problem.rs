//! The energy of all planar curves as a function of the positions along the grid edges.

use crate::energy::{CurveEnergy, Point2, Stencil};
use crate::network::{Link, Network};
use crate::parallel;
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
    pub(super) bounds: [f64; 2],
    /// Weight of ρ at each vertex on both of its curves; 0 where a neighbour is missing.
    weights: Vec<[f64; 2]>,
    /// Strength μ of the barrier.
    barrier: f64,
}

/// A function of the three vertices of a stencil to second order (Gauss–Newton).
#[derive(Clone, Copy, Default)]
pub(super) struct Quadratic {
    pub(super) gradient: [f64; 3],
    pub(super) hessian: [[f64; 3]; 3],
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
        let mut problem = Self { surface, network, energy, spacing, bounds, weights, barrier: 0.0 };
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
            let normals = patch_normals(self.surface, self.spacing, x);
            self.set_weights(|v| {
                let normal = normals[v as usize];
                let squared = dot(normal, normal).max(f64::MIN_POSITIVE);
                [0, 1].map(|c| {
                    let along = normal[network.curve_axes(v, c).0];
                    (1.0 - along * along / squared).max(LEAST_WEIGHT).powf(0.5 * exponent)
                })
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
        parallel::sum(x.len(), |v| self.own_value(x, v))
    }

    fn own_value(&self, x: &[f64], v: usize) -> f64 {
        let [a, b] = [0, 1].map(|c| self.rho(x, v as u32, c));
        a + b + self.barrier(x[v])
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
            for i in 0..3 {
                quadratic.gradient[i] += 2.0 * weight * residual * slope[i];
                for j in 0..3 {
                    quadratic.hessian[i][j] += 2.0 * weight * slope[i] * slope[j];
                }
            }
        }
        quadratic
    }

    /// The barrier at one position.
    pub(super) fn barrier(&self, x: f64) -> f64 {
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

    /// Slope and curvature of the energy in the position of vertex `v`.
    pub(super) fn slope_around(&self, x: &[f64], v: u32) -> Univariate {
        let mut sum = self.barrier_slope(x[v as usize]);
        let mut add = |term: Quadratic, place: usize| {
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

    /// The part of the energy that depends on the position of vertex `v`.
    pub(super) fn value_around(&self, x: &[f64], v: u32) -> f64 {
        let beside = |slot: usize| match self.network.neighbour(v, slot) {
            Some((u, link)) => self.rho(x, u, link.back_slot(slot) / 2),
            None => 0.0,
        };
        let neighbours: f64 = (0..4).map(beside).sum();
        self.rho(x, v, 0) + self.rho(x, v, 1) + neighbours + self.barrier(x[v as usize])
    }

    /// Weighted ρ of vertex `v` on its curve `c`.
    fn rho(&self, x: &[f64], v: u32, c: usize) -> f64 {
        match self.weights[v as usize][c] {
            0.0 => 0.0,
            weight => weight * self.energy.rho(&self.stencil(x, v, c).0.points),
        }
    }

    /// Smallest squared length of the chords at vertex `v`, and the least cosine of the turning of its
    /// curves there.
    pub(super) fn shape_at(&self, x: &[f64], v: u32) -> (f64, f64) {
        let (mut shortest, mut least_cosine) = (f64::INFINITY, 1f64);
        for c in (0..2).filter(|&c| self.weights[v as usize][c] > 0.0) {
            let [a, b, c] = self.stencil(x, v, c).0.points;
            let (before, after) = (subtract(b, a), subtract(c, b));
            let (l0, l1) = (dot(before, before), dot(after, after));
            shortest = shortest.min(l0).min(l1);
            least_cosine = least_cosine.min(dot(before, after) / (l0 * l1).sqrt());
        }
        (shortest, least_cosine)
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
