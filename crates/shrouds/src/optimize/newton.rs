//! The default method: Gauss–Newton on all vertices at once, within the box.

use crate::optimize::conjugate::{Effort, Room, Workspace};
use crate::optimize::model::Model;
use crate::optimize::problem::Problem;
use crate::optimize::report::{Round, Stationarity, Status};
use crate::optimize::settings::{Observer, Progress, Settings};
use crate::optimize::univariate;
use crate::parallel::{self, NONE};

/// The most often that weights and barrier are frozen anew, if the energy has any. They settle sooner:
/// the rounds end with the first that finds nothing to do.
const ROUNDS: usize = 12;
/// Steps in all rounds but the last, which runs until the stop rule is satisfied; such a round also
/// ends when a step lowers the energy by less than `EARLY_DECREASE`, unless by so little that the
/// round may well be the last.
const EARLY_STEPS: usize = 4;
const EARLY_DECREASE: f64 = 0.02;
const SETTLED: f64 = 1e-3;
/// Chords below this part of the smallest spacing get a repair: there the linearised energy, whose
/// derivatives grow with the inverse of the length, is worth little.
const SHORT_CHORD: f64 = 0.2;
/// A curve that turns so much that this is above the cosine may sit in a local minimum of one vertex.
const SHARP_TURN: f64 = 0.3;
/// A vertex that would move farther than this if it were alone is awkward; so many sweeps over the
/// awkward ones follow a step, if they are at most one in `FEW`.
const LONG_LONE_STEP: f64 = 0.003;
const AWKWARD_SWEEPS: usize = 5;
const FEW: usize = 20;
/// With a barrier a step covers at most this part of the way to a bound.
const MOST_OF_THE_WAY: f64 = 0.95;

/// Steps until the root mean square of the projected step falls to the tolerance.
pub(super) fn solve(
    problem: &mut Problem,
    x: &mut Vec<f64>,
    settings: &Settings,
    observer: &mut Observer,
) -> Vec<Round> {
    let plan: Option<Vec<Effort>> = std::env::var("PLAN").ok().map(|p| p.split(';').map(|g| { let v: Vec<usize> = g.split(',').map(|x| x.parse().unwrap()).collect(); Effort { segment: v[0], segments: v[1], reduction: 1e-3 } }).collect());
    let count = if problem.needs_freezing() && plan.is_none() { ROUNDS } else { 1 };
    let mut solver = Newton::new(problem);
    let mut rounds: Vec<Round> = Vec::new();
    let mut done = 0;
    for round in 0..count {
        problem.freeze(x);
        let left = settings.max_iterations() - done;
        let early = round + 1 < count;
        let steps = if early { EARLY_STEPS.min(left) } else { left };
        let steps = plan.as_ref().map_or(steps, |p| p.len());
        let limits = Limits { steps, done, early, plan: plan.clone() };
        rounds.push(solver.round(problem, x, settings, &limits, observer));
        done += rounds[round].energies.len() - 1;
        let settled =
            rounds[round].energies.len() <= 2 && rounds[round].status == Status::Converged;
        if rounds[round].status == Status::Cancelled || settled {
            break;
        }
    }
    rounds
}

/// Limits of one round.
struct Limits {
    /// The most steps to take.
    steps: usize,
    /// Steps taken in earlier rounds.
    done: usize,
    /// Whether another round follows.
    early: bool,
    plan: Option<Vec<Effort>>,
}

impl Limits {
    fn effort(&self, step: usize) -> Effort {
        match &self.plan {
            Some(plan) => plan[step],
            None => Effort { segment: 25, segments: 4, reduction: 1e-2 },
        }
    }
}

struct Newton {
    model: Model,
    workspace: Workspace,
}

impl Newton {
    fn new(problem: &Problem) -> Self {
        Self { model: Model::new(problem), workspace: Workspace::new(problem.network) }
    }

    fn round(
        &mut self,
        problem: &Problem,
        x: &mut Vec<f64>,
        settings: &Settings,
        limits: &Limits,
        observer: &mut Observer,
    ) -> Round {
        let mut energy = self.model.linearise(problem, x);
        let mut round = Round::new(energy);
        let tolerance = settings.tolerance();
        let mut decrease = f64::INFINITY;
        for step in 0..=limits.steps {
            let change = Stationarity::of(&self.model, x, problem.bounds).step_rms();
            let progress = Progress { iteration: limits.done + step, energy, change, tolerance };
            if observer(progress).is_break() {
                round.status = Status::Cancelled;
                break;
            }
            // Smooth errors hardly move a vertex alone, so the energy has to settle too.
            if change <= tolerance && decrease <= tolerance * energy {
                round.status = Status::Converged;
                break;
            }
            // Weights that will change anyway are not worth the last percents.
            let enough =
                limits.early && (SETTLED * energy..EARLY_DECREASE * energy).contains(&decrease);
            if step == limits.steps || enough {
                break;
            }
            let Some(lower) = self.step(problem, x, energy, &limits.effort(step)) else {
                let stationary = change <= tolerance;
                round.status = if stationary { Status::Converged } else { Status::Stalled };
                break;
            };
            decrease = energy - lower;
            energy = lower;
            round.energies.push(energy);
        }
        round
    }

    /// One step that lowers the energy: of all vertices together, or else vertex by vertex. Returns
    /// the new energy, with the model linearised there, or nothing when neither helped.
    fn step(
        &mut self,
        problem: &Problem,
        x: &mut Vec<f64>,
        energy: f64,
        effort: &Effort,
    ) -> Option<f64> {
        self.workspace.solve(&self.model, problem.network, &room(problem, x), effort);
        let workspace = &self.workspace;
        let [low, high] = problem.bounds;
        let mut together = vec![0.0; x.len()];
        parallel::fill(&mut together, |v| (x[v] + workspace.step(v)).clamp(low, high));
        repair(problem, &mut together, &self.awkward(problem, x));
        let lower = self.model.linearise(problem, &together);
        if lower < energy + univariate::ROUNDING * energy.abs() {
            *x = together;
            return Some(lower);
        }
        // The model misled the step somewhere. Alone, every vertex with a slope left can go down.
        let mut alone = x.clone();
        let all: Vec<u32> = (0..x.len() as u32).collect();
        repair(problem, &mut alone, &all);
        let lower = self.model.linearise(problem, &alone);
        (lower < energy).then(|| {
            *x = alone;
            lower
        })
    }

    /// The vertices that would move far if they were alone, unless they are many: few, they sit in
    /// thin parts where the model is worth little; many, the step takes care of them.
    fn awkward(&self, problem: &Problem, x: &[f64]) -> Vec<u32> {
        let far = |v: &u32| {
            let v = *v as usize;
            self.model.lone_step(v, x[v], problem.bounds).abs() > LONG_LONE_STEP
        };
        let list: Vec<u32> = (0..x.len() as u32).filter(far).collect();
        if list.len() <= x.len() / FEW { list } else { Vec::new() }
    }
}

/// How far every vertex may move down and up its grid edge in one step.
fn room(problem: &Problem, x: &[f64]) -> Room {
    let [low, high] = problem.bounds;
    let part = if problem.has_barrier() { MOST_OF_THE_WAY } else { 1.0 };
    let mut room = Room { low: vec![0.0; x.len()], high: vec![0.0; x.len()] };
    parallel::fill(&mut room.low, |v| (part * (low - x[v])) as f32);
    parallel::fill(&mut room.high, |v| (part * (high - x[v])) as f32);
    room
}

/// One univariate step on every vertex with a very short chord, a scan of the grid edge of every
/// vertex where a curve turns sharply, and sweeps over the awkward ones, each in order.
fn repair(problem: &Problem, x: &mut [f64], awkward: &[u32]) {
    let places = problem.network.vertices().len();
    let mut marks = vec![0u8; places];
    parallel::update_blocks(&mut marks, NONE, |first, marks, []| {
        problem.mark_places(x, first..first + marks.len(), |place, chord, cosine| {
            marks[place - first] = u8::from(chord < SHORT_CHORD * SHORT_CHORD)
                | u8::from(cosine < SHARP_TURN) << 1;
        });
        0.0
    });
    for v in 0..x.len() as u32 {
        let mark = (0..2).map(|c| problem.network.place(v, c)).filter(|&p| problem.counts(p));
        let mark = mark.fold(0, |mark, place| mark | marks[place]);
        if mark & 2 != 0 {
            univariate::scan(problem, x, v);
        }
        if mark != 0 {
            univariate::step(problem, x, v);
        }
    }
    for _ in 0..AWKWARD_SWEEPS {
        for &v in awkward {
            univariate::step(problem, x, v);
        }
    }
}
