//! The energy around a state to second order, as one sparse row per vertex.

use crate::optimize::problem::{Problem, Quadratic, Univariate};
use crate::parallel;

/// Row of the Gauss–Newton matrix of one vertex: its coupling to itself and, in each of its four
/// slots, to the vertices one and two steps away.
///
/// In single precision: the matrix only shapes the steps, and where they end is decided by the
/// gradient.
#[derive(Clone, Copy, Default)]
struct Row {
    diagonal: f32,
    near: [f32; 4],
    far: [f32; 4],
    near_vertices: [u32; 4],
    far_vertices: [u32; 4],
}

/// Gradient and Gauss–Newton matrix of the energy.
pub(super) struct Model {
    terms: Vec<[Quadratic; 2]>,
    gradient: Vec<f64>,
    rows: Vec<Row>,
}

impl Model {
    pub(super) fn new(problem: &Problem) -> Self {
        let count = problem.vertex_count();
        let network = problem.network;
        let mut rows = vec![Row::default(); count];
        parallel::fill(&mut rows, |v| {
            let v = v as u32;
            let near = |slot| network.neighbour(v, slot).map(|(u, _)| u);
            let far = |slot| network.second_neighbour(v, slot);
            // A missing vertex is replaced by the row's own, with coefficient 0.
            Row {
                near_vertices: std::array::from_fn(|slot| near(slot).unwrap_or(v)),
                far_vertices: std::array::from_fn(|slot| far(slot).unwrap_or(v)),
                ..Row::default()
            }
        });
        Self { terms: vec![Default::default(); count], gradient: vec![0.0; count], rows }
    }

    /// Gradient and matrix at `x`.
    pub(super) fn linearise(&mut self, problem: &Problem, x: &[f64]) {
        let terms = &mut self.terms;
        parallel::fill(terms, |v| [0, 1].map(|c| problem.term(x, v as u32, c)));
        let terms = &self.terms;
        let gradient_at = |v: usize| {
            let own: f64 = terms[v].iter().map(|term| term.gradient[1]).sum();
            let neighbours: f64 = beside(problem, terms, v).map(|(_, t, n)| t.gradient[n]).sum();
            problem.barrier_slope(x[v]).slope + own + neighbours
        };
        parallel::fill(&mut self.gradient, gradient_at);
        parallel::update(&mut self.rows, |v, row| {
            set_row(row, problem, terms, v, problem.barrier_slope(x[v]));
        });
    }

    /// How far vertex `v` would move from `x` to the minimum of the model if all others stayed.
    pub(super) fn lone_step(&self, v: usize, x: f64, [low, high]: [f64; 2]) -> f64 {
        let length = self.gradient(v) / self.diagonal(v).max(f64::MIN_POSITIVE);
        (x - length).clamp(low, high) - x
    }

    pub(super) fn gradient(&self, v: usize) -> f64 {
        self.gradient[v]
    }

    pub(super) fn diagonal(&self, v: usize) -> f64 {
        f64::from(self.rows[v].diagonal)
    }

    /// Entry `v` of the product of the matrix with a vector.
    pub(super) fn product(&self, v: usize, vector: &[f32]) -> f32 {
        let row = &self.rows[v];
        let mut sum = row.diagonal * vector[v];
        for slot in 0..4 {
            sum += row.near[slot] * vector[row.near_vertices[slot] as usize];
            sum += row.far[slot] * vector[row.far_vertices[slot] as usize];
        }
        sum
    }
}

/// The terms of the neighbours of `v` in which it takes part, with the slot of the neighbour and the
/// place of `v` in the neighbour's stencil: the first or the last of three.
fn beside<'a>(
    problem: &'a Problem,
    terms: &'a [[Quadratic; 2]],
    v: usize,
) -> impl Iterator<Item = (usize, &'a Quadratic, usize)> {
    (0..4).filter_map(move |slot| {
        let (u, link) = problem.network.neighbour(v as u32, slot)?;
        let back = link.back_slot(slot);
        Some((slot, &terms[u as usize][back / 2], 2 * (back % 2)))
    })
}

/// Sets the coefficients of the row of vertex `v`.
fn set_row(
    row: &mut Row,
    problem: &Problem,
    terms: &[[Quadratic; 2]],
    v: usize,
    barrier: Univariate,
) {
    let mut diagonal = barrier.curvature;
    let (mut near, mut far) = ([0.0; 4], [0.0; 4]);
    for (c, term) in terms[v].iter().enumerate() {
        diagonal += term.hessian[1][1];
        near[2 * c] += term.hessian[1][0];
        near[2 * c + 1] += term.hessian[1][2];
    }
    for (slot, term, place) in beside(problem, terms, v) {
        diagonal += term.hessian[place][place];
        near[slot] += term.hessian[place][1];
        far[slot] += term.hessian[place][2 - place];
    }
    let single = |values: [f64; 4]| values.map(|x| x as f32);
    row.diagonal = diagonal as f32;
    row.near = single(near);
    row.far = single(far);
}
