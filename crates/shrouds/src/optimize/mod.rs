//! Stage 5 of 7, optimize: in a surface and an energy, out the δ of every vertex and a report.
//!
//! Minimises the energy of equation 9, the sum over all planar curves of ρ over their vertices, over
//! the box of equation 4. The unknown of a vertex is its position `x` along its grid edge from the
//! low end, in edge lengths; δ is `x` or `1 − x`.
//!
//! Uses: `grid`, `volume`, `surface`, `network`, `energy`.

mod alone;
mod around;
mod barrier;
mod blur;
mod bounds;
mod conjugate;
mod crease;
mod enclosed;
mod flat;
mod keep;
mod level;
mod local;
mod mean;
mod model;
mod names;
mod newton;
mod pieces;
mod plan;
mod problem;
mod progress;
mod real;
mod relax;
mod report;
mod rough;
mod settings;
pub(crate) mod shares;
mod start;
mod strip;
mod sweeps;
pub(crate) mod thin;
mod tile;
mod univariate;
mod visit;

pub use alone::minimise_vertex;
pub(crate) use around::Univariate;
pub(crate) use conjugate::{Effort, Room, Workspace};
pub use keep::keep_volumes;
pub(crate) use local::{Local, flatness, update_flatness};
pub(crate) use mean::{CellGrid, Gathered, MeanEnergy};
pub(crate) use model::Model;
pub(crate) use pieces::{FLAT_REACH, FixedPass, KNOWN, Piece, fixed_passes};
pub(crate) use problem::{Conditions, Problem, power_of_root};
pub use progress::{Observer, Positions, Progress};
pub(crate) use real::Real;
pub(crate) use relax::EnergySum;
pub use report::{ComponentVolume, Report, Round, Status};
pub use settings::{Crease, Preset, Settings, Solver, Start, VolumeRule};
pub(crate) use tile::{BLOCK, HALO, Tiling};
pub(crate) use univariate::{scanned, stepped};

use std::sync::Arc;

use crate::energy::Energy;
use crate::error::Error;
use crate::network::Network;
use crate::surface::Surface;
use crate::volume::Border;
use bounds::Bounds;
use keep::Keeper;
use progress::deltas;
use report::Stationarity;

/// A surface that minimises the energy, or comes near.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Optimum {
    /// δ of every vertex: 1 at the inside end of its grid edge, 0 at the outside end, within
    /// `[margin, 1 − margin]`.
    pub delta: Vec<f64>,
    /// The slopes of both planar curves of every vertex over its grid edge: how far the curve's
    /// tangent runs along the edge for each unit across it, in the directions of growing index and
    /// in world lengths. The normals follow from them. Where volumes are kept, those before
    /// the last correction of the volumes.
    pub slopes: Vec<[f32; 2]>,
    /// How the optimisation went.
    pub report: Report,
}

/// The positions of the vertices that minimise the energy, and how that went.
///
/// The result has the same bits on any number of threads.
///
/// # Errors
/// [`Error::Setting`] when a setting is outside its range, the mask of rough places is not on the grid
/// of the volume, intervals or given δ are none or not one for each vertex, or volumes are to be kept by
/// the sweeps, within intervals or for an open border.
pub fn optimize(
    surface: &Surface,
    settings: &Settings,
    observer: &mut Observer,
) -> Result<Optimum, Error> {
    settings.validate()?;
    if settings.volume == VolumeRule::Keep && surface.border() == Border::Open {
        return Err(settings::cannot_keep("free for an open border"));
    }
    let flatness = flatness(surface);
    let energy = settings.energy();
    let Conditions { spacing, bounds, .. } = Conditions::new(surface, settings, &energy, &flatness);
    let x = start::positions(surface, &settings.start, spacing, bounds)?;
    let intervals = bounds::intervals(surface, settings, bounds)?;
    // In double precision the bounds are nearer to their value.
    let in_double = || x.iter().map(|&x| f64::from(x).clamp(bounds[0], bounds[1])).collect();
    let rough = match &settings.rough {
        Some(marked) => Some(rough::factors(surface, marked)?),
        None => None,
    };
    let task = Task { surface, settings, flatness: &flatness, intervals: &intervals, rough };
    Ok(match (settings.solver, settings.preset) {
        _ if x.is_empty() => Optimum::default(),
        (Solver::Sweeps, _) => task.sweep(in_double(), observer),
        (Solver::Newton, Preset::Exact) => task.step(in_double(), observer),
        (Solver::Newton, _) => task.step(x, observer),
    })
}

/// What is to be done.
struct Task<'a> {
    surface: &'a Surface,
    settings: &'a Settings,
    /// See [`flat::flatness`].
    flatness: &'a [f32],
    /// See [`bounds::intervals`].
    intervals: &'a [[f64; 2]],
    /// See [`rough::factors`].
    rough: Option<Arc<[f32]>>,
}

impl Task<'_> {
    /// The default method.
    fn step<R: Real>(&self, mut x: Vec<R>, observer: &mut Observer) -> Optimum {
        let mut left = self.settings.max_iterations();
        let (mut rounds, mut prepared) = (Vec::new(), 0);
        let (mut stationarity, mut slopes) = (Stationarity::default(), Vec::new());
        let components = match self.settings.volume {
            VolumeRule::Free => None,
            VolumeRule::Keep => Some(self.surface.components()),
        };
        let bounds = [self.settings.margin, 1.0 - self.settings.margin];
        let mut own = Bounds::new(bounds);
        own.narrow(self.intervals);
        own.enter(self.intervals, &mut x);
        let mut keeper = components.as_ref().map(|c| Keeper::new(self.surface, c, bounds));
        let thinness = match self.settings.crease {
            Some(_) => thin::of_single_points(self.surface),
            None => Vec::new(),
        };
        let stages = plan::stages(self.settings, &thinness);
        let count = stages.len() as f64;
        for (n, plan::Stage { energy, passes, creases }) in stages.into_iter().enumerate() {
            let energy = self.with_rough_places(energy);
            let conditions = Conditions { creases, ..self.conditions(&energy) };
            let done = self.settings.max_iterations() - left;
            let mut of_all = |progress: Progress| {
                let share_done = progress.share_done.map(|share| (n as f64 + share) / count);
                let iteration = done + progress.iteration;
                observer(Progress { iteration, share_done, ..progress })
            };
            let (x, observer) = (&mut x, &mut of_all);
            let relaxed = match &mut keeper {
                None => relax::relax(self.surface, &conditions, passes, left, x, observer),
                Some(keeper) => keeper.relax(&conditions, passes, left, x, observer),
            };
            left -= relaxed.steps();
            let is_cancelled = relaxed.status() == Status::Cancelled;
            (stationarity, slopes) = (relaxed.stationarity, relaxed.slopes);
            prepared = rounds.len();
            rounds.extend(relaxed.rounds);
            if is_cancelled {
                break;
            }
        }
        let mut report = Report::new(rounds, prepared, &stationarity);
        report.volumes = keeper.map_or(Vec::new(), |keeper| keeper.volumes(&x));
        Optimum { delta: deltas(self.surface, &x), slopes, report }
    }

    /// The energy, switched off where the surface need not be smooth.
    fn with_rough_places(&self, energy: Energy) -> Energy {
        match &self.rough {
            Some(factors) => energy.with_factors(factors),
            None => energy,
        }
    }

    /// The paper's method.
    fn sweep(&self, mut x: Vec<f64>, observer: &mut Observer) -> Optimum {
        let energy = self.with_rough_places(self.settings.energy());
        let conditions = self.conditions(&energy);
        let network = Network::trace(self.surface);
        let mut problem = Problem::new(&network, &conditions, <[f32]>::to_vec);
        problem.keep_thin_parts(|| thin::of_rods(self.surface));
        problem.narrow(self.intervals);
        problem.bounds.enter(self.intervals, &mut x);
        let (rounds, mut stationarity) =
            sweeps::solve(&mut problem, self.surface, &mut x, self.settings, observer);
        stationarity.is_certain = energy.is_convex();
        let report = Report::new(rounds, 0, &stationarity);
        Optimum { delta: deltas(self.surface, &x), slopes: problem.slopes(&x), report }
    }

    fn conditions<'b>(&'b self, energy: &'b Energy) -> Conditions<'b> {
        let conditions = Conditions::new(self.surface, self.settings, energy, self.flatness);
        Conditions { intervals: self.intervals, ..conditions }
    }
}
