//! From interfaces to the unknowns that minimise the energy.

use std::sync::Arc;

use crate::energy::{Bending, CurveEnergy, Variation};
use crate::error::Error;
use crate::materials::Settings;
use crate::materials::interfaces::Interfaces;
use crate::materials::network::Network;
use crate::materials::newton::{Effort, Newton, place_junctions};
use crate::materials::problem::Problem;
use crate::materials::start;
use crate::optimize::{Preset, Status};

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
}

impl Report {
    /// The number of steps made.
    pub fn steps(&self) -> usize {
        self.passes.iter().map(|energies| energies.len() - 1).sum()
    }
}

const fn effort(iterations: usize, reduction: f64) -> Effort {
    Effort { iterations, reduction }
}

const FAST: &[&[Effort]] = &[&[effort(20, 1e-3)]];
const DEFAULT: &[&[Effort]] = &[&[effort(10, 1e-3), effort(20, 1e-3)], &[effort(30, 1e-3)]];
/// Steps of one of many passes.
const PASS: &[Effort] = &[effort(100, 1e-2); 4];
/// The most passes with bending before variation follows.
const PREPARATION: usize = 5;

/// The unknowns that minimise the energy, or come near it.
///
/// # Errors
/// [`Error::Setting`] when a setting is outside its range.
pub(super) fn optimize(interfaces: &Interfaces, settings: &Settings) -> Result<Optimum, Error> {
    settings.validate()?;
    let bounds = [settings.margin, 1.0 - settings.margin];
    let network = Network::trace(interfaces);
    let mut x = start::positions(interfaces, &settings.start, bounds);
    x.resize(network.unknown_count(), 0.5);
    let mut solver = Solver {
        interfaces,
        network: &network,
        settings,
        newton: Newton::new(interfaces, &network, bounds),
        report: Report::default(),
    };
    place_junctions(&solver.problem(Arc::new(Bending)), bounds, &mut x);
    if !x.is_empty() {
        solver.solve(&mut x);
    }
    let slopes = solver.problem(Arc::new(Bending)).slopes(&x);
    Ok(Optimum { slopes, report: solver.report, unknowns: x })
}

struct Solver<'a> {
    interfaces: &'a Interfaces,
    network: &'a Network,
    settings: &'a Settings,
    newton: Newton,
    report: Report,
}

impl<'a> Solver<'a> {
    fn problem(&self, measure: Arc<dyn CurveEnergy>) -> Problem<'a> {
        Problem::new(self.interfaces, self.network, measure)
    }

    fn solve(&mut self, x: &mut Vec<f64>) {
        self.report.status = Status::Preset;
        match self.settings.preset {
            Preset::Fast => self.make(FAST, x),
            Preset::Default => self.make(DEFAULT, x),
            Preset::Exact => {
                self.converge(Arc::new(Bending), PREPARATION, x);
                let most = self.settings.max_iterations.div_ceil(PASS.len());
                self.report.status = self.converge(Arc::new(Variation), most, x);
            }
        }
    }

    fn make(&mut self, passes: &[&[Effort]], x: &mut Vec<f64>) {
        let mut problem = self.problem(Arc::new(Bending));
        for efforts in passes {
            self.pass(&mut problem, efforts, x);
        }
    }

    /// Makes passes until the first step of one is next to nothing.
    fn converge(&mut self, measure: Arc<dyn CurveEnergy>, most: usize, x: &mut Vec<f64>) -> Status {
        let mut problem = self.problem(measure);
        for _ in 0..most {
            match self.pass(&mut problem, PASS, x) {
                None => return Status::Stalled,
                Some(moved) if moved <= self.settings.tolerance => return Status::Converged,
                Some(_) => {}
            }
        }
        Status::IterationLimit
    }

    /// Freezes weights and barrier and makes steps. Returns how far the first one moved the points,
    /// their root mean square; nothing if there was none.
    fn pass(&mut self, problem: &mut Problem, efforts: &[Effort], x: &mut Vec<f64>) -> Option<f64> {
        problem.freeze(x);
        self.newton.model.linearise(problem, x);
        let mut energy = self.newton.model.set_barrier(problem, x);
        let (mut energies, mut first) = (vec![energy], None);
        for effort in efforts {
            let Some(step) = self.newton.step(problem, x, energy, effort) else { break };
            energy = step.energy;
            energies.push(energy);
            first = first.or(Some(step.moved));
            if step.moved <= self.settings.tolerance {
                break;
            }
        }
        self.report.passes.push(energies);
        first
    }
}
