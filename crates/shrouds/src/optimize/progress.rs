//! What an observer sees of the work.

use std::fmt;
use std::ops::ControlFlow;

use crate::optimize::real::Real;
use crate::parallel;
use crate::surface::Surface;

/// How far the optimisation has come.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Iterations done, over all rounds.
    pub iteration: usize,
    /// The energy, with the weights of the current round.
    pub energy: f64,
    /// What the stop rule looks at: the root mean square of the last step, or the relative change in a sweep.
    pub change: f64,
    /// Euclidean norm of the gradient of the energy with respect to the positions, without what the bounds hold;
    /// nothing in the middle of a pass over many tiles, where only some are known.
    pub gradient: Option<f64>,
    /// The tolerance that `change` has to reach; 0 where it need not reach any.
    pub tolerance: f64,
    /// The share of the work that is done, from 0 to 1, where that is known beforehand.
    pub share_done: Option<f64>,
    /// Where the vertices are now.
    pub positions: Positions<'a>,
}

/// Told after every iteration, or of large surfaces after every few tiles of a pass;
/// [`ControlFlow::Break`] stops the optimisation with what it has. The work waits until it returns.
pub type Observer<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

/// The vertices at a moment of the work. Costs nothing until it is asked.
#[derive(Clone, Copy)]
pub struct Positions<'a> {
    surface: &'a Surface,
    values: Values<'a>,
}

/// Positions from the low ends of the grid edges.
#[derive(Clone, Copy)]
pub(crate) enum Values<'a> {
    Single(&'a [f32]),
    Double(&'a [f64]),
}

impl<'a> Positions<'a> {
    pub(super) fn new<R: Real>(surface: &'a Surface, x: &'a [R]) -> Self {
        Self { surface, values: R::values(x) }
    }

    /// The δ of every vertex, as [`Optimum::delta`](crate::optimize::Optimum::delta) would have them if
    /// the work ended here, rounded to single precision. Where volumes are kept they are so only after
    /// the last call.
    pub fn deltas(&self) -> Vec<f32> {
        match self.values {
            Values::Single(x) => deltas(self.surface, x),
            Values::Double(x) => deltas(self.surface, x),
        }
    }
}

impl fmt::Debug for Positions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Positions").finish_non_exhaustive()
    }
}

/// The δ of every vertex from its position.
pub(super) fn deltas<R: Real, T: Real>(surface: &Surface, x: &[R]) -> Vec<T> {
    let mut delta = vec![T::default(); x.len()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut delta, ends, |k, delta| {
        let x = &x[surface.slice_vertices(k).start as usize..];
        for ((delta, x), crossing) in delta.iter_mut().zip(x).zip(surface.slice_crossings(k)) {
            *delta = T::from_f64(crossing.from_low(x.to_f64()));
        }
    });
    delta
}
