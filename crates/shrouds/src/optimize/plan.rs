//! What the presets do.

use crate::energy::{Bending, Energy, Support};
use crate::optimize::conjugate::Effort;
use crate::optimize::crease::{BARRIERS, Creases};
use crate::optimize::settings::{Crease, Preset, Settings, Start};

/// A part of the work, with one energy.
pub(super) struct Stage<'a> {
    pub(super) energy: Energy,
    pub(super) passes: Passes,
    pub(super) creases: Option<Creases<'a>>,
}

/// Passes over the surface; weights and barrier are frozen anew for each, and a step is one of all
/// vertices.
#[derive(Clone, Copy)]
pub(super) enum Passes {
    /// The steps of every pass.
    Fixed(&'static [&'static [Effort]]),
    /// Passes until one finds next to nothing to do.
    UntilConverged {
        /// For the root mean square of the steps.
        tolerance: f64,
        most_steps: usize,
    },
}

impl Passes {
    /// Whether they are on the way to convergence.
    pub(super) fn converge(self) -> bool {
        match self {
            Self::Fixed(passes) => passes.iter().any(|steps| steps.iter().any(|s| s.converges)),
            Self::UntilConverged { .. } => true,
        }
    }
}

/// The most steps that prepare the work on another energy: enough on smooth surfaces to converge.
const PREPARATION: usize = 20;

/// Steps of a pass that is one of many. More would be wasted on weights that change anyway.
pub(super) const STEPS: [Effort; 3] = [Effort {
    iterations: 120,
    reduction: 1e-2,
    parts: &[1.0, 0.3, 0.1],
    repairs: true,
    converges: true,
}; 3];

const fn iterations(count: usize) -> Effort {
    Effort { iterations: count, reduction: 1e-3, parts: &[1.0], repairs: true, converges: false }
}

const FAST: Passes = Passes::Fixed(&[&[iterations(20)]]);
// What goes wrong in the first step the next one mends.
const FIRST: Effort = Effort { repairs: false, ..iterations(10) };
const DEFAULT: Passes = Passes::Fixed(&[&[FIRST, iterations(20)], &[iterations(30)]]);

/// Of every barrier strength on the way to creases.
const FAST_CREASES: Passes = Passes::Fixed(&[&[iterations(20)]]);
const CREASES: Passes = Passes::Fixed(&[&[iterations(30)], &[iterations(30)]]);

/// The stages that lead to a minimum of the energy asked for. `thinness` is needed for creases, see
/// [`Creases`].
///
/// An energy that looks at four vertices has flat valleys and local minima; it starts from the minimum
/// of bending, which has few, unless it is given where to start. One that lets creases be starts from the one that does not.
pub(super) fn stages<'a>(settings: &Settings, thinness: &'a [f32]) -> Vec<Stage<'a>> {
    let energy = settings.energy();
    let passes = |most_steps| match settings.preset {
        Preset::Fast => FAST,
        Preset::Default => DEFAULT,
        Preset::Exact => Passes::UntilConverged { tolerance: settings.tolerance(), most_steps },
    };
    let mut stages = Vec::new();
    let starts_anew = !matches!(settings.start, Start::Given(_));
    if energy.support() == Support::NextTwo && starts_anew {
        stages.push(Stage { energy: Bending.into(), passes: passes(PREPARATION), creases: None });
    }
    let Some(Crease { angle }) = settings.crease else {
        stages.push(Stage { energy, passes: passes(usize::MAX), creases: None });
        return stages;
    };
    let mut push = |angle, barrier, passes| {
        let creases = Some(Creases { angle, barrier, thinness });
        stages.push(Stage { energy: energy.clone(), passes, creases });
    };
    let creasing = if settings.preset == Preset::Fast { FAST_CREASES } else { CREASES };
    push(f64::INFINITY, BARRIERS[0], passes(usize::MAX));
    for barrier in BARRIERS {
        push(angle, barrier, creasing);
    }
    stages
}
