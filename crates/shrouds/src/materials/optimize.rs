//! From interfaces to the unknowns that minimise the energy.

use crate::energy::{Bending, Energy, Variation};
use crate::error::Error;
use crate::materials::Settings;
use crate::materials::interfaces::Interfaces;
use crate::materials::keep::LabelVolume;
use crate::materials::network::Curves;
use crate::materials::newton::{Newton, Stage};
use crate::materials::start;
use crate::optimize::{Conditions, Effort, Preset, Problem, Real, Status, thin};

/// Where the points of interfaces are, and how they got there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Optimum {
    /// For each crossing its place along its grid edge, from the low end; then for each junction its
    /// place in its face, from the lowest corner along both axes. All in edge lengths, between 0 and 1.
    pub unknowns: Vec<f64>,
    /// The slopes of the two planar curves of every crossing over its grid edge.
    pub slopes: Vec<[f32; 2]>,
    /// How the optimisation went.
    pub report: Report,
}

/// How an optimisation went.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// How it ended.
    pub status: Status,
    /// The energy at the start of every pass, with its weights and barrier, and after each of its steps.
    pub passes: Vec<Vec<f64>>,
    /// What labels enclose whose volumes were kept, ascending; else empty.
    pub volumes: Vec<LabelVolume>,
}

impl Report {
    /// The number of steps made.
    pub fn steps(&self) -> usize {
        self.passes.iter().map(|energies| energies.len() - 1).sum()
    }
}

const fn effort(iterations: usize, reduction: f64) -> Effort {
    let parts = &[1.0, 0.3, 0.1, 0.0];
    Effort { iterations, reduction, parts, repairs: true, converges: false }
}

const FAST: &[&[Effort]] = &[&[effort(20, 1e-3)]];
const DEFAULT: &[&[Effort]] = &[&[effort(10, 1e-3), effort(20, 1e-3)], &[effort(30, 1e-3)]];
/// Steps of one of many passes.
const PASS: &[Effort] = &[effort(100, 1e-2); 4];
/// The most passes with bending before variation follows.
const PREPARATION: usize = 5;
/// What the bending of junction lines counts beside that of planar curves, and beside their variation, which is far
/// less: enough to tie together what the planes see one by one, and no more.
const BESIDE_BENDING: f64 = 0.2;
const BESIDE_VARIATION: f64 = 0.03;
/// The same with bending where a single step has to tie them.
const IN_ONE_STEP: f64 = 1.0;

/// The unknowns that minimise the energy, or come near it.
///
/// # Errors
/// [`Error::Setting`] when a setting is outside its range.
pub(super) fn optimize(interfaces: &Interfaces, settings: &Settings) -> Result<Optimum, Error> {
    settings.validate()?;
    let bounds = [settings.margin, 1.0 - settings.margin];
    let curves = Curves::trace(interfaces);
    let mut x = start::positions(interfaces, &settings.start, bounds);
    if x.is_empty() {
        return Ok(Optimum::default());
    }
    x.resize(curves.unknown_count(), 0.5);
    curves.place_junctions(bounds, &mut x);
    let solver = Solver::new(interfaces, &curves, settings);
    Ok(match settings.preset {
        Preset::Fast => solver.make(FAST, IN_ONE_STEP, x),
        Preset::Default => solver.make(DEFAULT, BESIDE_BENDING, x),
        Preset::Exact => solver.converge(&x),
    })
}

struct Solver<'a> {
    interfaces: &'a Interfaces,
    curves: &'a Curves,
    settings: &'a Settings,
    bounds: [f64; 2],
    /// In units of the smallest.
    spacing: [f64; 3],
    /// No crossing is known to lie on a flat face along the grid.
    flatness: Vec<f32>,
}

impl<'a> Solver<'a> {
    fn new(interfaces: &'a Interfaces, curves: &'a Curves, settings: &'a Settings) -> Self {
        let unit = interfaces.grid().min_spacing();
        Self {
            interfaces,
            curves,
            settings,
            bounds: [settings.margin, 1.0 - settings.margin],
            spacing: interfaces.grid().spacing().map(|spacing| spacing / unit),
            flatness: vec![0.0; curves.unknown_count()],
        }
    }

    fn conditions<'b>(&'b self, energy: &'b Energy) -> Conditions<'b> {
        Conditions {
            energy,
            spacing: self.spacing,
            bounds: self.bounds,
            intervals: &[],
            flatness: &self.flatness,
            creases: None,
            voxels: None,
            mean_energy: None,
            cells: None,
            forces: None,
        }
    }

    /// Makes some passes with bending and no more.
    fn make(&self, passes: &[&[Effort]], weight_of_lines: f64, mut x: Vec<f32>) -> Optimum {
        let mut optimum = Optimum::default();
        let stage = Stage { measure: &Bending, weight_of_lines, converges: false };
        self.stage(stage, &Bending.into(), &mut x, |work, x| {
            for efforts in passes {
                work.pass(efforts, x);
            }
            work.finish(Status::Preset, x, &mut optimum);
        });
        optimum
    }

    /// Makes passes until they find next to nothing to do, with bending and then with variation.
    fn converge(&self, x: &[f32]) -> Optimum {
        // In double precision the bounds are nearer to their value.
        let [low, high] = self.bounds;
        let mut x: Vec<f64> = x.iter().map(|&x| f64::from(x).clamp(low, high)).collect();
        let mut optimum = Optimum::default();
        let most = self.settings.max_iterations.div_ceil(PASS.len());
        let bending = Stage { measure: &Bending, weight_of_lines: BESIDE_BENDING, converges: true };
        self.stage(bending, &Bending.into(), &mut x, |work, x| {
            let status = work.converge(PREPARATION, x);
            work.finish(status, x, &mut optimum);
        });
        let (measure, weight_of_lines) = (&Variation, BESIDE_VARIATION);
        let variation = Stage { measure, weight_of_lines, converges: true };
        self.stage(variation, &Variation.into(), &mut x, |work, x| {
            let status = work.converge(most, x);
            work.finish(status, x, &mut optimum);
        });
        optimum
    }

    /// 1 at the crossings where a label is one voxel thin, and 0 at all other unknowns.
    fn thinness(&self) -> Vec<f32> {
        let labels = self.interfaces.labels();
        let (ranks, strides) = (labels.ranks(), labels.strides());
        let rank = |point: [usize; 3]| ranks[(0..3).map(|d| point[d] * strides[d]).sum::<usize>()];
        let dims = self.interfaces.grid().dims();
        let mut thinness = vec![0.0; self.curves.unknown_count()];
        for (thinness, crossing) in thinness.iter_mut().zip(self.interfaces.crossings()) {
            *thinness = thin::is_on_a_rod(dims, crossing.low(), crossing.axis(), rank).into();
        }
        thinness
    }

    /// Works with one measure.
    fn stage<R: Real>(
        &self,
        stage: Stage,
        energy: &Energy,
        x: &mut Vec<R>,
        work: impl FnOnce(&mut Work<R>, &mut Vec<R>),
    ) {
        let mut problem =
            Problem::new(&self.curves.network, &self.conditions(energy), <[f32]>::to_vec);
        problem.keep_thin_parts(|| self.thinness());
        let newton = Newton::new(self.interfaces, self.curves, stage, self.spacing);
        let tolerance = self.settings.tolerance;
        work(&mut Work { problem, newton, tolerance, passes: Vec::new() }, x);
    }
}

/// The work with one measure.
struct Work<'a, R> {
    problem: Problem<'a, R>,
    newton: Newton<'a, R>,
    tolerance: f64,
    /// See [`Report`].
    passes: Vec<Vec<f64>>,
}

impl<R: Real> Work<'_, R> {
    /// Makes passes until the first step of one is next to nothing, and the one before ended early.
    fn converge(&mut self, most: usize, x: &mut Vec<R>) -> Status {
        let mut was_short = true;
        for _ in 0..most {
            match self.pass(PASS, x) {
                None => return Status::Stalled,
                Some(moved) if moved <= self.tolerance && was_short => return Status::Converged,
                Some(_) => {
                    was_short =
                        self.passes.last().is_some_and(|energies| energies.len() <= PASS.len())
                }
            }
        }
        Status::IterationLimit
    }

    /// Freezes weights and barrier and makes steps. Returns how far the first one moved the points,
    /// their root mean square; nothing if there was none.
    fn pass(&mut self, efforts: &[Effort], x: &mut Vec<R>) -> Option<f64> {
        let mut energy = self.newton.freeze(&mut self.problem, x);
        let (mut energies, mut first) = (vec![energy], None);
        for effort in efforts {
            let Some(step) = self.newton.step(&self.problem, x, energy, effort) else { break };
            energy = step.energy;
            energies.push(energy);
            first = first.or(Some(step.moved));
            if step.moved <= self.tolerance {
                break;
            }
        }
        self.passes.push(energies);
        first
    }

    fn finish(&mut self, status: Status, x: &[R], optimum: &mut Optimum) {
        optimum.slopes = self.newton.slopes(&self.problem, x);
        let [low, high] = self.problem.bounds.all.map(R::to_f64);
        optimum.unknowns = x.iter().map(|x| x.to_f64().clamp(low, high)).collect();
        optimum.report.status = status;
        optimum.report.passes.append(&mut self.passes);
    }
}
