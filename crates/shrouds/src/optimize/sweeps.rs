//! The paper's method: sequential sweeps of univariate minimisation (section 2).

use crate::optimize::model::Model;
use crate::optimize::problem::Problem;
use crate::optimize::progress::{Observer, Positions, Progress};
use crate::optimize::report::{Round, Stationarity, Status, free_gradient};
use crate::optimize::settings::Settings;
use crate::optimize::univariate::minimise;
use crate::surface::Surface;

/// Sweeps over the vertices in order until ‖δᵏ − δᵏ⁺¹‖/‖δᵏ⁺¹‖ falls to the tolerance.
///
/// Weights and barrier, if the energy has any, are refreshed before the second and the third sweep
/// and then stay frozen, as the paper's energies have none.
pub(super) fn solve(
    problem: &mut Problem<f64>,
    surface: &Surface,
    x: &mut [f64],
    settings: &Settings,
    observer: &mut Observer,
) -> (Vec<Round>, Stationarity) {
    const REFRESHED_SWEEPS: usize = 3;
    let tolerance = settings.tolerance();
    problem.freeze(x);
    let mut model = Model::new(problem.network);
    let mut rounds = vec![Round::new(problem.value(x))];
    for sweep in 0..settings.max_iterations() {
        if (1..REFRESHED_SWEEPS).contains(&sweep) && problem.needs_freezing() {
            problem.freeze(x);
            rounds.push(Round::new(problem.value(x)));
        }
        let old = x.to_vec();
        for v in 0..x.len() {
            minimise(problem, x, v as u32);
        }
        let energy = problem.value(x);
        let change = relative_change(surface, &old, x);
        model.linearise(problem, x);
        let gradient = Some(free_gradient(&model, problem, x));
        let (iteration, share_done) = (sweep + 1, None);
        let positions = Positions::new(surface, x);
        let progress =
            Progress { iteration, energy, change, gradient, tolerance, share_done, positions };
        let stopped = observer(progress).is_break();
        let last_refreshed = sweep + 1 >= REFRESHED_SWEEPS || !problem.needs_freezing();
        let status = match () {
            () if stopped => Status::Cancelled,
            () if change < tolerance && last_refreshed => Status::Converged,
            () => Status::IterationLimit,
        };
        if let Some(round) = rounds.last_mut() {
            round.energies.push(energy);
            round.status = status;
        }
        if status != Status::IterationLimit {
            break;
        }
    }
    model.linearise(problem, x);
    (rounds, Stationarity::of(&model, x, &problem.bounds, &problem.is_foreign))
}

/// ‖δᵏ − δᵏ⁺¹‖/‖δᵏ⁺¹‖ between two states.
fn relative_change(surface: &Surface, old: &[f64], new: &[f64]) -> f64 {
    let moved: f64 = old.iter().zip(new).map(|(a, b)| (a - b).powi(2)).sum();
    // δ from the position and the position from δ are the same reflection.
    let deltas = surface.crossings().zip(new).map(|(c, &x)| c.from_low(x));
    (moved / deltas.map(|d| d * d).sum::<f64>()).sqrt()
}
