//! Stage 5 of 7, optimize: in a network and an energy, out the δ of every vertex and a report.
//!
//! Minimises the energy of equation 9, the sum over all planar curves of ρ over their vertices, over
//! the box of equation 4. The unknown of a vertex is its position `x` along its grid edge from the
//! low end, in edge lengths; δ is `x` or `1 − x`.
//!
//! Uses: `grid`, `volume`, `surface`, `network`, `energy`.

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

pub use report::{Report, Round, Status};
pub use settings::{Observer, Progress, Settings, Solver, Start};

use std::ops::ControlFlow;
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
    if let Ok(f) = std::env::var("STARTF") { let b = std::fs::read(f).unwrap(); assert_eq!(b.len(), 8 * x.len()); for (x, c) in x.iter_mut().zip(b.chunks(8)) { *x = f64::from_le_bytes(c.try_into().unwrap()); } }
    if std::env::var("LAP").is_ok() { eprintln!("  start {:.1} ns/v", t0.elapsed().as_secs_f64() * 1e9 / x.len() as f64); }
    let bounds = [settings.margin, 1.0 - settings.margin];
    x.iter_mut().for_each(|x| *x = x.clamp(bounds[0], bounds[1]));
    let grid = surface.grid();
    let spacing = grid.spacing().map(|h| h / grid.min_spacing());
    if let Ok(plan) = std::env::var("PLAN") {
        let plan: relax::Plan = plan.split('/').map(|v| v.split(';').map(|g| { let v: Vec<usize> = g.split(',').map(|x| x.parse().unwrap()).collect(); conjugate::Effort { segment: v[0], segments: v[1], reduction: 1e-3, converges: false } }).collect()).collect();
        let tile = std::env::var("TILE").map_or(48000, |x| x.parse().unwrap());
        let mut x: Vec<f32> = x.iter().map(|&x| x as f32).collect();
        let t0 = std::time::Instant::now();
        let visited = relax::relax(surface, settings.energy.as_ref(), spacing, bounds, &mut x, &plan, tile, &mut |_, _, _| ControlFlow::Continue(()));
        eprintln!("tiles {} E {:.4} -> {:.4} {:.1} ns/v", visited.len(), visited.iter().map(|v| v.energies[0]).sum::<f64>(), visited.iter().map(|v| v.energies.last().unwrap()).sum::<f64>(), t0.elapsed().as_secs_f64() * 1e9 / x.len() as f64);
        let x: Vec<f64> = x.iter().map(|&x| f64::from(x)).collect();
        let delta = surface.crossings().zip(&x).map(|(c, &x)| c.from_low(x)).collect();
        if std::env::var("REPS").is_ok() { return Ok((delta, Report { status: Status::Empty, iterations: 0, energy: [0.0; 2], projected_gradient: 0.0, projected_step_rms: 0.0, projected_step_max: 0.0, at_bound: 0.0, rounds: Vec::new() })); }
        let first = x.clone();
        let problem = Problem::new(network, spacing, settings.energy.as_ref(), bounds);
        let report = Report::new(&problem, Vec::new(), &first, &x);
        return Ok((delta, report));
    }
    let first = x.clone();
    let mut problem = Problem::new(network, spacing, settings.energy.as_ref(), bounds);
    let rounds = match settings.solver {
        _ if x.is_empty() => Vec::new(),
        Solver::Newton => converge::solve(&mut problem, &mut x, settings, observer),
        Solver::Sweeps => sweeps::solve(&mut problem, surface, &mut x, settings, observer),
    };
    let report = Report::new(&problem, rounds, &first, &x);
    let delta = surface.crossings().zip(&x).map(|(c, &x)| c.from_low(x)).collect();
    Ok((delta, report))
}
