//! The energy around a state to second order, as one sparse row per vertex.

use crate::optimize::problem::{Problem, Quadratic};
use crate::parallel;

/// Row of the Gauss–Newton matrix of one vertex: its coupling to itself and, in each of its four
/// slots, to the vertices one and two steps away.
#[derive(Clone, Copy, Default)]
struct Row {
    diagonal: f64,
    near: [f64; 4],
    far: [f64; 4],
}

/// Gradient and Gauss–Newton matrix of the energy.
pub(super) struct Model {
    near: Vec<[u32; 4]>,
    far: Vec<[u32; 4]>,
    terms: Vec<[Quadratic; 2]>,
    rows: Vec<(f64, Row)>,
}

impl Model {
    pub(super) fn new(problem: &Problem) -> Self {
        let count = problem.vertex_count();
        let network = problem.network;
        // A missing vertex is replaced by the row's own, with coefficient 0.
        let mut near = vec![[0; 4]; count];
        parallel::fill(&mut near, |v| {
            let v = v as u32;
            std::array::from_fn(|slot| network.neighbour(v, slot).map_or(v, |(u, _)| u))
        });
        let mut far = vec![[0; 4]; count];
        parallel::fill(&mut far, |v| {
            let v = v as u32;
            std::array::from_fn(|slot| network.second_neighbour(v, slot).unwrap_or(v))
        });
        Self {
            near,
            far,
            terms: vec![Default::default(); count],
            rows: vec![Default::default(); count],
        }
    }

    /// Gradient and matrix at `x`.
    pub(super) fn linearise(&mut self, problem: &Problem, x: &[f64]) {
        let terms = &mut self.terms;
        parallel::fill(terms, |v| [0, 1].map(|c| problem.term(x, v as u32, c)));
        let terms = &self.terms;
        parallel::fill(&mut self.rows, |v| {
            let barrier = problem.barrier(x[v]);
            let (mut gradient, mut row) = (barrier.slope, Row::default());
            row.diagonal = barrier.curvature;
            for (c, term) in terms[v].iter().enumerate() {
                gradient += term.gradient[1];
                row.diagonal += term.hessian[1][1];
                row.near[2 * c] += term.hessian[1][0];
                row.near[2 * c + 1] += term.hessian[1][2];
            }
            for slot in 0..4 {
                let Some((u, link)) = problem.network.neighbour(v as u32, slot) else { continue };
                // In the neighbour's stencil this vertex is the first or the last of three.
                let back = link.back_slot(slot);
                let term = &terms[u as usize][back / 2];
                let place = 2 * (back % 2);
                gradient += term.gradient[place];
                row.diagonal += term.hessian[place][place];
                row.near[slot] += term.hessian[place][1];
                row.far[slot] += term.hessian[place][2 - place];
            }
            (gradient, row)
        });
    }

    pub(super) fn gradient(&self, v: usize) -> f64 {
        self.rows[v].0
    }

    pub(super) fn diagonal(&self, v: usize) -> f64 {
        self.rows[v].1.diagonal
    }

    /// Entry `v` of the product of the matrix, its diagonal raised by the factor `1 + damping`, with
    /// a vector.
    pub(super) fn product(&self, v: usize, vector: &[f64], damping: f64) -> f64 {
        let row = &self.rows[v].1;
        let (near, far) = (&self.near[v], &self.far[v]);
        let mut sum = row.diagonal * (1.0 + damping) * vector[v];
        for slot in 0..4 {
            sum += row.near[slot] * vector[near[slot] as usize];
            sum += row.far[slot] * vector[far[slot] as usize];
        }
        sum
    }
}
