//! The energy around a state to second order: a gradient and a matrix along the curves.

use crate::network::{Network, REPEATED};
use crate::optimize::problem::Problem;
use crate::optimize::strip::{STRIP, Strip, WIDTH};
use crate::parallel::{self, NONE};

/// Gradient and Gauss–Newton matrix of the energy.
///
/// The matrix couples a place to those one and two steps away on its curve, and the two places of a
/// vertex act as one. In single precision: the matrix only shapes the steps, and where they end is
/// decided by the gradient.
pub(super) struct Model {
    gradient: Vec<f64>,
    diagonal: Vec<f32>,
    /// Coupling of every place to the next one, and to the one after that.
    near: Vec<f32>,
    far: Vec<f32>,
}

/// Gradient and Gauss–Newton matrix of ρ at the places of a strip with respect to the three
/// positions it depends on.
struct Quadratics {
    /// Twice ρ.
    rho: [f64; LENGTH],
    gradient: [[f64; LENGTH]; 3],
    /// Of the entries (0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2).
    matrix: [[f64; LENGTH]; 6],
}

/// One place before and one after the strip take part, and the last lanes may reach beyond.
const LENGTH: usize = STRIP + 2 + WIDTH;

impl Model {
    pub(super) fn new(problem: &Problem) -> Self {
        let (vertices, places) = (problem.vertex_count(), problem.network.vertices().len());
        Self {
            gradient: vec![0.0; vertices],
            diagonal: vec![0.0; vertices],
            near: vec![0.0; places],
            far: vec![0.0; places],
        }
    }

    /// Sets gradient and matrix to those at `x`; returns the energy there.
    pub(super) fn linearise(&mut self, problem: &Problem, x: &[f64]) -> f64 {
        let mut slopes = vec![0.0f64; self.near.len()];
        let mut squares = vec![0.0f32; self.near.len()];
        let arrays = [&mut squares[..], &mut self.near, &mut self.far];
        let curves = parallel::update_blocks(&mut slopes, arrays, |first, slopes, [squares, near, far]| {
            let mut quadratics = Quadratics::new();
            let range = first..first + slopes.len();
            let mut rho = vec![0.0; range.len()];
            problem.strips(x, range.clone(), |strip, places| {
                quadratics.fill(problem, strip, places.start, places.len());
                let QuadraticsView { g, m } = quadratics.view();
                for n in 0..places.len() {
                    let out = places.start - first + n;
                    // Index n + 1 is the place itself.
                    slopes[out] = g[1][n + 1] + g[2][n] + g[0][n + 2];
                    squares[out] = (m[3][n + 1] + m[5][n] + m[0][n + 2]) as f32;
                    near[out] = (m[4][n + 1] + m[1][n + 2]) as f32;
                    far[out] = m[2][n + 2] as f32;
                    rho[out] = 0.5 * quadratics.rho[n + 1];
                }
            });
            problem.sum_over_curves(range, &rho)
        });
        let places = problem.network.places();
        parallel::update_blocks(&mut self.gradient, [&mut self.diagonal], |first, gradient, [diagonal]| {
            for (n, (gradient, diagonal)) in gradient.iter_mut().zip(diagonal).enumerate() {
                let [a, b] = places[first + n].map(|place| place as usize);
                let barrier = problem.barrier_slope(x[first + n]);
                *gradient = barrier.slope + slopes[a] + slopes[b];
                *diagonal = barrier.curvature as f32 + squares[a] + squares[b];
            }
            0.0
        });
        curves + problem.barrier_value(x)
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
        f64::from(self.diagonal[v])
    }

    pub(super) fn diagonals(&self) -> &[f32] {
        &self.diagonal
    }

    /// What the matrix without its diagonal makes of a vector over the vertices, place by place; the
    /// sum over the two places of a vertex is its entry.
    pub(super) fn images(&self, network: &Network, vector: &[f32], images: &mut [f32]) {
        let total = images.len();
        parallel::update_blocks(images, NONE, |first, images, []| {
            let mut gathered = [0.0f32; STRIP + 2 * REPEATED];
            let end = (first + images.len()).min(total.saturating_sub(REPEATED));
            for start in (first.max(REPEATED)..end).step_by(STRIP) {
                let count = STRIP.min(end - start);
                let window = start - REPEATED..start + count + REPEATED;
                for (value, &v) in gathered.iter_mut().zip(&network.vertices()[window]) {
                    *value = vector[v as usize];
                }
                let out = &mut images[start - first..start - first + count];
                let (near, before) = (&self.near[start..][..count], &self.near[start - 1..][..count]);
                let (far, behind) = (&self.far[start..][..count], &self.far[start - 2..][..count]);
                let value = |shift: usize| &gathered[shift..shift + count];
                let [a, b, c, d] = [value(0), value(1), value(3), value(4)];
                for n in 0..count {
                    out[n] = behind[n] * a[n] + before[n] * b[n] + near[n] * c[n] + far[n] * d[n];
                }
            }
            0.0
        });
    }
}

struct QuadraticsView<'a> {
    g: [&'a [f64; LENGTH]; 3],
    m: [&'a [f64; LENGTH]; 6],
}

impl Quadratics {
    fn new() -> Self {
        Self { rho: [0.0; LENGTH], gradient: [[0.0; LENGTH]; 3], matrix: [[0.0; LENGTH]; 6] }
    }

    fn view(&self) -> QuadraticsView<'_> {
        QuadraticsView { g: self.gradient.each_ref(), m: self.matrix.each_ref() }
    }

    /// At the `count` places from `start` on and at one more to either side; index 0 is the one before.
    fn fill(&mut self, problem: &Problem, strip: &Strip, start: usize, count: usize) {
        const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        let mut weights = [0.0; LENGTH];
        problem.doubled_weights(start - 1..start + count + 1, &mut weights);
        for n in (0..count + 2).step_by(WIDTH) {
            let term = problem.terms(strip, n + REPEATED - 1);
            let weight: [f64; WIDTH] = std::array::from_fn(|l| weights[n + l]);
            let [a, b] = [0, 1].map(|r| {
                term.slope[r].map(|slope| std::array::from_fn::<f64, WIDTH, _>(|l| weight[l] * slope[l]))
            });
            for l in 0..WIDTH {
                let [a, b] = [term.residual[0][l], term.residual[1][l]];
                self.rho[n + l] = weight[l] * (a * a + b * b);
            }
            for j in 0..3 {
                for l in 0..WIDTH {
                    self.gradient[j][n + l] = term.residual[0][l] * a[j][l] + term.residual[1][l] * b[j][l];
                }
            }
            for (entry, (i, j)) in self.matrix.iter_mut().zip(PAIRS) {
                for l in 0..WIDTH {
                    entry[n + l] = term.slope[0][i][l] * a[j][l] + term.slope[1][i][l] * b[j][l];
                }
            }
        }
    }
}
