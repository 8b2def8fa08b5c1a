//! One step of the default method: Gauss–Newton on all vertices at once, within the box.

use crate::network::Network;
use crate::optimize::bounds::cut;
use crate::optimize::conjugate::{Effort, Room, Workspace};
use crate::optimize::model::Model;
use crate::optimize::problem::{Problem, Value};
use crate::optimize::real::Real;
use crate::optimize::univariate;
use crate::parallel::{self, NONE};

/// Chords below this part of the smallest spacing get a repair: there the linearised energy, whose
/// derivatives grow with the inverse of the length, is worth little.
const SHORT_CHORD: f32 = 0.2;
/// A curve that turns so much that this is above the cosine may sit in a local minimum of one vertex.
const SHARP_TURN: f32 = 0.3;
/// A vertex that would move farther than this if it were alone is awkward; so many sweeps over the
/// awkward ones follow a step, if they are at most one in `FEW`.
const LONG_LONE_STEP: f64 = 0.003;
const AWKWARD_SWEEPS: usize = 5;
const FEW: usize = 20;
/// See [`Step::moved`].
const FAR: f64 = 0.01;
/// With a barrier a step covers at most this part of the way to a bound.
const MOST_OF_THE_WAY: f32 = 0.95;

/// The working state of a solver on one network.
pub(super) struct Newton<R> {
    pub(super) model: Model<R>,
    workspace: Workspace,
}

/// A step that lowered the energy.
pub(super) struct Step {
    /// The energy after it.
    pub(super) value: Value,
    /// The sum of the squares of what the vertices moved, in edge lengths, at most `FAR` each: a few
    /// at creases may go on for long without the surface gaining by it.
    pub(super) moved: f64,
}

impl Step {
    fn to<R: Real>(value: Value, x: &mut Vec<R>, new: Vec<R>) -> Self {
        let square = |(a, b): (&R, &R)| (a.to_f64() - b.to_f64()).abs().min(FAR).powi(2);
        let moved = x.iter().zip(&new).map(square).sum();
        *x = new;
        Self { value, moved }
    }
}

impl<R: Real> Newton<R> {
    pub(super) fn new(network: &Network) -> Self {
        Self { model: Model::new(network), workspace: Workspace::new(network) }
    }

    /// One step that lowers the energy: of all vertices together, or else vertex by vertex. Returns
    /// nothing when neither helped; the model is linearised where `x` is then.
    pub(super) fn step(
        &mut self,
        problem: &Problem<R>,
        x: &mut Vec<R>,
        energy: Value,
        effort: &Effort,
    ) -> Option<Step> {
        self.workspace.solve(&self.model, problem.network, &room(problem, x), effort, &|_, _| 0.0);
        let [low, high] = problem.bounds.all.map(R::to_f64);
        let mut awkward = Vec::new();
        if effort.converges {
            awkward = self.awkward(problem, x);
        }
        for part in effort.parts {
            let mut together = x.clone();
            parallel::update_blocks(&mut together, NONE, |first, together, []| {
                for (x, &step) in together.iter_mut().zip(&self.workspace.steps()[first..]) {
                    *x = R::from_f64((x.to_f64() + part * f64::from(step)).clamp(low, high));
                }
                cut(together, problem.bounds.own(first));
                0.0
            });
            if effort.repairs {
                repair(problem, &mut together, &awkward);
            }
            let value = self.model.linearise(problem, &together);
            if value.all < energy.all + univariate::ROUNDING * energy.all.abs() {
                return Some(Step::to(value, x, together));
            }
            if effort.converges {
                // What went wrong shows where the step ended.
                awkward = self.awkward(problem, &together);
            }
        }
        // The model misled the step somewhere. Alone, every vertex with a slope left can go down.
        let mut alone = x.clone();
        let all: Vec<u32> = (0..x.len() as u32).collect();
        repair(problem, &mut alone, &all);
        let value = self.model.linearise(problem, &alone);
        if value.all < energy.all {
            return Some(Step::to(value, x, alone));
        }
        self.model.linearise(problem, x);
        None
    }

    /// The vertices that would move far if they were alone, unless they are many: few, they sit in
    /// thin parts where the model is worth little; many, the step takes care of them.
    fn awkward(&self, problem: &Problem<R>, x: &[R]) -> Vec<u32> {
        let far = |v: &u32| {
            let v = *v as usize;
            self.model.lone_step(v, x[v], problem.bounds.of(v)).abs() > LONG_LONE_STEP
        };
        let list: Vec<u32> = (0..x.len() as u32).filter(far).collect();
        if list.len() <= x.len() / FEW { list } else { Vec::new() }
    }
}

/// How far every vertex may move down and up its grid edge in one step.
fn room<'a, R: Real>(problem: &'a Problem<R>, x: &'a [R]) -> Room<'a, R> {
    let part = if problem.has_barrier() { MOST_OF_THE_WAY } else { 1.0 };
    Room { x, bounds: &problem.bounds, part, is_fixed: &problem.is_fixed }
}

/// One univariate step on every vertex with a very short chord, a scan of the grid edge of every
/// vertex where a curve turns sharply, and sweeps over the awkward ones, each in order.
fn repair<R: Real>(problem: &Problem<R>, x: &mut [R], awkward: &[u32]) {
    let marks = problem.mark_places(x, |squared_length, cosine| {
        u8::from(squared_length < SHORT_CHORD * SHORT_CHORD) | u8::from(cosine < SHARP_TURN) << 1
    });
    let marks = problem.network.at_vertices(0..x.len(), &marks).map(|[a, b]| a | b);
    for (v, mark) in marks.enumerate().filter(|&(v, mark)| mark != 0 && !problem.is_fixed[v]) {
        if mark & 2 != 0 {
            univariate::scan(problem, x, v as u32);
        }
        univariate::step(problem, x, v as u32);
    }
    for _ in 0..AWKWARD_SWEEPS {
        for &v in awkward.iter().filter(|&&v| !problem.is_fixed[v as usize]) {
            univariate::step(problem, x, v);
        }
    }
}
