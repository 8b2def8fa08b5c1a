//! The default method: Gauss–Newton on all vertices at once, within the box.

use crate::optimize::conjugate::{Effort, Room, Workspace};
use crate::optimize::model::Model;
use crate::optimize::problem::Problem;
use crate::optimize::real::Real;
use crate::optimize::report::{Round, Stationarity, Status};
use crate::optimize::settings::{Observer, Progress, Settings};
use crate::optimize::univariate;
use crate::parallel;

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
const SHORT_CHORD: f32 = 0.2;
/// A curve that turns so much that this is above the cosine may sit in a local minimum of one vertex.
const SHARP_TURN: f32 = 0.3;
/// A vertex that would move farther than this if it were alone is awkward; so many sweeps over the
/// awkward ones follow a step, if they are at most one in `FEW`.
const LONG_LONE_STEP: f64 = 0.003;
const AWKWARD_SWEEPS: usize = 5;
const FEW: usize = 20;
/// With a barrier a step covers at most this part of the way to a bound.
const MOST_OF_THE_WAY: f32 = 0.95;

/// Steps until the root mean square of the projected step falls to the tolerance.
pub(super) fn solve<R: Real>(
    problem: &mut Problem<R>,
    x: &mut Vec<R>,
    settings: &Settings,
    observer: &mut Observer,
) -> Vec<Round> {
    let plan: Option<Vec<Effort>> = std::env::var("PLAN").ok().map(|p| p.split(';').map(|g| { let v: Vec<usize> = g.split(',').map(|x| x.parse().unwrap()).collect(); Effort { segment: v[0], segments: v[1], reduction: 1e-3 } }).collect());
    let count = if problem.needs_freezing() && plan.is_none() { ROUNDS } else { 1 };
    let mut solver = Newton::new(problem);
    let mut rounds: Vec<Round> = Vec::new();
    let mut done = 0;
    for round in 0..count {
        let t0 = std::time::Instant::now(); problem.freeze(x); if std::env::var("LAP").is_ok() { eprintln!("  freeze {:.1} ns/v", t0.elapsed().as_secs_f64() * 1e9 / x.len() as f64); }
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

struct Newton<R> {
    model: Model<R>,
    workspace: Workspace,
    is_fixed: Vec<bool>,
}

impl<R: Real> Newton<R> {
    fn new(problem: &Problem<R>) -> Self {
        Self { model: Model::new(problem.network), workspace: Workspace::new(problem.network), is_fixed: vec![false; problem.vertex_count()] }
    }

    fn round(
        &mut self,
        problem: &Problem<R>,
        x: &mut Vec<R>,
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
        problem: &Problem<R>,
        x: &mut Vec<R>,
        energy: f64,
        effort: &Effort,
    ) -> Option<f64> {
        let n = x.len() as f64; let mut t = std::time::Instant::now(); let mut lap = |name: &str| { if std::env::var("LAP").is_ok() { eprintln!("  {name} {:.1} ns/v", t.elapsed().as_secs_f64() * 1e9 / n); } t = std::time::Instant::now(); };
        self.workspace.solve(&self.model, problem.network, &room(problem, x, &self.is_fixed), effort);
        lap("cg");
        let workspace = &self.workspace;
        let [low, high] = problem.bounds.map(R::to_f64);
        let mut together = vec![R::default(); x.len()];
        parallel::fill(&mut together, |v| R::from_f64((x[v].to_f64() + workspace.step(v)).clamp(low, high)));
        lap("move"); let aw = self.awkward(problem, x); lap("awkward");
        repair(problem, &mut together, &aw);
 lap("repair");
        let lower = self.model.linearise(problem, &together);
 lap("linearise");
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
    fn awkward(&self, problem: &Problem<R>, x: &[R]) -> Vec<u32> {
        let far = |v: &u32| {
            let v = *v as usize;
            self.model.lone_step(v, x[v], problem.bounds).abs() > LONG_LONE_STEP
        };
        let list: Vec<u32> = (0..x.len() as u32).filter(far).collect();
        if list.len() <= x.len() / FEW { list } else { Vec::new() }
    }
}

/// How far every vertex may move down and up its grid edge in one step.
fn room<'a, R: Real>(problem: &Problem<R>, x: &'a [R], is_fixed: &'a [bool]) -> Room<'a, R> {
    let part = if problem.has_barrier() { MOST_OF_THE_WAY } else { 1.0 };
    Room { x, bounds: problem.bounds, part, is_fixed }
}

/// One univariate step on every vertex with a very short chord, a scan of the grid edge of every
/// vertex where a curve turns sharply, and sweeps over the awkward ones, each in order.
fn repair<R: Real>(problem: &Problem<R>, x: &mut [R], awkward: &[u32]) {
    let marks = problem.mark_places(x, |squared_length, cosine| {
        u8::from(squared_length < SHORT_CHORD * SHORT_CHORD) | u8::from(cosine < SHARP_TURN) << 1
    });
    for (v, places) in problem.network.places().iter().enumerate() {
        let mark = places.iter().fold(0, |mark, &place| mark | marks[place as usize]);
        if mark & 2 != 0 {
            univariate::scan(problem, x, v as u32);
        }
        if mark != 0 {
            univariate::step(problem, x, v as u32);
        }
    }
    for _ in 0..AWKWARD_SWEEPS {
        for &v in awkward {
            univariate::step(problem, x, v);
        }
    }
}
