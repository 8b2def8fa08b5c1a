//! Minimising over the position of one vertex.

use crate::optimize::around::Univariate;
use crate::optimize::problem::Problem;
use crate::optimize::real::Real;

/// How much shorter the next attempt is when a step raises the energy, and how often.
const SHRINK: f64 = 0.35;
const ATTEMPTS: usize = 4;
/// A rise by less than this part of the energy is rounding: near a minimum the slope sees what the
/// energy no longer does.
pub(super) const ROUNDING: f64 = 1e-14;

/// Moves vertex `v` by one Newton step along its grid edge, shortened until the energy falls.
/// Returns how far it moved: 0 when no attempt helped.
pub(super) fn step<R: Real>(problem: &Problem<R>, x: &mut [R], v: u32) -> f64 {
    let old = x[v as usize];
    let mut around = problem.around(x, v);
    let new = stepped(|x| around.at(x), old, problem.bounds.of(v as usize));
    x[v as usize] = new;
    new.to_f64() - old.to_f64()
}

/// Where one Newton step leads from `old` on a function of one position.
pub(crate) fn stepped<R: Real>(
    mut function: impl FnMut(R) -> Univariate,
    old: R,
    bounds: [R; 2],
) -> R {
    let here = function(old);
    let mut length = -here.slope / here.curvature.max(f64::MIN_POSITIVE);
    let [low, high] = bounds.map(R::to_f64);
    for _ in 0..ATTEMPTS {
        let new = R::from_f64((old.to_f64() + length).clamp(low, high));
        if new != old && function(new).value < here.value + ROUNDING * here.value.abs() {
            return new;
        }
        length = (new.to_f64() - old.to_f64()) * SHRINK;
    }
    old
}

/// Moves vertex `v` to the least energy along its whole grid edge: the best of a coarse scan, then
/// Newton steps.
pub(super) fn minimise<R: Real>(problem: &Problem<R>, x: &mut [R], v: u32) {
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
pub(super) fn scan<R: Real>(problem: &Problem<R>, x: &mut [R], v: u32) {
    let mut around = problem.around(x, v);
    let old = x[v as usize];
    x[v as usize] = scanned(|x| around.at(x), old, problem.bounds.of(v as usize));
}

/// The place of the least value of a function, among `old` and a few that are spread over the bounds.
pub(crate) fn scanned<R: Real>(
    mut function: impl FnMut(R) -> Univariate,
    old: R,
    bounds: [R; 2],
) -> R {
    const PLACES: usize = 9;
    let [low, high] = bounds.map(R::to_f64);
    let mut best = (function(old).value, old);
    for n in 0..PLACES {
        let place = R::from_f64(low + (high - low) * (n as f64 + 0.5) / PLACES as f64);
        let value = function(place).value;
        if value < best.0 {
            best = (value, place);
        }
    }
    best.1
}
