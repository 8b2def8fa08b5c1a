//! Minimising over the position of one vertex.

use crate::optimize::problem::Problem;

/// How much shorter the next attempt is when a step raises the energy, and how often.
const SHRINK: f64 = 0.35;
const ATTEMPTS: usize = 4;

/// Moves vertex `v` by one Newton step along its grid edge, shortened until the energy falls.
/// Returns how far it moved: 0 when no attempt helped.
pub(super) fn step(problem: &Problem, x: &mut [f64], v: u32) -> f64 {
    let here = problem.around(x, v);
    let old = x[v as usize];
    let [low, high] = problem.bounds;
    let mut length = -here.slope / here.curvature.max(f64::MIN_POSITIVE);
    for _ in 0..ATTEMPTS {
        let new = (old + length).clamp(low, high);
        x[v as usize] = new;
        if new != old && problem.around(x, v).value < here.value {
            return new - old;
        }
        length = (new - old) * SHRINK;
    }
    x[v as usize] = old;
    0.0
}

/// Moves vertex `v` to a minimum along its grid edge.
pub(super) fn minimise(problem: &Problem, x: &mut [f64], v: u32) {
    const MOST_STEPS: usize = 50;
    const SMALLEST_STEP: f64 = 1e-12;
    for _ in 0..MOST_STEPS {
        if step(problem, x, v).abs() <= SMALLEST_STEP {
            return;
        }
    }
}
