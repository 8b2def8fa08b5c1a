//! What an optimisation says about itself.

use crate::optimize::model::Model;
use crate::optimize::problem::Problem;
use crate::optimize::real::Real;

/// How an optimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The stop rule is satisfied.
    Converged,
    /// No step lowers the energy any more, though the stop rule is not satisfied.
    Stalled,
    /// The iterations ran out.
    IterationLimit,
    /// The observer stopped it.
    Cancelled,
    /// There was no vertex to move.
    Empty,
}

impl Status {
    /// The status in words, as the report file has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Stalled => "stalled",
            Self::IterationLimit => "iteration limit",
            Self::Cancelled => "cancelled",
            Self::Empty => "empty",
        }
    }
}

/// A stretch of iterations with the same weights and barrier.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    /// The energy at the start and after every iteration; it never rises.
    pub energies: Vec<f64>,
    /// How the round ended.
    pub status: Status,
}

impl Round {
    pub(super) fn new(energy: f64) -> Self {
        Self { energies: vec![energy], status: Status::IterationLimit }
    }
}

/// What an optimisation did and how good its result is.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// How it ended.
    pub status: Status,
    /// Iterations (Gauss–Newton steps or sweeps) over all rounds.
    pub iterations: usize,
    /// Energy of the start and of the result, both with the weights and barrier of the last round.
    pub energy: [f64; 2],
    /// Euclidean norm of the projected gradient of the energy with respect to the positions: zero
    /// components where a bound holds the vertex.
    pub projected_gradient: f64,
    /// Root mean square over the vertices of the step that would minimise the energy's local model
    /// in one vertex alone, cut at the bounds, in grid edge lengths.
    pub projected_step_rms: f64,
    /// The largest such step.
    pub projected_step_max: f64,
    /// Share of the vertices that sit at a bound, from 0 to 1.
    pub at_bound: f64,
    /// The rounds, in order.
    pub rounds: Vec<Round>,
}

/// How far a state is from satisfying the conditions of a minimum.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stationarity {
    gradient_squared: f64,
    step_squared: f64,
    step_max: f64,
    count: usize,
}

impl Stationarity {
    pub(super) fn of<R: Real>(model: &Model<R>, x: &[R], bounds: [R; 2]) -> Self {
        let mut sum = Self { count: x.len(), ..Self::default() };
        for (v, &x) in x.iter().enumerate() {
            let gradient = model.gradient(v);
            let [low, high] = bounds;
            let held = (x <= low && gradient > 0.0) || (x >= high && gradient < 0.0);
            let step = model.lone_step(v, x, bounds);
            sum.gradient_squared += if held { 0.0 } else { gradient * gradient };
            sum.step_squared += step * step;
            sum.step_max = sum.step_max.max(step.abs());
        }
        sum
    }

    pub(super) fn step_rms(&self) -> f64 {
        (self.step_squared / self.count.max(1) as f64).sqrt()
    }
}

impl Report {
    pub(super) fn new<R: Real>(
        problem: &Problem<R>,
        rounds: Vec<Round>,
        first: &[R],
        x: &[R],
    ) -> Self {
        let mut model = Model::new(problem.network);
        model.linearise(problem, x);
        let stationarity = Stationarity::of(&model, x, problem.bounds);
        let [low, high] = problem.bounds;
        let status = match rounds.last() {
            _ if x.is_empty() => Status::Empty,
            Some(round) => round.status,
            None => Status::IterationLimit,
        };
        let held = x.iter().filter(|&&x| x <= low || x >= high).count();
        Self {
            status,
            iterations: rounds.iter().map(|round| round.energies.len() - 1).sum(),
            energy: [problem.value(first), problem.value(x)],
            projected_gradient: stationarity.gradient_squared.sqrt(),
            projected_step_rms: stationarity.step_rms(),
            projected_step_max: stationarity.step_max,
            at_bound: held as f64 / x.len().max(1) as f64,
            rounds,
        }
    }
}
