//! The energy around a state to second order: a gradient and a matrix along the curves.

use std::ops::Range;

use crate::energy::{LANES, Support};
use crate::network::{Network, REPEATED};
use crate::optimize::problem::{Problem, Value, WeightedPart};
use crate::optimize::real::Real;
use crate::optimize::strip::{STRIP, Strip};
use crate::parallel::{self, NONE};

/// Gradient and Gauss–Newton matrix of the energy.
///
/// The matrix couples a place to those one, two and three steps away on its curve, and the two places of a
/// vertex act as one. In single precision: the matrix only shapes the steps, and where they end is
/// decided by the gradient.
pub(crate) struct Model<R> {
    gradient: Vec<R>,
    diagonal: Vec<f32>,
    /// Coupling of every place to the next one, to the one after that, and to the third. The last is
    /// 0 unless a measure looks so far.
    near: Vec<f32>,
    far: Vec<f32>,
    third: Vec<f32>,
    support: Support,
    /// What every place has of the energy and adds to gradient and diagonal.
    parts: Vec<Part<R>>,
    squares: Vec<f32>,
}

impl<R: Real> Model<R> {
    pub(crate) fn new(network: &Network) -> Self {
        let (vertices, places) = (network.vertex_count(), network.vertices().len());
        Self {
            gradient: vec![R::default(); vertices],
            diagonal: vec![0.0; vertices],
            near: vec![0.0; places],
            far: vec![0.0; places],
            third: vec![0.0; places],
            support: Support::Neighbours,
            parts: vec![Part::default(); places],
            squares: vec![0.0; places],
        }
    }

    /// Sets gradient and matrix to those at `x`; returns the energy there.
    pub(super) fn linearise(&mut self, problem: &Problem<R>, x: &[R]) -> Value {
        let energy = self.linearise_curves(problem, x);
        self.gather(problem, x);
        energy + problem.barrier_value(x)
    }

    /// The same after setting the barrier to what the energy of the curves asks for.
    pub(super) fn linearise_with_new_barrier(
        &mut self,
        problem: &mut Problem<R>,
        x: &[R],
    ) -> Value {
        let energy = self.linearise_curves(problem, x);
        problem.set_barrier(|place| self.parts[place].rho);
        self.gather(problem, x);
        energy + problem.barrier_value(x)
    }

    /// What the vertices have of the energy of the curves where the model stands, those that are
    /// foreign left out; as [`Problem::set_barrier`] takes it.
    pub(super) fn energy_of_vertices(&self, problem: &Problem<R>) -> f64 {
        problem.sum_over_own_vertices(|place| self.parts[place].rho)
    }

    /// The same of one vertex.
    pub(super) fn energy_of_vertex(&self, problem: &Problem<R>, v: usize) -> f64 {
        problem.energy_of_vertex(v, |place| self.parts[place].rho)
    }

    /// Looks at the curves alone. Returns their energy.
    pub(crate) fn linearise_curves(&mut self, problem: &Problem<R>, x: &[R]) -> Value {
        self.support = problem.support();
        let arrays = [&mut self.squares[..], &mut self.near, &mut self.far, &mut self.third];
        parallel::update_blocks(&mut self.parts, arrays, |first, parts, matrix| {
            let [squares, near, far, third] = matrix;
            let range = first..first + parts.len();
            let mut terms = Terms::new();
            problem.strips(x, range.clone(), |strip, places| {
                terms.fill(problem, strip, places.clone());
                let out = places.start - first..places.end - first;
                terms.parts(&mut parts[out.clone()]);
                terms.squares(&mut squares[out.clone()]);
                terms.near(&mut near[out.clone()]);
                terms.far(&mut far[out.clone()]);
                if problem.support() == Support::NextTwo {
                    terms.third(&mut third[out.clone()]);
                }
            });
            problem.sum_over_curves(range, |place| parts[place - first].rho)
        })
    }

    /// Gradient and diagonal from the parts at both places of every vertex and the barrier.
    pub(crate) fn gather(&mut self, problem: &Problem<R>, x: &[R]) {
        let (parts, squares) = (&self.parts, &self.squares);
        let network = problem.network;
        let diagonal = [&mut self.diagonal[..]];
        parallel::update_blocks(&mut self.gradient, diagonal, |first, gradient, [diagonal]| {
            let range = first..first + gradient.len();
            let parts = network
                .at_vertices(range.clone(), parts)
                .zip(network.at_vertices(range.clone(), squares));
            let sums = gradient.iter_mut().zip(diagonal).zip(range);
            for (((gradient, diagonal), v), (parts, squares)) in sums.zip(parts) {
                let (slope, curvature) = problem.barrier.slopes(v, x[v].to_f64());
                *gradient = R::from_f64(slope) + parts[0].slope + parts[1].slope;
                *diagonal = curvature as f32 + squares[0] + squares[1];
            }
            0.0
        });
    }

    /// Adds to the energy of a place.
    pub(crate) fn add_energy(&mut self, place: usize, energy: f64) {
        let rho = &mut self.parts[place].rho;
        *rho = *rho + R::from_f64(energy);
    }

    /// Adds to gradient and diagonal at an unknown.
    #[inline]
    pub(crate) fn add_slopes(&mut self, v: usize, slope: f32, curvature: f32) {
        self.gradient[v] = self.gradient[v] + R::from_f64(f64::from(slope));
        self.diagonal[v] += curvature;
    }

    /// The energy of a place.
    pub(crate) fn energy_at(&self, place: usize) -> R {
        self.parts[place].rho
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
                let (a, b) = (&gathered[1..][..count], &gathered[2..][..count]);
                let (c, d) = (&gathered[4..][..count], &gathered[5..][..count]);
                for n in 0..count {
                    out[n] = behind[n] * a[n] + before[n] * b[n] + near[n] * c[n] + far[n] * d[n];
                }
                if self.support == Support::NextTwo {
                    let (a, b) = (&gathered[..count], &gathered[6..][..count]);
                    let (beyond, third) =
                        (&self.third[start - 3..][..count], &self.third[start..][..count]);
                    for n in 0..count {
                        out[n] += beyond[n] * a[n] + third[n] * b[n];
                    }
                }
            }
            0.0
        });
    }
}

/// What a place has of the energy, and what it adds to the gradient at its vertex.
#[derive(Clone, Copy, Default)]
struct Part<R> {
    rho: R,
    slope: R,
}

/// ρ, its gradient and its Gauss–Newton matrix with respect to the four positions it depends on, at
/// the places of a strip, at two before and at one after. Index 0 is the first of those before.
struct Terms<R> {
    /// The value.
    rho: [R; LENGTH],
    gradient: [[R; LENGTH]; 4],
    /// The entries (0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2), (0, 3), (1, 3), (2, 3), (3, 3).
    matrix: [[R; LENGTH]; 10],
}

/// Places before and after those of a strip that take part; the last lanes may reach beyond.
const BEFORE: usize = 2;
const AFTER: usize = 1;
const LENGTH: usize = STRIP + LANES;

impl<R: Real> Terms<R> {
    fn new() -> Self {
        let zeros = [R::default(); LENGTH];
        Self { rho: zeros, gradient: [zeros; 4], matrix: [zeros; 10] }
    }

    /// Evaluates the terms at the own places of a strip and at those beside them.
    fn fill(&mut self, problem: &Problem<R>, strip: &mut Strip<R>, places: Range<usize>) {
        for (n, part) in problem.parts.iter().enumerate() {
            if n > 0 && part.is_nothing(places.clone()) {
                continue;
            }
            part.load_weights(strip, places.clone());
            let count = places.len() + BEFORE + AFTER;
            match (n, part.measure.support()) {
                (0, Support::Neighbours) if problem.support() == Support::Neighbours => {
                    self.fill_part::<3, true>(part, strip, count);
                }
                (0, _) => self.fill_part::<4, true>(part, strip, count),
                (_, Support::Neighbours) => self.fill_part::<3, false>(part, strip, count),
                (_, Support::NextTwo) => self.fill_part::<4, false>(part, strip, count),
            }
        }
    }

    /// The terms of one measure that looks at so many points, set or added to the others'.
    #[inline(always)]
    fn fill_part<const POINTS: usize, const SET: bool>(
        &mut self,
        part: &WeightedPart<R>,
        strip: &Strip<R>,
        count: usize,
    ) {
        let two = R::from_f64(2.0);
        for n in (0..count).step_by(LANES) {
            let term = R::terms(part.measure, &strip.stencils(n + REPEATED - BEFORE));
            let weight = strip.weights(n + REPEATED - BEFORE);
            let ([p, q], [a, b]) = (term.residual, term.slope);
            put::<R, SET>(&mut self.rho, n, |l| weight[l] * (p[l] * p[l] + q[l] * q[l]));
            for i in 0..POINTS {
                let (mut c, mut d) = (a[i], b[i]);
                for l in 0..LANES {
                    c[l] = two * weight[l] * c[l];
                    d[l] = two * weight[l] * d[l];
                }
                put::<R, SET>(&mut self.gradient[i], n, |l| p[l] * c[l] + q[l] * d[l]);
                for j in i..POINTS {
                    let row = &mut self.matrix[entry(i, j)];
                    put::<R, SET>(row, n, |l| a[j][l] * c[l] + b[j][l] * d[l]);
                }
            }
        }
    }

    /// Energy and gradient of every place.
    fn parts(&self, out: &mut [Part<R>]) {
        let [a, b, c, d] = &self.gradient;
        for (n, out) in out.iter_mut().enumerate() {
            let slope = a[n + 3] + b[n + 2] + c[n + 1] + d[n];
            *out = Part { rho: self.rho[n + BEFORE], slope };
        }
    }

    /// The diagonal of the matrix.
    fn squares(&self, out: &mut [f32]) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| &self.matrix[entry(i, i)]);
        let terms = a[3..].iter().zip(&b[2..]).zip(&c[1..]).zip(d);
        for (out, (((&a, &b), &c), &d)) in out.iter_mut().zip(terms) {
            *out = single(a + b + c + d);
        }
    }

    /// The coupling of every place to the next one.
    fn near(&self, out: &mut [f32]) {
        let [a, b, c] = [0, 1, 2].map(|i| &self.matrix[entry(i, i + 1)]);
        let terms = a[3..].iter().zip(&b[2..]).zip(&c[1..]);
        for (out, ((&a, &b), &c)) in out.iter_mut().zip(terms) {
            *out = single(a + b + c);
        }
    }

    /// The coupling of every place to the one after the next.
    fn far(&self, out: &mut [f32]) {
        let [a, b] = [0, 1].map(|i| &self.matrix[entry(i, i + 2)]);
        for (out, (&a, &b)) in out.iter_mut().zip(a[3..].iter().zip(&b[2..])) {
            *out = single(a + b);
        }
    }

    /// The coupling of every place to the third one after it.
    fn third(&self, out: &mut [f32]) {
        for (out, &a) in out.iter_mut().zip(&self.matrix[entry(0, 3)][3..]) {
            *out = single(a);
        }
    }
}

/// Where the entry of a symmetric matrix in row `i` and column `j ≥ i` is kept.
const fn entry(i: usize, j: usize) -> usize {
    j * (j + 1) / 2 + i
}

#[inline(always)]
fn single<R: Real>(x: R) -> f32 {
    x.to_f64() as f32
}

/// Sets some numbers from index `n` on, or adds to them.
#[inline(always)]
fn put<R: Real, const SET: bool>(row: &mut [R; LENGTH], n: usize, f: impl Fn(usize) -> R) {
    for (l, value) in row[n..n + LANES].iter_mut().enumerate() {
        *value = if SET { f(l) } else { *value + f(l) };
    }
}
