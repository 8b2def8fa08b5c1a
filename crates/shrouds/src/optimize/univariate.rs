//! Minimising over the position of one vertex.

use crate::optimize::problem::Problem;

/// How much shorter the next attempt is when a step raises the energy, and how often.
const SHRINK: f64 = 0.35;
const ATTEMPTS: usize = 4;
/// A rise by less than this part of the energy is rounding: near a minimum the slope sees what the
/// energy no longer does.
pub(super) const ROUNDING: f64 = 1e-14;

/// Moves vertex `v` by one Newton step along its grid edge, shortened until the energy falls.
/// Returns how far it moved: 0 when no attempt helped.
pub(super) fn step(problem: &Problem, x: &mut [f64], v: u32) -> f64 {
    let here = problem.slope_around(x, v);
    let value = problem.value_around(x, v);
    let old = x[v as usize];
    let [low, high] = problem.bounds;
    let mut length = -here.slope / here.curvature.max(f64::MIN_POSITIVE);
    for _ in 0..ATTEMPTS {
        let new = (old + length).clamp(low, high);
        x[v as usize] = new;
        if new != old && problem.value_around(x, v) < value + ROUNDING * value.abs() {
            return new - old;
        }
        length = (new - old) * SHRINK;
    }
    x[v as usize] = old;
    0.0
}

/// Moves vertex `v` to the least energy along its whole grid edge: the best of a coarse scan, then
/// Newton steps.
pub(super) fn minimise(problem: &Problem, x: &mut [f64], v: u32) {
    const MOST_STEPS: usize = 50;
    const SMALLEST_STEP: f64 = 1e-12;
    scan(problem, x, v);
    for _ in 0..MOST_STEPS {
        if step(problem, x, v).abs() <= SMALLEST_STEP {
            return;
        }
    }
}

/// Moves vertex `v` to the best of a few places spread over its grid edge, if one is better than
/// where it is: the energy may have several minima along the edge.
pub(super) fn scan(problem: &Problem, x: &mut [f64], v: u32) {
    const PLACES: usize = 9;
    let [low, high] = problem.bounds;
    let mut best = (problem.value_around(x, v), x[v as usize]);
    for n in 0..PLACES {
        let place = low + (high - low) * (n as f64 + 0.5) / PLACES as f64;
        x[v as usize] = place;
        let value = problem.value_around(x, v);
        if value < best.0 {
            best = (value, place);
        }
    }
    x[v as usize] = best.1;
}
