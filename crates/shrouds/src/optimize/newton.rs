//! The default method: Gauss–Newton on all vertices at once, within the box.

use crate::optimize::conjugate::{Effort, Room, Workspace};
use crate::optimize::model::Model;
use crate::optimize::problem::Problem;
use crate::optimize::report::{Round, Stationarity, Status};
use crate::optimize::settings::{Observer, Progress, Settings};
use crate::optimize::univariate;
use crate::parallel;

/// The most often that weights and barrier are frozen anew, if the energy has any. They settle sooner:
/// the rounds end with the first that finds nothing to do.
const ROUNDS: usize = 6;
/// Steps in all rounds but the last, which runs until the stop rule is satisfied.
const EARLY_STEPS: usize = 4;
/// Chords below this part of the smallest spacing get a repair: there the linearised energy, whose
/// derivatives grow with the inverse of the length, is worth little.
const SHORT_CHORD: f64 = 0.2;
/// A curve that turns so much that this is above the cosine may sit in a local minimum of one vertex.
const SHARP_TURN: f64 = 0.3;
/// Damping to start with and its limits, and how it changes where a step raised the energy and where
/// it did not.
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-9;
const MOST_DAMPING: f64 = 1e3;
const RAISE: f64 = 8.0;
const LOWER: f64 = 0.3;
/// A rise is a surprise when more than this part of it was not in the model.
const UNEXPECTED: f64 = 0.5;
/// A rise below this part of the energy is rounding.
const NOISE: f64 = 1e-9;
/// With a barrier a step covers at most this part of the way to a bound.
const MOST_OF_THE_WAY: f64 = 0.95;

/// Steps until the root mean square of the projected step falls to the tolerance.
pub(super) fn solve(
    problem: &mut Problem,
    x: &mut Vec<f64>,
    settings: &Settings,
    observer: &mut Observer,
) -> Vec<Round> {
    let count = if problem.needs_freezing() { ROUNDS } else { 1 };
    let mut solver = Newton::new(problem);
    let mut rounds: Vec<Round> = Vec::new();
    let mut done = 0;
    for round in 0..count {
        problem.freeze(x);
        let left = settings.max_iterations() - done;
        let limit = if round + 1 < count { EARLY_STEPS.min(left) } else { left };
        rounds.push(solver.round(problem, x, settings, limit, done, observer));
        done += rounds[round].energies.len() - 1;
        let settled = rounds[round].energies.len() == 1;
        if rounds[round].status == Status::Cancelled || settled {
            break;
        }
    }
    rounds
}

struct Newton {
    model: Model,
    workspace: Workspace,
    /// By how much the diagonal of every vertex is raised, as a factor. It grows only where a step
    /// raised the energy, so that a few awkward places do not hold up the rest.
    damping: Vec<f64>,
    /// The energy by vertex, before and after a step.
    before: Vec<f64>,
    after: Vec<f64>,
}

impl Newton {
    fn new(problem: &Problem) -> Self {
        let count = problem.vertex_count();
        Self {
            model: Model::new(problem),
            workspace: Workspace::new(count),
            damping: vec![FIRST_DAMPING; count],
            before: vec![0.0; count],
            after: vec![0.0; count],
        }
    }

    fn round(
        &mut self,
        problem: &Problem,
        x: &mut Vec<f64>,
        settings: &Settings,
        limit: usize,
        done: usize,
        observer: &mut Observer,
    ) -> Round {
        let mut energy = problem.value(x);
        let mut round = Round::new(energy);
        let tolerance = settings.tolerance();
        for step in 0..=limit {
            self.model.linearise(problem, x);
            let change = Stationarity::of(&self.model, x, problem.bounds).step_rms();
            let progress = Progress { iteration: done + step, energy, change, tolerance };
            if observer(progress).is_break() {
                round.status = Status::Cancelled;
                break;
            }
            if change <= tolerance {
                round.status = Status::Converged;
                break;
            }
            if step == limit {
                break;
            }
            match self.step(problem, x, energy) {
                Some(lower) => energy = lower,
                None => {
                    round.status = Status::Stalled;
                    break;
                }
            }
            round.energies.push(energy);
        }
        round
    }

    /// One step that lowers the energy, with more damping where it rises until it does. Returns the
    /// new energy, or nothing when no attempt helped.
    fn step(&mut self, problem: &Problem, x: &mut Vec<f64>, energy: f64) -> Option<f64> {
        const ATTEMPTS: usize = 8;
        const EFFORT: Effort = Effort { segment: 25, segments: 4, reduction: 1e-2 };
        let room = room(problem, x);
        problem.value_by_vertex(x, &mut self.before);
        for _ in 0..ATTEMPTS {
            self.workspace.solve(&self.model, &room, &self.damping, &EFFORT);
            let mut trial = vec![0.0; x.len()];
            let workspace = &self.workspace;
            let [low, high] = problem.bounds;
            parallel::fill(&mut trial, |v| (x[v] + workspace.step(v)).clamp(low, high));
            repair(problem, &mut trial);
            let mut lower = problem.value_by_vertex(&trial, &mut self.after);
            let rises = self.rises(problem, x, &trial);
            if std::env::var("LAB").is_ok() {
                eprintln!(
                    "    E {energy:.4} trial {lower:.4} rises {}",
                    rises.iter().filter(|&&r| r).count()
                );
            }
            let mut kept = trial.clone();
            parallel::update(&mut kept, |v, kept| {
                if rises[v] {
                    *kept = x[v];
                }
            });
            let value = problem.value(&kept);
            if value < lower {
                lower = value;
                trial = kept;
            }
            let fell = lower < energy;
            parallel::update(&mut self.damping, |v, damping| {
                if rises[v] {
                    *damping = (*damping * RAISE).clamp(FIRST_DAMPING, MOST_DAMPING);
                } else if fell {
                    *damping = (*damping * LOWER).max(LEAST_DAMPING);
                }
            });
            if fell {
                *x = trial;
                return Some(lower);
            }
        }
        None
    }

    /// Whether the energy of a vertex and its neighbours together rose by a step although the model
    /// did not expect it to.
    fn rises(&self, problem: &Problem, x: &[f64], trial: &[f64]) -> Vec<bool> {
        let mut surprise = vec![[0.0; 2]; x.len()];
        parallel::fill(&mut surprise, |v| {
            let change = self.after[v] - self.before[v];
            let expected = self.model.expected_change(v, |u| trial[u] - x[u]);
            [change, change - expected]
        });
        let mut rises = vec![false; x.len()];
        parallel::fill(&mut rises, |v| {
            let beside = (0..4).filter_map(|slot| problem.network.neighbour(v as u32, slot));
            let [change, unexpected] = beside
                .map(|(u, _)| surprise[u as usize])
                .fold(surprise[v], |a, b| [a[0] + b[0], a[1] + b[1]]);
            change > NOISE * self.before[v] && unexpected > UNEXPECTED * change
        });
        rises
    }
}

/// How far every vertex may move down and up its grid edge in one step.
fn room(problem: &Problem, x: &[f64]) -> Room {
    let [low, high] = problem.bounds;
    let part = if problem.has_barrier() { MOST_OF_THE_WAY } else { 1.0 };
    let mut room = Room { low: vec![0.0; x.len()], high: vec![0.0; x.len()] };
    parallel::fill(&mut room.low, |v| part * (low - x[v]));
    parallel::fill(&mut room.high, |v| part * (high - x[v]));
    room
}

/// One univariate step on every vertex with a very short chord, and a scan of the grid edge of every
/// vertex where a curve turns sharply, in order.
fn repair(problem: &Problem, x: &mut [f64]) {
    let lists = parallel::blocks(x.len(), 4096, |range| {
        let shape = |v: u32| (v, problem.shape_at(x, v));
        let bad = |&(_, (chord, cosine)): &(u32, (f64, f64))| {
            chord < SHORT_CHORD * SHORT_CHORD || cosine < SHARP_TURN
        };
        (range.start as u32..range.end as u32).map(shape).filter(bad).collect::<Vec<_>>()
    });
    for (v, (_, cosine)) in lists.concat() {
        if cosine < SHARP_TURN {
            univariate::scan(problem, x, v);
        }
        univariate::step(problem, x, v);
    }
}
