//! Stage 5 of 7, optimize: in a network and an energy, out the δ of every vertex and a report.
//!
//! Minimises the energy of equation 9, the sum over all planar curves of ρ over their vertices, over
//! the box of equation 4. The unknown of a vertex is its position `x` along its grid edge from the
//! low end, in edge lengths; δ is `x` or `1 − x`.
//!
//! Uses: `grid`, `volume`, `surface`, `network`, `energy`.

mod blur;
mod conjugate;
mod model;
mod newton;
mod problem;
mod real;
mod report;
mod settings;
mod start;
mod strip;
mod sweeps;
mod univariate;

pub use report::{Report, Round, Status};
pub use settings::{Observer, Progress, Settings, Solver, Start};

use crate::error::Error;
use crate::network::Network;
use crate::surface::Surface;
use crate::volume::Occupancy;
use problem::Problem;

/// The δ of every vertex that minimises the energy, and how that went.
///
/// `volume` is the volume that `surface` was extracted from; the blurred start reads it. δ is 1 at
/// the inside end of a grid edge and 0 at the outside end, and stays within
/// `[margin, 1 − margin]`. The result has the same bits on any number of threads.
///
/// # Errors
/// [`Error::Setting`] when a setting is outside its range.
pub fn optimize(
    volume: &Occupancy,
    surface: &Surface,
    network: &Network,
    settings: &Settings,
    observer: &mut Observer,
) -> Result<(Vec<f64>, Report), Error> {
    settings.validate()?;
    let t0 = std::time::Instant::now();
    let mut x = start::positions(surface, &settings.start);
    if std::env::var("LAP").is_ok() { eprintln!("  start {:.1} ns/v", t0.elapsed().as_secs_f64() * 1e9 / x.len() as f64); }
    let bounds = [settings.margin, 1.0 - settings.margin];
    x.iter_mut().for_each(|x| *x = x.clamp(bounds[0], bounds[1]));
    let grid = surface.grid();
    let spacing = grid.spacing().map(|h| h / grid.min_spacing());
    if std::env::var("PLAN").is_ok() {
        let mut x: Vec<f32> = x.iter().map(|&x| x as f32).collect();
        let first = x.clone();
        let mut problem = Problem::new(network, spacing, settings.energy.as_ref(), bounds);
        let rounds = newton::solve(&mut problem, &mut x, settings, observer);
        let report = Report::new(&problem, rounds, &first, &x);
        let delta = surface.crossings().zip(&x).map(|(c, &x)| c.from_low(x as f64)).collect();
        return Ok((delta, report));
    }
    let first = x.clone();
    let mut problem = Problem::new(network, spacing, settings.energy.as_ref(), bounds);
    let rounds = match settings.solver {
        _ if x.is_empty() => Vec::new(),
        Solver::Newton => newton::solve(&mut problem, &mut x, settings, observer),
        Solver::Sweeps => sweeps::solve(&mut problem, surface, &mut x, settings, observer),
    };
    let report = Report::new(&problem, rounds, &first, &x);
    let delta = surface.crossings().zip(&x).map(|(c, &x)| c.from_low(x)).collect();
    Ok((delta, report))
}
