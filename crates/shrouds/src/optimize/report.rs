//! What an optimisation says about itself.

use crate::optimize::bounds::Bounds;
use crate::optimize::model::Model;
use crate::optimize::problem::Problem;
use crate::optimize::real::Real;

/// What rounding may add to the energy, as a part of it.
const ROUNDING: f64 = 1e-12;

/// How an optimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Status {
    /// The stop rule is satisfied.
    Converged,
    /// No step lowers the energy any more, though the stop rule is not satisfied.
    Stalled,
    /// The preset's steps are done, without a claim to have converged.
    Preset,
    /// The iterations ran out.
    IterationLimit,
    /// The observer stopped it.
    Cancelled,
    /// There was no vertex to move.
    #[default]
    Empty,
}

impl Status {
    /// The status in words, as the report file has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Stalled => "stalled",
            Self::Preset => "preset done",
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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// How it ended.
    pub status: Status,
    /// Iterations (Gauss–Newton steps or sweeps) over all rounds.
    pub iterations: usize,
    /// Energy at the start of the first round that is not preparation, and of the result, each with
    /// the weights and barrier in force. Where volumes are kept, the energy that counts is less the
    /// work of the multipliers since the last weights, which dies down.
    pub energy: [f64; 2],
    /// Euclidean norm of the projected gradient of the energy with respect to the positions: zero
    /// components where a bound holds the vertex.
    pub projected_gradient: f64,
    /// Root mean square over the vertices of the step that would minimise the energy's local model
    /// in one vertex alone, cut at the bounds, in grid edge lengths.
    pub projected_step_rms: f64,
    /// The largest such step.
    pub projected_step_max: f64,
    /// No vertex can lower the energy by more than this by moving alone, to second order.
    pub largest_gain: f64,
    /// The energy is at most this far above its minimum, with the weights in force: the duality gap
    /// `max over y in the box of ∇E(x)·(x − y)`. Only for convex energies, worked on in double
    /// precision.
    pub energy_gap: Option<f64>,
    /// Share of the vertices that sit at a bound, from 0 to 1.
    pub at_bound: f64,
    /// The rounds, in order.
    pub rounds: Vec<Round>,
    /// How many rounds at the beginning prepared the work with another energy.
    pub prepared: usize,
    /// The volumes of the surface's components in the order of [`Surface::components`], where they are
    /// kept ([`VolumeRule::Keep`]); else empty.
    ///
    /// [`Surface::components`]: crate::surface::Surface::components
    /// [`VolumeRule::Keep`]: crate::optimize::VolumeRule::Keep
    pub volumes: Vec<ComponentVolume>,
}

/// The volume of a connected component of the surface, in cubic world units; negative where it bounds a
/// cavity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComponentVolume {
    /// The number of voxels that the component encloses times the volume of one.
    pub target: f64,
    /// What it came to.
    pub reached: f64,
    /// The Lagrange multiplier: how fast the least energy grows with the target, for each unit of
    /// volume.
    pub multiplier: f64,
    /// Whether the bounds on δ keep it from its target.
    pub is_held: bool,
}

impl ComponentVolume {
    /// How far it is from its target, as part of it.
    pub fn relative_error(&self) -> f64 {
        (self.reached / self.target - 1.0).abs()
    }
}

/// How far a state is from satisfying the conditions of a minimum.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stationarity {
    gradient_squared: f64,
    curvature: f64,
    step_squared: f64,
    step_max: f64,
    gain_max: f64,
    gap: f64,
    at_bound: usize,
    count: usize,
    /// Whether the gap bounds the distance to the minimum.
    pub(super) is_certain: bool,
}

impl Stationarity {
    /// That of the vertices that are not foreign.
    pub(super) fn of<R: Real>(
        model: &Model<R>,
        x: &[R],
        bounds: &Bounds<R>,
        is_foreign: &[bool],
    ) -> Self {
        let mut sum = Self::default();
        for (v, &x) in x.iter().enumerate().filter(|&(v, _)| !is_foreign[v]) {
            let [low, high] = bounds.of(v);
            let gradient = model.gradient(v);
            let step = model.lone_step(v, x, [low, high]);
            sum.gradient_squared += free_slope(model, v, x, [low, high]).powi(2);
            sum.curvature += model.diagonal(v);
            sum.step_squared += step * step;
            sum.step_max = sum.step_max.max(step.abs());
            let gain = -step * (gradient + 0.5 * model.diagonal(v) * step);
            sum.gain_max = sum.gain_max.max(gain);
            let room = if gradient > 0.0 { x - low } else { x - high };
            sum.gap += gradient * room.to_f64();
            sum.at_bound += usize::from(x <= low || x >= high);
            sum.count += 1;
        }
        sum
    }

    /// Takes in that of other vertices.
    pub(super) fn add(&mut self, other: Self) {
        self.gradient_squared += other.gradient_squared;
        self.curvature += other.curvature;
        self.step_squared += other.step_squared;
        self.step_max = self.step_max.max(other.step_max);
        self.gain_max = self.gain_max.max(other.gain_max);
        self.gap += other.gap;
        self.at_bound += other.at_bound;
        self.count += other.count;
    }

    /// See [`Report::projected_gradient`].
    pub(super) fn gradient(&self) -> f64 {
        self.gradient_squared.sqrt()
    }

    /// The mean over the vertices of the second derivative by the position of one alone.
    pub(super) fn mean_curvature(&self) -> f64 {
        self.curvature / self.count.max(1) as f64
    }

    pub(super) fn step_rms(&self) -> f64 {
        (self.step_squared / self.count.max(1) as f64).sqrt()
    }
}

/// The norm of the gradient where the model stands, without what the bounds hold.
pub(super) fn free_gradient<R: Real>(model: &Model<R>, problem: &Problem<R>, x: &[R]) -> f64 {
    let slopes = x.iter().enumerate().map(|(v, &x)| free_slope(model, v, x, problem.bounds.of(v)));
    slopes.map(|slope| slope * slope).sum::<f64>().sqrt()
}

/// How the energy changes with the position of a vertex; 0 where a bound holds it.
fn free_slope<R: Real>(model: &Model<R>, v: usize, x: R, [low, high]: [R; 2]) -> f64 {
    let slope = model.gradient(v);
    let is_held = (x <= low && slope > 0.0) || (x >= high && slope < 0.0);
    if is_held { 0.0 } else { slope }
}

impl Report {
    /// The report of an optimisation that took these rounds, the first of them in preparation.
    pub(super) fn new(rounds: Vec<Round>, prepared: usize, stationarity: &Stationarity) -> Self {
        let first = rounds[prepared..].first().and_then(|round| round.energies.first());
        let last = rounds.last().and_then(|round| round.energies.last());
        let energy = [first, last].map(|energy| energy.copied().unwrap_or_default());
        let status = rounds.last().map_or(Status::Empty, |round| round.status);
        Self {
            status,
            iterations: rounds.iter().map(|round| round.energies.len() - 1).sum(),
            energy,
            projected_gradient: stationarity.gradient(),
            projected_step_rms: stationarity.step_rms(),
            projected_step_max: stationarity.step_max,
            largest_gain: stationarity.gain_max,
            energy_gap: stationarity
                .is_certain
                .then(|| stationarity.gap + ROUNDING * energy[1].abs()),
            at_bound: stationarity.at_bound as f64 / stationarity.count.max(1) as f64,
            rounds,
            prepared,
            volumes: Vec::new(),
        }
    }
}
