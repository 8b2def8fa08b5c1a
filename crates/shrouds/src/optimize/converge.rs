//! Steps until nothing is left to do: the preset `exact`.

use crate::optimize::conjugate::Effort;
use crate::optimize::newton::Newton;
use crate::optimize::problem::Problem;
use crate::optimize::real::Real;
use crate::optimize::report::{Round, Stationarity, Status};
use crate::optimize::settings::{Observer, Progress, Settings};

/// The most often that weights and barrier are frozen anew, if the energy has any. They settle sooner:
/// the rounds end with the first that finds nothing to do.
const ROUNDS: usize = 24;
/// Steps in all rounds but the last, which runs until the stop rule is satisfied; such a round also
/// ends when a step lowers the energy by less than `EARLY_DECREASE`, unless by so little that the
/// round may well be the last.
const EARLY_STEPS: usize = 4;
const EARLY_DECREASE: f64 = 0.02;
const SETTLED: f64 = 1e-3;
/// Effort for one step.
const EFFORT: Effort =
    Effort { segment: 25, segments: 4, reduction: 1e-2, repairs: true, converges: true };

/// Steps until the root mean square of the projected step falls to the tolerance.
pub(super) fn solve<R: Real>(
    problem: &mut Problem<R>,
    x: &mut Vec<R>,
    settings: &Settings,
    observer: &mut Observer,
) -> (Vec<Round>, Stationarity) {
    let count = if problem.needs_freezing() { ROUNDS } else { 1 };
    let mut newton = Newton::new(problem.network);
    let mut rounds: Vec<Round> = Vec::new();
    let mut done = 0;
    for n in 0..count {
        problem.freeze(x);
        let left = settings.max_iterations() - done;
        let early = n + 1 < count;
        let steps = if early { EARLY_STEPS.min(left) } else { left };
        let limits = Limits { steps, done, early };
        rounds.push(round(&mut newton, problem, x, settings, &limits, observer));
        done += rounds[n].energies.len() - 1;
        let settled = rounds[n].energies.len() <= 2 && rounds[n].status == Status::Converged;
        if rounds[n].status == Status::Cancelled || settled {
            break;
        }
    }
    let stationarity = Stationarity::of(&newton.model, x, problem.bounds, &problem.is_fixed);
    (rounds, stationarity)
}

/// Limits of one round.
struct Limits {
    /// The most steps to take.
    steps: usize,
    /// Steps taken in earlier rounds.
    done: usize,
    /// Whether another round follows.
    early: bool,
}

fn round<R: Real>(
    newton: &mut Newton<R>,
    problem: &Problem<R>,
    x: &mut Vec<R>,
    settings: &Settings,
    limits: &Limits,
    observer: &mut Observer,
) -> Round {
    let mut energy = newton.model.linearise(problem, x);
    let mut round = Round::new(energy.all);
    let tolerance = settings.tolerance();
    let mut decrease = f64::INFINITY;
    for step in 0..=limits.steps {
        let change =
            Stationarity::of(&newton.model, x, problem.bounds, &problem.is_fixed).step_rms();
        let progress = Progress {
            iteration: limits.done + step,
            energy: energy.all,
            change,
            tolerance,
            share_done: None,
        };
        if observer(progress).is_break() {
            round.status = Status::Cancelled;
            break;
        }
        // Smooth errors hardly move a vertex alone, so the energy has to settle too.
        if change <= tolerance && decrease <= tolerance * energy.all {
            round.status = Status::Converged;
            break;
        }
        // Weights that will change anyway are not worth the last percents.
        let enough =
            limits.early && (SETTLED * energy.all..EARLY_DECREASE * energy.all).contains(&decrease);
        if step == limits.steps || enough {
            break;
        }
        let Some(lower) = newton.step(problem, x, energy, &EFFORT) else {
            let stationary = change <= tolerance;
            round.status = if stationary { Status::Converged } else { Status::Stalled };
            break;
        };
        decrease = energy.all - lower.all;
        energy = lower;
        round.energies.push(energy.all);
    }
    round
}
