//! Between what the positions along the grid edges must stay.

use crate::error::Error;
use crate::optimize::real::Real;
use crate::optimize::settings::Settings;
use crate::surface::Surface;

/// The bounds of all vertices, and narrower ones of each where the caller gives some.
pub(crate) struct Bounds<R> {
    pub(crate) all: [R; 2],
    /// The same in double precision.
    exact: [f64; 2],
    /// By vertex; empty if there are none.
    own: Vec<[R; 2]>,
}

impl<R: Real> Bounds<R> {
    pub(super) fn new(all: [f64; 2]) -> Self {
        Self { all: all.map(R::from_f64), exact: all, own: Vec::new() }
    }

    /// Gives every vertex the bounds of its interval: as far from its ends as those of all are from
    /// 0 and 1, in proportion, and not beyond those.
    pub(super) fn narrow(&mut self, intervals: &[[f64; 2]]) {
        let own = |interval: &[f64; 2]| within(*interval, self.exact).map(R::from_f64);
        self.own = intervals.iter().map(own).collect();
    }

    /// Brings positions into the intervals: those that lie outside, a quarter of it from the nearer end,
    /// for at the very end the barrier would let no step get far.
    pub(super) fn enter(&self, intervals: &[[f64; 2]], x: &mut [R]) {
        for (x, &[low, high]) in x.iter_mut().zip(intervals) {
            let (place, quarter) = (x.to_f64(), 0.25 * (high - low));
            if !(low..=high).contains(&place) {
                *x = R::from_f64(place.clamp(low + quarter, high - quarter));
            }
        }
        cut(x, &self.own);
    }

    /// Those of a vertex.
    #[inline(always)]
    pub(super) fn of(&self, v: usize) -> [R; 2] {
        self.own.get(v).copied().unwrap_or(self.all)
    }

    /// The bounds of each vertex from `first` on, nothing if there are only those of all: loops over
    /// many vertices stay as they are then.
    #[inline(always)]
    pub(super) fn own(&self, first: usize) -> &[[R; 2]] {
        self.own.get(first..).unwrap_or_default()
    }
}

/// The intervals of the positions that the settings give, with bounds for all; empty if there are none.
pub(super) fn intervals(
    surface: &Surface,
    settings: &Settings,
    all: [f64; 2],
) -> Result<Vec<[f64; 2]>, Error> {
    let Some(intervals) = &settings.intervals else { return Ok(Vec::new()) };
    let refuse = |name, value, range| Err(Error::Setting { name, value, range });
    if intervals.len() != surface.vertex_count() {
        let value = format!("{} for {} vertices", intervals.len(), surface.vertex_count());
        return refuse("the number of intervals", value, "one for each vertex");
    }
    let is_wide = |interval: [f64; 2]| {
        let [low, high] = [interval[0].max(all[0]), interval[1].min(all[1])];
        interval[0] >= 0.0 && interval[1] <= 1.0 && high - low >= NARROWEST
    };
    if let Some(narrow) = intervals.iter().find(|&&interval| !is_wide(interval)) {
        let range = "within [0, 1], from low to high, and 0.001 wide without the margin";
        return refuse("an interval", format!("{narrow:?}"), range);
    }
    let of_positions = surface.crossings().zip(intervals.iter()).map(|(crossing, &[low, high])| {
        if crossing.inside_low() { [1.0 - high, 1.0 - low] } else { [low, high] }
    });
    Ok(of_positions.collect())
}

/// The least width of an interval, and how far its bounds are from its ends at least: single precision
/// must not round them away.
const NARROWEST: f64 = 0.001;
const NEAREST: f64 = 1e-6;

/// The bounds within an interval.
fn within([low, high]: [f64; 2], all: [f64; 2]) -> [f64; 2] {
    let room = (all[0] * (high - low)).max(NEAREST);
    [all[0].max(low + room), all[1].min(high - room)]
}

/// Cuts positions to bounds of their own, if they have some.
pub(super) fn cut<R: Real>(x: &mut [R], own: &[[R; 2]]) {
    for (x, [low, high]) in x.iter_mut().zip(own) {
        *x = if *x < *low { *low } else { *x };
        *x = if *x > *high { *high } else { *x };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_edge_has_the_bounds_of_all() {
        for margin in [1e-6, 0.002, 0.1] {
            let all = [margin, 1.0 - margin];
            assert_eq!(within([0.0, 1.0], all), all);
            let [low, high] = within([0.25, 0.5], all);
            assert!(0.25 < low && low < 0.26 + margin && high < 0.5 && high > 0.49 - margin);
        }
    }
}
