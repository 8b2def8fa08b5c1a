//! Stage 5 of 7, optimize: in a surface and an energy, out the δ of every vertex and a report.
//!
//! Minimises the energy of equation 9, the sum over all planar curves of ρ over their vertices, over
//! the box of equation 4. The unknown of a vertex is its position `x` along its grid edge from the
//! low end, in edge lengths; δ is `x` or `1 − x`.
//!
//! Uses: `grid`, `volume`, `surface`, `network`, `energy`.

mod alone;
mod around;
mod blur;
mod conjugate;
mod converge;
mod model;
mod newton;
mod problem;
mod real;
mod relax;
mod report;
mod settings;
mod start;
mod strip;
mod sweeps;
mod tile;
mod univariate;

pub use alone::minimise_vertex;
pub use report::{Report, Round, Status};
pub use settings::{Observer, Preset, Progress, Settings, Solver, Start};

use crate::error::Error;
use crate::network::Network;
use crate::parallel;
use crate::surface::Surface;
use problem::{Conditions, Problem};
use real::Real;

/// A surface that minimises the energy, or comes near.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// δ of every vertex: 1 at the inside end of its grid edge, 0 at the outside end, within
    /// `[margin, 1 − margin]`.
    pub delta: Vec<f64>,
    /// The slopes of both planar curves of every vertex over its grid edge: how far the curve's
    /// tangent runs along the edge for each unit across it, in the directions of growing index and
    /// in world lengths. The normals follow from them.
    pub slopes: Vec<[f32; 2]>,
    /// How the optimisation went.
    pub report: Report,
}

/// The positions of the vertices that minimise the energy, and how that went.
///
/// The result has the same bits on any number of threads.
///
/// # Errors
/// [`Error::Setting`] when a setting is outside its range.
pub fn optimize(
    surface: &Surface,
    settings: &Settings,
    observer: &mut Observer,
) -> Result<Optimum, Error> {
    settings.validate()?;
    let energy = settings.energy();
    let conditions = Conditions::new(surface, settings, &energy);
    let x = start::positions(surface, &settings.start, conditions.spacing, conditions.bounds);
    Ok(match relax::passes(settings.preset) {
        Some(passes) if !settings.converges() && !x.is_empty() => {
            relaxed(surface, &conditions, passes, settings, x, observer)
        }
        _ => converged(surface, &conditions, settings, x, observer),
    })
}

/// Some passes over tiles, in single precision.
fn relaxed(
    surface: &Surface,
    conditions: &Conditions,
    passes: relax::Passes,
    settings: &Settings,
    mut x: Vec<f32>,
    observer: &mut Observer,
) -> Optimum {
    let limit = settings.max_iterations();
    let relaxed = relax::relax(surface, conditions, passes, limit, &mut x, observer);
    let report = Report::new(relaxed.rounds, &relaxed.stationarity, None);
    Optimum { delta: deltas(surface, &x), slopes: relaxed.slopes, report }
}

/// Steps or sweeps over the whole surface, in double precision.
fn converged(
    surface: &Surface,
    conditions: &Conditions,
    settings: &Settings,
    x: Vec<f32>,
    observer: &mut Observer,
) -> Optimum {
    let network = Network::trace(surface);
    let mut problem = Problem::new(&network, conditions, <[f32]>::to_vec);
    // In double precision the bounds are nearer to their value.
    let [low, high] = conditions.bounds;
    let mut x: Vec<f64> = x.into_iter().map(|x| f64::from(x).clamp(low, high)).collect();
    let start = x.clone();
    let (rounds, stationarity) = match settings.solver {
        _ if x.is_empty() => Default::default(),
        Solver::Newton => converge::solve(&mut problem, &mut x, settings, observer),
        Solver::Sweeps => sweeps::solve(&mut problem, surface, &mut x, settings, observer),
    };
    let first = problem.value(&start);
    let report = Report::new(rounds, &stationarity, Some(first));
    Optimum { delta: deltas(surface, &x), slopes: problem.slopes(&x), report }
}

/// The δ of every vertex from its position.
fn deltas<R: Real>(surface: &Surface, x: &[R]) -> Vec<f64> {
    let mut delta = vec![0.0; x.len()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut delta, ends, |k, delta| {
        let x = &x[surface.slice_vertices(k).start as usize..];
        for ((delta, x), crossing) in delta.iter_mut().zip(x).zip(surface.slice_crossings(k)) {
            *delta = crossing.from_low(x.to_f64());
        }
    });
    delta
}
