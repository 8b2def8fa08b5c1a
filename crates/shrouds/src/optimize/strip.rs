//! A piece of the curves, laid out for arithmetic on several places at once.

use std::ops::Range;

use crate::energy::{LANES, Lanes, Stencil};
use crate::network::{Network, REPEATED, Step};
use crate::optimize::real::Real;

/// Places per strip; with its arrays it stays in the first-level cache.
pub(super) const STRIP: usize = 256;
/// Places that a strip holds: its own, three before and after them, and what the last lanes read beyond.
const LENGTH: usize = STRIP + 2 * REPEATED + LANES;

/// Where a place that is not there is taken to lie: so far that a tangent, which minds the nearer of
/// two neighbours more, is that to the neighbour there is, if there is one.
const FAR: f64 = 1e5;

/// Lengths in units of the smallest spacing that turn the step of a place into numbers.
pub(crate) struct Lengths<R> {
    spacing: [R; 3],
    /// See [`Lengths::of_step`].
    steps: Vec<[[R; 2]; 2]>,
}

impl<R: Real> Lengths<R> {
    pub(super) fn new(spacing: [f64; 3]) -> Self {
        let mut lengths = Self { spacing: spacing.map(R::from_f64), steps: Vec::new() };
        lengths.steps = Step::all().map(|step| lengths.measure(step)).collect();
        lengths
    }

    fn measure(&self, step: Step) -> [[R; 2]; 2] {
        let [u, v] = self.of_plane(step.normal());
        let [a, b] = step.shift().map(R::from_i32);
        let moves = if step.runs_second() { [R::default(), v] } else { [u, R::default()] };
        let shift = if step.is_linked() { [u * a, v * b] } else { [R::from_f64(FAR); 2] };
        [moves, shift]
    }

    /// Those along both axes of the planes with this normal.
    #[inline(always)]
    fn of_plane(&self, normal: usize) -> [R; 2] {
        [self.spacing[(normal + 1) % 3], self.spacing[(normal + 2) % 3]]
    }

    /// How a vertex moves along both axes of its plane, and how far from the start of its grid edge
    /// that of the next one lies.
    #[inline(always)]
    pub(super) fn of_step(&self, step: Step) -> [[R; 2]; 2] {
        self.steps[step.index()]
    }

    /// The distance between planes with this normal.
    #[inline(always)]
    pub(crate) fn between_planes(&self, normal: usize) -> R {
        self.spacing[normal % 3]
    }
}

/// Some successive places. Index `REPEATED` is the first place of the strip itself.
pub(super) struct Strip<R> {
    positions: [R; LENGTH],
    /// How far every place has moved from the start of its grid edge, along both axes of the plane.
    offset: [[R; LENGTH]; 2],
    moves: [[R; LENGTH]; 2],
    shift: [[R; LENGTH]; 2],
    /// Weight of ρ.
    weight: [R; LENGTH],
}

impl<R: Real> Strip<R> {
    pub(super) fn new() -> Self {
        let zeros = [R::default(); LENGTH];
        Self {
            positions: zeros,
            offset: [zeros; 2],
            moves: [zeros; 2],
            shift: [zeros; 2],
            weight: zeros,
        }
    }

    /// Sets the places from index `at` on to some successive steps in planes of one family. A loop
    /// for each number, which the compiler makes one over several places at a time.
    #[inline(always)]
    fn set_steps(&mut self, at: usize, steps: &[Step], lengths: [R; 2]) {
        let range = at..at + steps.len();
        let (zero, far) = (R::default(), R::from_f64(FAR));
        for (k, length) in lengths.into_iter().enumerate() {
            for (moves, step) in self.moves[k][range.clone()].iter_mut().zip(steps) {
                *moves = if step.runs_second() == (k == 1) { length } else { zero };
            }
            for (shift, step) in self.shift[k][range.clone()].iter_mut().zip(steps) {
                let unit = if step.is_linked() { length } else { far };
                *shift = unit * R::from_i32(step.shift()[k]);
            }
            let positions = self.positions[range.clone()].iter().zip(&self.moves[k][range.clone()]);
            for (offset, (&x, &moves)) in self.offset[k][range.clone()].iter_mut().zip(positions) {
                *offset = x * moves;
            }
        }
    }

    /// Loads some places.
    #[inline(always)]
    pub(super) fn load(
        &mut self,
        network: &Network,
        places: Range<usize>,
        lengths: &Lengths<R>,
        x: &[R],
    ) {
        for (position, x) in self.positions.iter_mut().zip(network.at_places(places.clone(), x)) {
            *position = x;
        }
        // Planes of one family follow each other, so there is mostly one family.
        for (first, steps) in families(&network.steps()[places]) {
            let plane = lengths.of_plane(steps[0].normal());
            self.set_steps(first, steps, plane);
        }
    }

    /// Sets the weights of the places.
    #[inline(always)]
    pub(super) fn load_weights(&mut self, weights: &[R]) {
        self.weight[..weights.len()].copy_from_slice(weights);
    }

    /// The vectors from the places at `n` and the next ones to their successors.
    #[inline(always)]
    pub(super) fn chords(&self, n: usize) -> [Lanes<R>; 2] {
        [self.chords_along(0, n), self.chords_along(1, n)]
    }

    #[inline(always)]
    fn chords_along(&self, k: usize, n: usize) -> Lanes<R> {
        let (offset, shift) = (&self.offset[k][n..n + LANES + 1], &self.shift[k][n..n + LANES]);
        let mut chords = [R::default(); LANES];
        for l in 0..LANES {
            chords[l] = shift[l] + offset[l + 1] - offset[l];
        }
        chords
    }

    /// How the places at `n` and the next ones move.
    #[inline(always)]
    pub(super) fn moves(&self, n: usize) -> [Lanes<R>; 2] {
        [lanes(&self.moves[0], n), lanes(&self.moves[1], n)]
    }

    /// The places at `n` and the next ones with those around them, each seen from itself, and how they
    /// move.
    #[inline(always)]
    pub(super) fn stencils(&self, n: usize) -> Stencil<Lanes<R>> {
        let [u, v] = self.chords(n - 1);
        let (next, chord) = (self.chords(n), self.chords(n + 1));
        Stencil {
            points: [
                [negative(u), negative(v)],
                [[R::default(); LANES]; 2],
                next,
                [sum(next[0], chord[0]), sum(next[1], chord[1])],
            ],
            moves: [-1, 0, 1, 2].map(|shift| self.moves(n.wrapping_add_signed(shift))),
        }
    }

    /// The weights of the places at `n` and the next ones.
    #[inline(always)]
    pub(super) fn weights(&self, n: usize) -> Lanes<R> {
        lanes(&self.weight, n)
    }
}

/// The stretches of steps in planes of one family, with the number of their first.
#[inline(always)]
fn families(steps: &[Step]) -> impl Iterator<Item = (usize, &[Step])> {
    let mut first = 0;
    std::iter::from_fn(move || {
        let rest = &steps[first..];
        let (head, last) = (rest.first()?.normal(), rest.last()?.normal());
        let is_other = |step: &Step| step.normal() != head;
        let count = match head == last {
            true => rest.len(),
            false => rest.iter().position(is_other).unwrap_or(rest.len()),
        };
        let found = (first, &rest[..count]);
        first += count;
        Some(found)
    })
}

/// The numbers at `n` and the next ones.
#[inline(always)]
fn lanes<R: Real>(values: &[R], n: usize) -> Lanes<R> {
    let mut lanes = [R::default(); LANES];
    lanes.copy_from_slice(&values[n..n + LANES]);
    lanes
}

#[inline(always)]
fn negative<R: Real>(mut values: Lanes<R>) -> Lanes<R> {
    for value in &mut values {
        *value = -*value;
    }
    values
}

#[inline(always)]
fn sum<R: Real>(mut a: Lanes<R>, b: Lanes<R>) -> Lanes<R> {
    for (a, b) in a.iter_mut().zip(b) {
        *a = *a + b;
    }
    a
}

impl<R: Real> Strip<R> {
    /// The smaller squared length of the chords before and after each of some places, and the cosine
    /// between them.
    #[inline(always)]
    pub(super) fn turnings(&self, n: usize) -> (Lanes<f32>, Lanes<f32>) {
        let (before, after) = (single(self.chords(n - 1)), single(self.chords(n)));
        let (mut lengths, mut cosines) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let [a, b] = [[before[0][l], before[1][l]], [after[0][l], after[1][l]]];
            let (l0, l1) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
            lengths[l] = if l0 < l1 { l0 } else { l1 };
            cosines[l] = (a[0] * b[0] + a[1] * b[1]) / (l0 * l1).sqrt();
        }
        (lengths, cosines)
    }

    /// The slopes of the curves over the grid edges of some places, see
    /// [`Problem::slopes`](crate::optimize::problem::Problem::slopes).
    #[inline(always)]
    pub(super) fn slopes(&self, n: usize) -> Lanes<R> {
        let (before, after, moves) = (self.chords(n - 1), self.chords(n), self.moves(n));
        let mut slopes = [R::default(); LANES];
        for l in 0..LANES {
            let [a, b] = [[before[0][l], before[1][l]], [after[0][l], after[1][l]]];
            // Both tangents at a vertex are weighted by the inverse of their chords' squared lengths;
            // only the ratio matters, so by the other's.
            let (wb, wa) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
            let tangent = [wa * a[0] + wb * b[0], wa * a[1] + wb * b[1]];
            let along = tangent[0] * moves[0][l] + tangent[1] * moves[1][l];
            let across = tangent[0] * moves[1][l] + tangent[1] * moves[0][l];
            slopes[l] = along / across;
        }
        slopes
    }
}

#[inline(always)]
fn single<R: Real>([u, v]: [Lanes<R>; 2]) -> [Lanes<f32>; 2] {
    let mut single = [[0.0; LANES]; 2];
    for l in 0..LANES {
        single[0][l] = u[l].to_f64() as f32;
        single[1][l] = v[l].to_f64() as f32;
    }
    single
}
