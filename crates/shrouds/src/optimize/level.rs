//! Moving every component along one path until it encloses what it should.

use crate::optimize::enclosed::OFFSETS;
use crate::parallel;

/// Where the vertices of every component are after `t` times `directions`, cut at the bounds.
pub(super) struct Path<'a> {
    pub(super) of_vertices: &'a [u32],
    pub(super) start: &'a [f64],
    /// Where none is shorter than the least of [`OFFSETS`] the path ends at the bounds.
    pub(super) directions: &'a [f64],
    pub(super) bounds: [f64; 2],
}

/// All vertices are at a bound then.
const FAR: f64 = 1.0 / OFFSETS[0];
/// More than enough to halve an interval down to rounding.
const MOST_TRIALS: usize = 100;

/// Where components came to.
pub(super) struct Level {
    pub(super) x: Vec<f64>,
    pub(super) volumes: Vec<f64>,
    /// Which of them cannot enclose what they should, wherever on the path they are.
    pub(super) is_held: Vec<bool>,
}

impl Path<'_> {
    fn at(&self, t: &[f64]) -> Vec<f64> {
        let [low, high] = self.bounds;
        let mut x = vec![0.0; self.start.len()];
        parallel::fill(&mut x, |v| {
            let step = t[self.of_vertices[v] as usize] * self.directions[v];
            (self.start[v] + step).clamp(low, high)
        });
        x
    }

    /// Goes to where every component has its target, up to that part of it. `volumes` are known at the
    /// start and may be asked for anywhere; `slopes` are their derivatives by t at the start.
    pub(super) fn level(
        &self,
        targets: &[f64],
        slopes: &[f64],
        tolerance: f64,
        volumes: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Level {
        let found = volumes(self.start);
        let components = found.iter().zip(targets).zip(slopes);
        let mut searches: Vec<Search> = components
            .map(|((&volume, &target), &slope)| {
                Search::new(volume - target, slope, tolerance * target.abs())
            })
            .collect();
        for trial in 0..MOST_TRIALS {
            if searches.iter().all(|search| search.is_done) {
                break;
            }
            let t: Vec<f64> = searches.iter().map(|search| search.next(trial)).collect();
            let found = volumes(&self.at(&t));
            for (n, search) in searches.iter_mut().enumerate() {
                search.take(trial, t[n], found[n] - targets[n]);
            }
        }
        let t: Vec<f64> = searches.iter().map(|search| search.best.t).collect();
        let reached = searches.iter().zip(targets).map(|(search, target)| search.best.gap + target);
        Level {
            x: self.at(&t),
            volumes: reached.collect(),
            is_held: searches.iter().map(|search| search.is_held).collect(),
        }
    }
}

/// How much too large a component is at some place on its path.
#[derive(Clone, Copy)]
struct Trial {
    t: f64,
    gap: f64,
}

/// The search for a root of the gap by false position (the Illinois rule), from a Newton step on.
struct Search {
    /// Two places with gaps of unlike sign, once the end of the path is known; their gaps may have been
    /// halved.
    ends: [Trial; 2],
    best: Trial,
    slope: f64,
    tolerance: f64,
    is_done: bool,
    is_held: bool,
}

impl Search {
    fn new(gap: f64, slope: f64, tolerance: f64) -> Self {
        let start = Trial { t: 0.0, gap };
        let is_done = gap.abs() <= tolerance;
        Self { ends: [start; 2], best: start, slope, tolerance, is_done, is_held: false }
    }

    /// What to try: first the end of the path, then a Newton step.
    fn next(&self, trial: usize) -> f64 {
        let [a, b] = self.ends;
        let (low, high) = (a.t.min(b.t), a.t.max(b.t));
        let within = |t: f64| t > low && t < high;
        let newton = -a.gap / self.slope;
        let secant = a.t - a.gap * (b.t - a.t) / (b.gap - a.gap);
        match trial {
            _ if self.is_done => self.best.t,
            0 => FAR.copysign(-a.gap),
            1 if within(newton) => newton,
            _ if trial % 4 != 3 && within(secant) => secant,
            _ => 0.5 * (a.t + b.t),
        }
    }

    fn take(&mut self, trial: usize, t: f64, gap: f64) {
        if self.is_done {
            return;
        }
        let here = Trial { t, gap };
        if gap.abs() < self.best.gap.abs() {
            self.best = here;
        }
        let [a, b] = &mut self.ends;
        if trial == 0 {
            *b = here;
            self.is_held = a.gap * gap > 0.0;
        } else if gap * b.gap > 0.0 {
            // The same end moved twice in a row: the other one counts half.
            *b = here;
            a.gap *= 0.5;
        } else {
            (*a, *b) = (*b, here);
        }
        self.is_done = self.is_held || gap.abs() <= self.tolerance;
    }
}
