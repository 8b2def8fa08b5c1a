//! Between what the positions along the grid edges must stay.

use crate::error::Error;
use crate::optimize::real::Real;
use crate::optimize::settings::Settings;
use crate::surface::Surface;

/// The bounds of all vertices, and narrower ones of each where the caller gives some.
pub(super) struct Bounds<R> {
    pub(super) all: [R; 2],
    /// By vertex; empty if there are none.
    own: Vec<[R; 2]>,
}

impl<R: Real> Bounds<R> {
    pub(super) fn new(all: [f64; 2]) -> Self {
        Self { all: all.map(R::from_f64), own: Vec::new() }
    }

    /// Gives every vertex bounds of its own, or none if there are none.
    pub(super) fn narrow(&mut self, own: &[[f64; 2]]) {
        self.own = own.iter().map(|bounds| bounds.map(R::from_f64)).collect();
    }

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

/// The intervals that the settings give, as bounds of the positions: cut to `all`, which go before
/// them. Empty if there are none.
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
    let is_one = |[low, high]: [f64; 2]| low >= 0.0 && low <= high && high <= 1.0;
    if let Some(odd) = intervals.iter().find(|&&interval| !is_one(interval)) {
        return refuse("an interval of δ", format!("{odd:?}"), "within [0, 1], its lower end first");
    }
    let of_positions = surface.crossings().zip(intervals.iter()).map(|(crossing, interval)| {
        let ends = interval.map(|delta| crossing.from_low(delta).clamp(all[0], all[1]));
        if ends[0] <= ends[1] { ends } else { [ends[1], ends[0]] }
    });
    Ok(of_positions.collect())
}

/// Cuts positions to bounds of their own, if they have some.
pub(super) fn cut<R: Real>(x: &mut [R], own: &[[R; 2]]) {
    for (x, [low, high]) in x.iter_mut().zip(own) {
        *x = if *x < *low { *low } else { *x };
        *x = if *x > *high { *high } else { *x };
    }
}
