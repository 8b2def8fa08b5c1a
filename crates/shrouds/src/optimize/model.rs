//! The energy around a state to second order: a gradient and a matrix along the curves.

use crate::energy::LANES;
use crate::network::{Network, REPEATED};
use crate::optimize::problem::{Energy, Problem};
use crate::optimize::real::Real;
use crate::optimize::strip::{STRIP, Strip};
use crate::parallel::{self, NONE};

/// Gradient and Gauss–Newton matrix of the energy.
///
/// The matrix couples a place to those one and two steps away on its curve, and the two places of a
/// vertex act as one. In single precision: the matrix only shapes the steps, and where they end is
/// decided by the gradient.
pub(super) struct Model<R> {
    gradient: Vec<R>,
    diagonal: Vec<f32>,
    /// Coupling of every place to the next one, and to the one after that.
    near: Vec<f32>,
    far: Vec<f32>,
}

impl<R: Real> Model<R> {
    pub(super) fn new(network: &Network) -> Self {
        let (vertices, places) = (network.vertex_count(), network.vertices().len());
        Self {
            gradient: vec![R::default(); vertices],
            diagonal: vec![0.0; vertices],
            near: vec![0.0; places],
            far: vec![0.0; places],
        }
    }

    /// Sets gradient and matrix to those at `x`; returns the energy there.
    pub(super) fn linearise(&mut self, problem: &Problem<R>, x: &[R]) -> Energy {
        let parts = self.linearise_curves(problem, x);
        self.gather(problem, x, &parts);
        parts.energy + problem.barrier_value(x)
    }

    /// The same after setting the barrier to what the energy of the curves asks for.
    pub(super) fn linearise_with_new_barrier(
        &mut self,
        problem: &mut Problem<R>,
        x: &[R],
    ) -> Energy {
        let parts = self.linearise_curves(problem, x);
        problem.set_barrier(parts.energy.all);
        self.gather(problem, x, &parts);
        parts.energy + problem.barrier_value(x)
    }

    fn linearise_curves(&mut self, problem: &Problem<R>, x: &[R]) -> Parts<R> {
        let places = self.near.len();
        let (mut slopes, mut squares) = (vec![R::default(); places], vec![0.0f32; places]);
        let arrays = [&mut squares[..], &mut self.near, &mut self.far];
        let energy = parallel::update_blocks(&mut slopes, arrays, |first, slopes, matrix| {
            let [squares, near, far] = matrix;
            let range = first..first + slopes.len();
            let mut rho = vec![R::default(); range.len()];
            let mut terms = Terms::new();
            problem.strips(x, range.clone(), true, |strip, places| {
                terms.fill(problem, strip, places.len());
                let out = places.start - first..places.end - first;
                let count = out.len();
                terms.slopes(&mut slopes[out.clone()]);
                terms.squares(&mut squares[out.clone()]);
                terms.near(&mut near[out.clone()]);
                terms.far(&mut far[out.clone()]);
                rho[out].copy_from_slice(&terms.rho[1..=count]);
            });
            problem.sum_over_curves(range, &rho)
        });
        Parts { energy, slopes, squares }
    }

    /// Gradient and diagonal from the parts at both places of every vertex and the barrier.
    fn gather(&mut self, problem: &Problem<R>, x: &[R], parts: &Parts<R>) {
        let Parts { slopes, squares, .. } = parts;
        let network = problem.network;
        let diagonal = [&mut self.diagonal[..]];
        parallel::update_blocks(&mut self.gradient, diagonal, |first, gradient, [diagonal]| {
            let range = first..first + gradient.len();
            let parts = network
                .at_vertices(range.clone(), slopes)
                .zip(network.at_vertices(range.clone(), squares));
            let sums = gradient.iter_mut().zip(diagonal);
            for (((gradient, diagonal), &x), (slopes, squares)) in sums.zip(&x[range]).zip(parts) {
                let (slope, curvature) = problem.barrier.slopes(x.to_f64());
                *gradient = R::from_f64(slope) + slopes[0] + slopes[1];
                *diagonal = curvature as f32 + squares[0] + squares[1];
            }
            0.0
        });
    }

    /// How far vertex `v` would move from `x` to the minimum of the model if all others stayed.
    pub(super) fn lone_step(&self, v: usize, x: R, [low, high]: [R; 2]) -> f64 {
        let (x, low, high) = (x.to_f64(), low.to_f64(), high.to_f64());
        let length = self.gradient(v) / self.diagonal(v).max(f64::MIN_POSITIVE);
        (x - length).clamp(low, high) - x
    }

    pub(super) fn gradient(&self, v: usize) -> f64 {
        self.gradient[v].to_f64()
    }

    pub(super) fn diagonal(&self, v: usize) -> f64 {
        f64::from(self.diagonal[v])
    }

    pub(super) fn gradients(&self) -> &[R] {
        &self.gradient
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
                for (value, at_place) in gathered.iter_mut().zip(network.at_places(window, vector))
                {
                    *value = at_place;
                }
                let out = &mut images[start - first..][..count];
                let (near, before) =
                    (&self.near[start..][..count], &self.near[start - 1..][..count]);
                let (far, behind) = (&self.far[start..][..count], &self.far[start - 2..][..count]);
                let (a, b) = (&gathered[..count], &gathered[1..][..count]);
                let (c, d) = (&gathered[3..][..count], &gathered[4..][..count]);
                for n in 0..count {
                    out[n] = behind[n] * a[n] + before[n] * b[n] + near[n] * c[n] + far[n] * d[n];
                }
            }
            0.0
        });
    }
}

/// Energy of the curves, and what every place adds to the gradient and the diagonal at its vertex.
struct Parts<R> {
    energy: Energy,
    slopes: Vec<R>,
    squares: Vec<f32>,
}

/// ρ, its gradient and its Gauss–Newton matrix with respect to the three positions it depends on, at
/// the places of a strip and at one more to either side. Index 0 is the one before.
struct Terms<R> {
    /// The value.
    rho: [R; LENGTH],
    gradient: [[R; LENGTH]; 3],
    /// The entries (0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2).
    matrix: [[R; LENGTH]; 6],
}

/// One place before and one after the strip take part, and the last lanes may reach beyond.
const LENGTH: usize = STRIP + LANES;

impl<R: Real> Terms<R> {
    fn new() -> Self {
        let zeros = [R::default(); LENGTH];
        Self { rho: zeros, gradient: [zeros; 3], matrix: [zeros; 6] }
    }

    /// Evaluates the terms at the `count` places of a strip and at those beside it.
    fn fill(&mut self, problem: &Problem<R>, strip: &Strip<R>, count: usize) {
        let two = R::from_f64(2.0);
        for n in (0..count + 2).step_by(LANES) {
            let term = R::terms(problem.energy, &strip.stencils(n + REPEATED - 1));
            let weight = strip.weights(n + REPEATED - 1);
            let ([p, q], [a, b]) = (term.residual, term.slope);
            put(&mut self.rho, n, |l| weight[l] * (p[l] * p[l] + q[l] * q[l]));
            for i in 0..3 {
                let (mut c, mut d) = (a[i], b[i]);
                for l in 0..LANES {
                    c[l] = two * weight[l] * c[l];
                    d[l] = two * weight[l] * d[l];
                }
                put(&mut self.gradient[i], n, |l| p[l] * c[l] + q[l] * d[l]);
                for j in i..3 {
                    let row = &mut self.matrix[ENTRY[i][j]];
                    put(row, n, |l| a[j][l] * c[l] + b[j][l] * d[l]);
                }
            }
        }
    }

    /// The gradient in the position of every place.
    fn slopes(&self, out: &mut [R]) {
        let [next, own, previous] = &self.gradient;
        sum(out, [own, previous, next], |x| x);
    }

    /// The diagonal of the matrix.
    fn squares(&self, out: &mut [f32]) {
        let [next, _, _, own, _, previous] = &self.matrix;
        sum(out, [own, previous, next], single);
    }

    /// The coupling of every place to the next one.
    fn near(&self, out: &mut [f32]) {
        let [_, next, _, _, own, _] = &self.matrix;
        for ((out, &a), &b) in out.iter_mut().zip(&own[1..]).zip(&next[2..]) {
            *out = single(a + b);
        }
    }

    /// The coupling of every place to the one after the next.
    fn far(&self, out: &mut [f32]) {
        for (out, &a) in out.iter_mut().zip(&self.matrix[2][2..]) {
            *out = single(a);
        }
    }
}

/// Where the entry of a symmetric matrix of three rows is kept.
const ENTRY: [[usize; 3]; 3] = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];

/// At every place its own number, that of the place before and that of the next one.
fn sum<R: Real, T>(out: &mut [T], [own, previous, next]: [&[R; LENGTH]; 3], f: impl Fn(R) -> T) {
    let terms = own[1..].iter().zip(previous).zip(&next[2..]);
    for (out, ((&own, &previous), &next)) in out.iter_mut().zip(terms) {
        *out = f(own + previous + next);
    }
}

#[inline(always)]
fn single<R: Real>(x: R) -> f32 {
    x.to_f64() as f32
}

/// Sets some numbers from index `n` on.
#[inline(always)]
fn put<R: Real>(row: &mut [R; LENGTH], n: usize, f: impl Fn(usize) -> R) {
    for (l, value) in row[n..n + LANES].iter_mut().enumerate() {
        *value = f(l);
    }
}
