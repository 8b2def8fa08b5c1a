//! A piece of the curves, laid out for arithmetic on several places at once.

use crate::energy::{LANES, Lanes, Stencil};
use crate::network::{REPEATED, Step};
use crate::optimize::real::Real;

/// Places per strip; with its arrays it stays in the first-level cache.
pub(super) const STRIP: usize = 256;
/// Places that a strip holds: its own, two before and after them, and what the last lanes read beyond.
pub(super) const LONG: usize = STRIP + 2 * REPEATED + LANES;

/// Where a place that is not there is taken to lie: so far that a tangent, which minds the nearer of
/// two neighbours more, is that to the neighbour there is.
const FAR: f64 = 1e5;

/// What a place contributes to a strip, for every step.
pub(super) struct StepTable<R>(Vec<StepRow<R>>);

/// Lengths in units of the smallest spacing, along the first and second axis of the plane.
#[derive(Clone, Copy)]
pub(super) struct StepRow<R> {
    /// How the place moves as its position grows.
    moves: [R; 2],
    /// Where the next place's grid edge starts, seen from this one's.
    shift: [R; 2],
    /// The distance to the next slice.
    distance: R,
}

impl<R: Real> StepTable<R> {
    pub(super) fn new(spacing: [f64; 3]) -> Self {
        let row = |code: u8| {
            let step = Step::from_code(code);
            let axes = [(step.normal() + 1) % 3, (step.normal() + 2) % 3];
            let own = usize::from(step.runs_second());
            let along = |k: usize| if k == own { spacing[axes[k]] } else { 0.0 };
            let shift = |k: usize| match step.is_linked() {
                true => f64::from(step.shift()[k]) * spacing[axes[k]],
                false => FAR,
            };
            StepRow {
                moves: [0, 1].map(|k| R::from_f64(along(k))),
                shift: [0, 1].map(|k| R::from_f64(shift(k))),
                distance: R::from_f64(spacing[step.normal() % 3]),
            }
        };
        Self((0..=u8::MAX).map(row).collect())
    }

    #[inline(always)]
    pub(super) fn row(&self, step: Step) -> StepRow<R> {
        self.0[usize::from(step.code())]
    }
}

/// Some successive places. Index `REPEATED` is the first place of the strip itself.
pub(super) struct Strip<R, const LENGTH: usize = LONG> {
    /// How far every place has moved from the start of its grid edge, along both axes of the plane.
    offset: [[R; LENGTH]; 2],
    moves: [[R; LENGTH]; 2],
    shift: [[R; LENGTH]; 2],
    /// Weight of ρ.
    weight: [R; LENGTH],
}

impl<R: Real, const LENGTH: usize> Strip<R, LENGTH> {
    pub(super) fn new() -> Self {
        let zeros = [R::default(); LENGTH];
        Self { offset: [zeros; 2], moves: [zeros; 2], shift: [zeros; 2], weight: zeros }
    }

    /// Sets the place at index `n`; its weight is without the distance of the slices.
    #[inline(always)]
    pub(super) fn set(&mut self, n: usize, row: StepRow<R>, x: R, weight: R) {
        (self.moves[0][n], self.moves[1][n]) = (row.moves[0], row.moves[1]);
        (self.shift[0][n], self.shift[1][n]) = (row.shift[0], row.shift[1]);
        self.weight[n] = weight * row.distance;
        self.move_to(n, x);
    }

    /// Moves the place at index `n`.
    #[inline(always)]
    pub(super) fn move_to(&mut self, n: usize, x: R) {
        self.offset[0][n] = x * self.moves[0][n];
        self.offset[1][n] = x * self.moves[1][n];
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

    /// The places at `n` and the next ones with their neighbours, each seen from itself, and how they
    /// move.
    #[inline(always)]
    pub(super) fn stencils(&self, n: usize) -> Stencil<Lanes<R>> {
        let [u, v] = self.chords(n - 1);
        Stencil {
            points: [[negative(u), negative(v)], [[R::default(); LANES]; 2], self.chords(n)],
            moves: [self.moves(n - 1), self.moves(n), self.moves(n + 1)],
        }
    }

    /// The weights of the places at `n` and the next ones.
    #[inline(always)]
    pub(super) fn weights(&self, n: usize) -> Lanes<R> {
        lanes(&self.weight, n)
    }
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
