//! Volume keeping: every component of the surface encloses as many voxel volumes as voxels.
//!
//! A stationary point of the energy E on the surfaces whose components have volumes V is one of
//! E − Σ λ·V with the right multipliers λ. The surface is worked on tile by tile, so no tile knows a
//! component's volume; instead every vertex is pulled by the constant force λ·∂V/∂x during a round of
//! steps. After it, its component has drifted from its volume: that says how to change λ (a secant),
//! and the component is brought back along its grid edges. Where the drift has died down, λ is right.

use std::ops::ControlFlow;

use crate::optimize::conjugate::Effort;
use crate::optimize::enclosed::{Fans, Gradient, of_triangles};
use crate::optimize::level::{Level, Path};
use crate::optimize::plan::{Passes, STEPS};
use crate::optimize::problem::Conditions;
use crate::optimize::progress::{Observer, Progress};
use crate::optimize::real::Real;
use crate::optimize::relax::{Relaxed, relax};
use crate::optimize::report::{ComponentVolume, Report, Round, Status};
use crate::optimize::settings::Settings;
use crate::parallel;
use crate::surface::{Components, Surface};

/// Rounds for a preset with a fixed number of steps, each of so many.
const ROUNDS: usize = 6;
/// A round of one that converges; the second pass has other tiles.
const ROUND: Passes = Passes::Fixed(&[&STEPS as &[Effort], &STEPS]);
/// The part of a volume that it may be off between rounds, and at the end.
const ROUGHLY: f64 = 1e-5;
const EXACTLY: f64 = 1e-11;
/// How much farther vertices move together than each would alone; a first guess.
const TOGETHER: f64 = 100.0;
/// How often in a row a multiplier may turn out too large, or too small, before what was found about
/// the other side is forgotten.
const MOST_REPEATED: usize = 3;

/// A surface with what its components are to enclose.
pub(super) struct Keeper<'a> {
    surface: &'a Surface,
    components: &'a Components,
    fans: Fans<'a>,
    targets: Vec<f64>,
    bounds: [f64; 2],
    multipliers: Vec<Multiplier>,
    is_held: Vec<bool>,
    /// How the vertices of every component yield to a multiplier; empty while that is not known.
    yields: Vec<f64>,
    /// Whether there was a stage before.
    is_kept: bool,
}

impl<'a> Keeper<'a> {
    pub(super) fn new(surface: &'a Surface, components: &'a Components, bounds: [f64; 2]) -> Self {
        let count = components.count();
        Self {
            surface,
            components,
            fans: Fans::new(surface, components),
            targets: components.voxels().iter().map(|&voxels| voxels as f64).collect(),
            bounds,
            multipliers: vec![Multiplier::default(); count],
            is_held: vec![false; count],
            yields: Vec::new(),
            is_kept: false,
        }
    }

    /// As [`relax`](crate::optimize::relax::relax), with volumes kept.
    pub(super) fn relax<R: Real>(
        &mut self,
        conditions: &Conditions,
        passes: Passes,
        most_steps: usize,
        x: &mut [R],
        observer: &mut Observer,
    ) -> Relaxed {
        let (round, rounds, tolerance, most_steps) = match passes {
            Passes::Fixed(_) => (passes, Some(ROUNDS), 0.0, most_steps),
            Passes::UntilConverged { tolerance, most_steps: own_most } => {
                (ROUND, None, tolerance, most_steps.min(own_most))
            }
        };
        let mut all = Relaxed::new(x.len());
        // What another energy prepared has its volumes already.
        if !std::mem::replace(&mut self.is_kept, true) {
            all = relax(self.surface, conditions, passes, most_steps, x, observer);
            if all.status() == Status::Cancelled {
                return all;
            }
            close(&mut all.rounds, Status::IterationLimit);
        }
        self.yields.clear();
        let mut mean_energy = all.mean_energy.take();
        let mut gradient = self.restore(x);
        let following = Conditions { mean_energy: mean_energy.as_ref(), ..*conditions };
        self.probe(&following, round, x, &gradient);
        for n in 0.. {
            let done = all.steps();
            let mut observer = |progress: Progress| {
                let share = progress.share_done.zip(rounds);
                observer(Progress {
                    iteration: done + progress.iteration,
                    tolerance,
                    share_done: share.map(|(share, rounds)| (n as f64 + share) / rounds as f64),
                    ..progress
                })
            };
            let before = x.to_vec();
            let left = most_steps.saturating_sub(done);
            let following = Conditions { mean_energy: mean_energy.as_ref(), ..*conditions };
            let mut relaxed = self.pull(&following, round, left, x, &gradient, &mut observer);
            mean_energy = relaxed.mean_energy.take();
            let drift = self.drift(x);
            for (n, multiplier) in self.multipliers.iter_mut().enumerate() {
                if !self.is_held[n] {
                    multiplier.adjust(drift[n]);
                }
            }
            gradient = self.restore(x);
            let has_converged =
                relaxed.stationarity.step_rms() <= tolerance && distance(&before, x) <= tolerance;
            let status = match relaxed.status() {
                Status::Preset if has_converged => Status::Converged,
                Status::Preset if relaxed.steps() == 0 => Status::Stalled,
                Status::Preset if rounds.is_none_or(|rounds| n + 1 < rounds) => {
                    Status::IterationLimit
                }
                status => status,
            };
            let is_last = status != Status::IterationLimit || done + relaxed.steps() >= most_steps;
            close(&mut relaxed.rounds, status);
            all.rounds.append(&mut relaxed.rounds);
            (all.stationarity, all.slopes) = (relaxed.stationarity, relaxed.slopes);
            if is_last {
                break;
            }
        }
        all
    }

    /// Finds out how much a round's drift grows with the multipliers: makes a round twice from the same
    /// place, without them and with a first guess of them, which it sets then.
    fn probe<R: Real>(
        &mut self,
        conditions: &Conditions,
        round: Passes,
        x: &[R],
        gradient: &[f64],
    ) {
        let mut squares = vec![0.0; self.targets.len()];
        for (slope, &n) in gradient.iter().zip(self.components.of_vertices()) {
            squares[n as usize] += slope * slope;
        }
        self.multipliers.fill(Multiplier::default());
        let (there, curvature) = self.round(conditions, round, x, gradient);
        let without = self.drift(&there);
        for ((multiplier, drift), squares) in self.multipliers.iter_mut().zip(&without).zip(squares)
        {
            multiplier.response = (TOGETHER * squares / curvature).max(f64::MIN_POSITIVE);
            multiplier.value = -drift / multiplier.response;
        }
        let (pulled, _) = self.round(conditions, round, x, gradient);
        let with = self.drift(&pulled);
        for ((multiplier, without), with) in self.multipliers.iter_mut().zip(without).zip(with) {
            multiplier.respond(without, with);
        }
        self.yields =
            self.normalised(pulled.iter().zip(&there).map(|(a, b)| a.to_f64() - b.to_f64()));
    }

    /// The moves of the vertices, for every component so that the longest one is 1.
    fn normalised(&self, moves: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut moves: Vec<f64> = moves.collect();
        let of_vertices = self.components.of_vertices();
        let mut longest = vec![f64::MIN_POSITIVE; self.targets.len()];
        for (step, &n) in moves.iter().zip(of_vertices) {
            longest[n as usize] = step.abs().max(longest[n as usize]);
        }
        parallel::update(&mut moves, |v, step| *step /= longest[of_vertices[v] as usize]);
        moves
    }

    /// Where a round would lead, and the mean curvature there.
    fn round<R: Real>(
        &self,
        conditions: &Conditions,
        round: Passes,
        x: &[R],
        gradient: &[f64],
    ) -> (Vec<R>, f64) {
        let mut x = x.to_vec();
        let go_on: &mut Observer = &mut |_| ControlFlow::Continue(());
        let relaxed = self.pull(conditions, round, usize::MAX, &mut x, gradient, go_on);
        (x, relaxed.stationarity.mean_curvature().max(f64::MIN_POSITIVE))
    }

    /// A round with every vertex pulled by the multipliers.
    fn pull<R: Real>(
        &self,
        conditions: &Conditions,
        round: Passes,
        most_steps: usize,
        x: &mut [R],
        gradient: &[f64],
        observer: &mut Observer,
    ) -> Relaxed {
        let mut forces = vec![0.0; gradient.len()];
        let of_vertices = self.components.of_vertices();
        parallel::fill(&mut forces, |v| {
            (self.multipliers[of_vertices[v] as usize].value * gradient[v]) as f32
        });
        let conditions = Conditions { forces: Some(&forces), ..*conditions };
        relax(self.surface, &conditions, round, most_steps, x, observer)
    }

    /// What was kept, for the report, with the fans' volumes.
    pub(super) fn volumes<R: Real>(&self, x: &[R]) -> Vec<ComponentVolume> {
        let unit = self.surface.grid().voxel_volume();
        let reached = self.fans.volumes(&in_double(x));
        let of_component = |n: usize| ComponentVolume {
            target: self.targets[n] * unit,
            reached: reached[n] * unit,
            multiplier: self.multipliers[n].value / unit,
            is_held: self.is_held[n],
        };
        (0..reached.len()).map(of_component).collect()
    }

    /// By how much every component is too large.
    fn drift<R: Real>(&self, x: &[R]) -> Vec<f64> {
        let volumes = self.fans.volumes(&in_double(x));
        volumes.iter().zip(&self.targets).map(|(volume, target)| volume - target).collect()
    }

    /// Brings every component back to its volume, along the way it yields as far as that leads there;
    /// returns the gradient of the volumes there.
    fn restore<R: Real>(&mut self, x: &mut [R]) -> Vec<f64> {
        let start = in_double(x);
        let mut gradient = self.fans.gradient(&start);
        let mut found = start;
        if !self.yields.is_empty() {
            let offsets = std::mem::replace(&mut gradient.offsets, self.yields.clone());
            found = self.level(&found, &gradient).x;
            gradient.offsets = offsets;
        }
        let Level { x: found, is_held, .. } = self.level(&found, &gradient);
        self.is_held = is_held;
        for (x, found) in x.iter_mut().zip(&found) {
            *x = R::from_f64(*found);
        }
        self.fans.gradient(&found).slopes
    }

    fn level(&self, start: &[f64], gradient: &Gradient) -> Level {
        level(self.components, (start, gradient), &self.targets, (self.bounds, ROUGHLY), |x| {
            self.fans.volumes(x)
        })
    }
}

/// What a component's volume costs.
#[derive(Debug, Clone, Copy, Default)]
struct Multiplier {
    value: f64,
    /// How much a round's drift grows with it.
    response: f64,
    /// The last value that was too small and the last that was too large.
    ends: [Option<Trial>; 2],
    /// Which of the two was the latest, and how often in a row.
    latest: (usize, usize),
}

/// A value of a multiplier and the drift that followed.
#[derive(Debug, Clone, Copy)]
struct Trial {
    value: f64,
    drift: f64,
}

impl Multiplier {
    /// Takes in the drift of a round: false position (the Illinois rule) where the value is known to lie
    /// between two others, else what the response says. The surface changes meanwhile, so that what
    /// was found before may not hold any more.
    fn adjust(&mut self, drift: f64) {
        let side = usize::from(drift > 0.0);
        let repeated = if self.latest.0 == side { self.latest.1 + 1 } else { 1 };
        self.latest = (side, repeated);
        if let (true, Some(other)) = (repeated > 1, &mut self.ends[1 - side]) {
            other.drift *= 0.5;
        }
        if let Some(before) = self.ends[side] {
            let found = (drift - before.drift) / (self.value - before.value);
            if found > 0.0 && found.is_finite() {
                let [least, most] = [0.5, 8.0].map(|factor| factor * self.response);
                self.response = found.clamp(least, most);
            }
        }
        self.ends[side] = Some(Trial { value: self.value, drift });
        self.value = match self.ends {
            [Some(low), Some(high)] if low.value < high.value && repeated <= MOST_REPEATED => {
                let slope = (high.drift - low.drift) / (high.value - low.value);
                self.response = slope;
                low.value - low.drift / slope
            }
            _ => {
                self.ends[1 - side] = None;
                self.value - drift / self.response
            }
        };
    }

    /// Takes in the drifts of two rounds from the same place, without a multiplier and with this one.
    fn respond(&mut self, without: f64, with: f64) {
        let found = (with - without) / self.value;
        let response = if found > 0.0 && found.is_finite() { found } else { self.response };
        *self = Self { value: -without / response, response, ..Self::default() };
    }
}

/// Moves the vertices of every component along their grid edges, little as a rule, until the mesh of
/// these triangles encloses what [`VolumeRule::Keep`](crate::optimize::VolumeRule::Keep) asks for,
/// within the bounds on δ; puts the volumes into the report.
///
/// `triangles` name vertices of the surface, turned as those of [`TriMesh`](crate::TriMesh) are;
/// `optimize` keeps the volumes of no triangles in particular, so that they can be chosen to fit its
/// result.
///
/// # Panics
/// When `delta` has not one value per vertex.
pub fn keep_volumes(
    surface: &Surface,
    triangles: &[[u32; 3]],
    settings: &Settings,
    delta: &mut [f64],
    report: &mut Report,
) {
    assert_eq!(delta.len(), surface.vertex_count(), "one delta per vertex");
    let components = surface.components();
    let bounds = settings.bounds();
    // δ from the position and the position from δ are the same reflection.
    let start: Vec<f64> = surface.crossings().zip(&*delta).map(|(c, &d)| c.from_low(d)).collect();
    let turn = if surface.grid().is_mirrored() { -1.0 } else { 1.0 };
    let targets: Vec<f64> = components.voxels().iter().map(|&voxels| voxels as f64).collect();
    let gradient = Fans::new(surface, &components).gradient(&start);
    let level = level(&components, (&start, &gradient), &targets, (bounds, EXACTLY), |x| {
        let volumes = of_triangles(surface, &components, triangles, x);
        volumes.into_iter().map(|volume| turn * volume).collect()
    });
    for ((delta, crossing), x) in delta.iter_mut().zip(surface.crossings()).zip(level.x) {
        *delta = crossing.from_low(x).clamp(bounds[0], bounds[1]);
    }
    let unit = surface.grid().voxel_volume();
    let multipliers: Vec<f64> = report.volumes.iter().map(|volume| volume.multiplier).collect();
    let of_component = |n: usize| ComponentVolume {
        target: targets[n] * unit,
        reached: level.volumes[n] * unit,
        multiplier: multipliers.get(n).copied().unwrap_or_default(),
        is_held: level.is_held[n],
    };
    report.volumes = (0..targets.len()).map(of_component).collect();
}

/// Brings every component to its volume, as evenly outwards or inwards as the grid edges allow.
fn level(
    components: &Components,
    (start, gradient): (&[f64], &Gradient),
    targets: &[f64],
    (bounds, tolerance): ([f64; 2], f64),
    volumes: impl Fn(&[f64]) -> Vec<f64>,
) -> Level {
    let of_vertices = components.of_vertices();
    let mut slopes = vec![0.0; components.count()];
    for ((slope, offset), &n) in gradient.slopes.iter().zip(&gradient.offsets).zip(of_vertices) {
        slopes[n as usize] += slope * offset;
    }
    Path { of_vertices, start, directions: &gradient.offsets, bounds }
        .level(targets, &slopes, tolerance, volumes)
}

/// Lets the last of some rounds end like this, and the others with the next one.
fn close(rounds: &mut [Round], status: Status) {
    if let Some((last, others)) = rounds.split_last_mut() {
        others.iter_mut().for_each(|round| round.status = Status::IterationLimit);
        last.status = status;
    }
}

fn in_double<R: Real>(x: &[R]) -> Vec<f64> {
    x.iter().map(|x| x.to_f64()).collect()
}

/// Root mean square.
fn distance<R: Real>(a: &[R], b: &[R]) -> f64 {
    let square = |(a, b): (&R, &R)| (a.to_f64() - b.to_f64()).powi(2);
    (a.iter().zip(b).map(square).sum::<f64>() / a.len().max(1) as f64).sqrt()
}
