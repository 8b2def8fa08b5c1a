//! Work on one tile.

use crate::optimize::conjugate::Effort;
use crate::optimize::mean::Gathered;
use crate::optimize::newton::Newton;
use crate::optimize::problem::{Conditions, Problem};
use crate::optimize::real::Real;
use crate::optimize::report::{Stationarity, free_gradient};
use crate::optimize::tile::Tile;

/// A moment of the work on a pass, or on the passes over a surface of one tile.
pub(super) struct Moment<'a, R> {
    /// Steps made so far.
    pub(super) steps: usize,
    /// The share of the work that is done.
    pub(super) share: f64,
    pub(super) energy: f64,
    pub(super) step_rms: f64,
    /// See [`Progress::gradient`](crate::optimize::Progress::gradient).
    pub(super) gradient: Option<f64>,
    /// The positions of all vertices of the surface, or of the tile that is one.
    pub(super) x: &'a [R],
}

/// Told of moments; says whether to stop there.
pub(super) type Watch<'a, R> = dyn FnMut(Moment<R>) -> bool + 'a;

/// What working on a tile brought.
pub(super) struct Visit<R> {
    pub(super) x: Vec<R>,
    /// The energy of the tile's own vertices, for each pass that was made, before it and after every
    /// step.
    pub(super) energies: Vec<Vec<f64>>,
    /// The sum of the squares of what the first step of the last pass moved, in edge lengths.
    pub(super) first_move: f64,
    /// See [`Model::energy_of_vertices`](crate::optimize::model::Model::energy_of_vertices).
    pub(super) energy_of_vertices: f64,
    /// The same by the cells of the conditions, if they have any.
    pub(super) gathered: Option<Gathered>,
    pub(super) stationarity: Stationarity,
    /// See [`Problem::slopes`].
    pub(super) slopes: Vec<[f32; 2]>,
    pub(super) is_cancelled: bool,
}

/// The steps of some passes from `x`, weights and barrier frozen anew for each. A pass ends early when a step
/// moves the vertices by less than `least`, their root mean square. `watch` is told after every step.
pub(super) fn visit<R: Real>(
    tile: &Tile,
    conditions: &Conditions,
    passes: &[&[Effort]],
    least: f64,
    mut x: Vec<R>,
    mut watch: Option<&mut Watch<R>>,
) -> Visit<R> {
    let local = |factors: &[f32]| tile.read(factors, 0.0);
    let mut problem = Problem::new(&tile.network, conditions, local);
    if let Some(voxels) = conditions.voxels {
        problem.keep_thin_parts(|| voxels.thinness(&tile.part));
    }
    let lows = || tile.part.crossings().map(|crossing| crossing.low());
    if let Some(mean) = conditions.mean_energy {
        problem.follow(mean.at(x.len(), lows()));
    }
    problem.fix(tile.is_fixed());
    problem.leave_out(tile.is_foreign());
    if !conditions.intervals.is_empty() {
        problem.narrow(&tile.read(conditions.intervals, [0.0, 1.0]));
    }
    if let Some(forces) = conditions.forces {
        problem.pull(local(forces), &x);
    }
    let mut newton = Newton::new(&tile.network);
    let (mut energies, mut first_move) = (Vec::new(), 0.0);
    let planned: usize = passes.iter().map(|steps| steps.len()).sum();
    let (mut made, mut is_cancelled) = (0, false);
    for steps in passes {
        problem.freeze_weights(&x);
        let mut energy = newton.model.linearise_with_new_barrier(&mut problem, &x);
        let mut own = vec![energy.own];
        first_move = 0.0;
        for (n, effort) in steps.iter().enumerate() {
            let Some(step) = newton.step(&problem, &mut x, energy, effort) else { break };
            energy = step.value;
            own.push(energy.own);
            made += 1;
            if n == 0 {
                first_move = step.moved;
            }
            if let Some(watch) = &mut watch {
                // The projected steps of all vertices would cost an eighth of the work.
                let step_rms = (step.moved / x.len() as f64).sqrt();
                let share = made as f64 / planned as f64;
                let gradient = Some(free_gradient(&newton.model, &problem, &x));
                let (steps, energy) = (made, energy.own);
                is_cancelled = watch(Moment { steps, share, energy, step_rms, gradient, x: &x });
            }
            if is_cancelled || step.moved <= least * least * x.len() as f64 {
                break;
            }
        }
        energies.push(own);
        if is_cancelled {
            break;
        }
    }
    let stationarity = Stationarity::of(&newton.model, &x, &problem.bounds, &problem.is_foreign);
    let slopes = problem.slopes(&x);
    let energy_of_vertices = newton.model.energy_of_vertices(&problem);
    let gathered = conditions.cells.map(|cells| {
        let own = lows().enumerate().filter(|&(v, _)| !problem.is_foreign[v]);
        let energy = |(v, low)| (low, newton.model.energy_of_vertex(&problem, v));
        Gathered::new(cells, own.map(energy))
    });
    Visit {
        x,
        energies,
        first_move,
        energy_of_vertices,
        gathered,
        stationarity,
        slopes,
        is_cancelled,
    }
}
