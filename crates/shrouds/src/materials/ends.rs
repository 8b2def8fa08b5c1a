//! What the curves have of the energy where junctions are next to them.

use crate::energy::{CurveEnergy, LANES, Support, Term};
use crate::materials::network::Curves;
use crate::materials::rows::{Row, UNKNOWNS};
use crate::materials::window::Window;
use crate::network::Network;
use crate::optimize::{Real, Univariate, power_of_root};
use crate::parallel;

/// The residuals of one measure with junctions in their stencils, by their own crossings.
pub(super) struct Ends<R> {
    windows: Vec<Window>,
    /// The first window of every unknown, if it is a crossing's own, and the end.
    firsts: Vec<u32>,
    weights: Vec<f32>,
    pub(super) rows: Vec<Row<2>>,
    spacing: [R; 3],
    support: Support,
}

impl<R: Real> Ends<R> {
    pub(super) fn new(curves: &Curves, support: Support, spacing: [f64; 3]) -> Self {
        let mut windows = Window::all(curves, if support == Support::NextTwo { 4 } else { 3 });
        // What lies together in the lattice is read together.
        windows.sort_unstable_by_key(|window| (window.unknowns[1], window.place));
        let row = |window: &Window| {
            let mut unknowns = [window.unknowns[1]; UNKNOWNS];
            unknowns[..4].copy_from_slice(&window.unknowns);
            for (slot, point) in [(4, 0), (5, 3)] {
                let second = u32::from(window.is_junction(point));
                unknowns[slot] = window.unknowns[point] + second;
            }
            Row { unknowns, residual: [0.0; 2], slopes: [[0.0; UNKNOWNS]; 2] }
        };
        let rows = windows.iter().map(row).collect();
        let mut firsts = vec![0; curves.unknown_count() + 1];
        windows.iter().for_each(|window| firsts[window.unknowns[1] as usize + 1] += 1);
        for n in 1..firsts.len() {
            firsts[n] += firsts[n - 1];
        }
        let weights = vec![0.0; windows.len()];
        Self { windows, firsts, weights, rows, spacing: spacing.map(R::from_f64), support }
    }

    /// Sets the Meusnier weights for crossings with these shares.
    pub(super) fn weigh(&mut self, curves: &Curves, measure: &dyn CurveEnergy, shares: &[[R; 2]]) {
        let (network, windows) = (&curves.network, &self.windows);
        let share = |place: usize| {
            shares[network.vertices()[place] as usize][network.steps()[place].curve()]
        };
        let (support, spacing) = (self.support, &self.spacing);
        parallel::fill(&mut self.weights, |n| {
            let place = windows[n].place as usize;
            let share = match support {
                Support::Neighbours => share(place),
                Support::NextTwo => R::from_f64(0.5) * (share(place) + share(place + 1)),
            };
            let weight = power_of_root(share, measure.meusnier_exponent());
            (weight * spacing[usize::from(windows[n].normal)]).to_f64() as f32
        });
    }

    /// Takes the state `x`. Returns the energy.
    pub(super) fn linearise(&mut self, measure: &dyn CurveEnergy, x: &[R]) -> f64 {
        let (windows, weights, spacing) = (&self.windows, &self.weights, &self.spacing);
        // The last of three points stands twice; what moves it counts once.
        let last = if self.support == Support::NextTwo { 3 } else { 2 };
        parallel::update_blocks(&mut self.rows, parallel::NONE, |first, rows, []| {
            let mut energy = 0.0;
            for (n, rows) in rows.chunks_mut(LANES).enumerate() {
                let start = first + n * LANES;
                let windows = &windows[start..start + rows.len()];
                let [by_first, by_second] = [false, true].map(|second| {
                    R::terms(measure, &Window::stencils(windows, spacing, x, second))
                });
                for (lane, row) in rows.iter_mut().enumerate() {
                    let root = (2.0 * f64::from(weights[start + lane])).sqrt();
                    let scaled = |value: R| (root * value.to_f64()) as f32;
                    for r in 0..2 {
                        let (firsts, seconds) = (&by_first.slope[r], &by_second.slope[r]);
                        let [a, b, c, d] = firsts.each_ref().map(|slope| scaled(slope[lane]));
                        let [e, f] = [0, last].map(|point| scaled(seconds[point][lane]));
                        row.slopes[r] = [a, b, c, d, e, f];
                        row.residual[r] = scaled(by_first.residual[r][lane]);
                        energy += 0.5 * f64::from(row.residual[r]).powi(2);
                    }
                }
            }
            energy
        })
    }

    /// Calls `f` with the place and the energy of every residual at the state.
    pub(super) fn for_each_energy(&self, mut f: impl FnMut(usize, f64)) {
        for (window, row) in self.windows.iter().zip(&self.rows) {
            let [a, b] = row.residual.map(f64::from);
            f(window.place as usize, 0.5 * (a * a + b * b));
        }
    }

    /// The numbers of the residuals that depend on a crossing with these places.
    pub(super) fn of_crossing(&self, network: &Network, v: u32, places: [u32; 2]) -> Vec<usize> {
        let mut found = Vec::new();
        for place in places.map(|place| place as usize) {
            for own in place - 2..=place + 1 {
                let crossing = network.vertices()[own] as usize;
                let [first, end] = [0, 1].map(|n| self.firsts[crossing + n] as usize);
                found.extend((first..end).filter(|&n| {
                    let window = &self.windows[n];
                    window.place as usize == own && window.unknowns.contains(&v)
                }));
            }
        }
        found
    }

    /// The energy of a residual at `x` as a function of the position of a crossing.
    pub(super) fn along(&self, n: usize, v: u32, measure: &dyn CurveEnergy, x: &[R]) -> Univariate {
        let window = &self.windows[n];
        let own = window.unknowns.iter().position(|&unknown| unknown == v).unwrap_or_default();
        let Term { residual, slope } = measure.term(&window.stencil(&self.spacing, x));
        let weight = f64::from(self.weights[n]);
        let mut found = Univariate::default();
        for (residual, slope) in residual.into_iter().zip(slope) {
            found.value += weight * residual * residual;
            found.slope += 2.0 * weight * residual * slope[own];
            found.curvature += 2.0 * weight * slope[own] * slope[own];
        }
        found
    }
}
