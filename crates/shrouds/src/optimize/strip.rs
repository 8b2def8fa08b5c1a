//! A piece of the curves, laid out for arithmetic on several places at once.

use crate::energy::{Lanes, Stencil};
use crate::network::{Network, Step};

/// Places per strip; with its arrays it stays in the first-level cache.
pub(super) const STRIP: usize = 256;
/// The strip, two places before and after it, and what the last lanes read beyond.
pub(super) const LONG: usize = STRIP + 12;
/// One place, two before and after it, and what the last lanes read beyond.
pub(super) const SHORT: usize = 8;
/// Numbers per [`Lanes`].
pub(super) const WIDTH: usize = 4;

/// For every step: how the place moves along both axes of its plane as its position grows, and where
/// the next place's grid edge starts, seen from this one's. In units of the smallest spacing.
pub(super) struct StepTable(Vec<[f64; 4]>);

impl StepTable {
    pub(super) fn new(spacing: [f64; 3]) -> Self {
        let row = |code: u8| {
            let step = Step::from_code(code);
            let (u, v) = ((step.normal() + 1) % 3, (step.normal() + 2) % 3);
            let second = f64::from(u8::from(step.runs_second()));
            let [a, b] = step.shift().map(f64::from);
            [(1.0 - second) * spacing[u], second * spacing[v], a * spacing[u], b * spacing[v]]
        };
        Self((0..=u8::MAX).map(row).collect())
    }

    #[inline(always)]
    fn row(&self, step: Step) -> [f64; 4] {
        self.0[usize::from(step.code())]
    }
}

/// Some successive places. Index `REPEATED` is the first place of the strip itself.
pub(super) struct Strip<const LENGTH: usize = LONG> {
    /// How far every place has moved from the start of its grid edge, along both axes of the plane.
    offset: [[f64; LENGTH]; 2],
    moves: [[f64; LENGTH]; 2],
    shift: [[f64; LENGTH]; 2],
}

impl<const LENGTH: usize> Strip<LENGTH> {
    pub(super) fn new() -> Self {
        Self {
            offset: [[0.0; LENGTH]; 2],
            moves: [[0.0; LENGTH]; 2],
            shift: [[0.0; LENGTH]; 2],
        }
    }

    /// Loads the places from `first` on, `count` of them, at the positions `x`.
    pub(super) fn load(
        &mut self,
        network: &Network,
        table: &StepTable,
        x: &[f64],
        first: usize,
        count: usize,
    ) {
        let vertices = &network.vertices()[first..first + count];
        let steps = &network.steps()[first..first + count];
        for (n, (&v, &step)) in vertices.iter().zip(steps).enumerate() {
            self.set(n, table, step, x[v as usize]);
        }
    }

    /// Sets the place at index `n`.
    #[inline(always)]
    pub(super) fn set(&mut self, n: usize, table: &StepTable, step: Step, x: f64) {
        let [mu, mv, su, sv] = table.row(step);
        (self.offset[0][n], self.offset[1][n]) = (x * mu, x * mv);
        (self.moves[0][n], self.moves[1][n]) = (mu, mv);
        (self.shift[0][n], self.shift[1][n]) = (su, sv);
    }

    /// The vectors from the places at `n` and the next ones to their successors.
    #[inline(always)]
    pub(super) fn chords(&self, n: usize) -> [Lanes; 2] {
        [0, 1].map(|k| {
            let (offset, shift) = (&self.offset[k][n..n + WIDTH + 1], &self.shift[k][n..n + WIDTH]);
            std::array::from_fn(|l| shift[l] + offset[l + 1] - offset[l])
        })
    }

    /// The chords before and after the places at `n` and the next ones, and how these move.
    #[inline(always)]
    pub(super) fn chords_around(&self, n: usize) -> ([[Lanes; 2]; 2], [Lanes; 2]) {
        ([self.chords(n - 1), self.chords(n)], [0, 1].map(|k| lanes(&self.moves[k], n)))
    }

    /// The places at `n` and the next ones with their neighbours, each seen from itself.
    #[inline(always)]
    pub(super) fn points(&self, n: usize) -> [[Lanes; 2]; 3] {
        let before = self.chords(n - 1).map(|chord| chord.map(|x| -x));
        [before, [[0.0; WIDTH]; 2], self.chords(n)]
    }

    /// The same with the ways the places move.
    #[inline(always)]
    pub(super) fn stencils(&self, n: usize) -> Stencil<Lanes> {
        let moves = |n: usize| [0, 1].map(|k| lanes(&self.moves[k], n));
        Stencil { points: self.points(n), moves: [moves(n - 1), moves(n), moves(n + 1)] }
    }
}

/// The numbers at `n` and the next ones.
#[inline(always)]
pub(super) fn lanes(values: &[f64], n: usize) -> Lanes {
    let values = &values[n..n + WIDTH];
    std::array::from_fn(|l| values[l])
}
