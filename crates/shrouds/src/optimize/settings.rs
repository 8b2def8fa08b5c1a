//! What a caller can choose about the optimisation.

use std::sync::Arc;

use crate::energy::{Bending, Energy, Variation};
use crate::error::Error;
use crate::volume::Occupancy;

/// How the minimum is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Box-constrained Gauss–Newton with conjugate gradients, all vertices at once.
    #[default]
    Newton,
    /// The paper's method (section 2): sweeps over the vertices in order, one univariate
    /// minimisation each.
    Sweeps,
}

/// How much work the default method puts into coming near the minimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Preset {
    /// One step: smooth to the eye, at the least cost.
    Fast,
    /// Three steps: near the minimum on smooth shapes, not on thin ones.
    #[default]
    Default,
    /// Steps until the stop rule is satisfied; unless another energy is asked for, on bending and then
    /// on variation.
    Exact,
}

/// Where the vertices start.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Start {
    /// Where the occupancy, blurred by one voxel, passes one half.
    #[default]
    Blur,
    /// The middle of the grid edges: the midpoint surface M (equation 2).
    Midpoint,
    /// As near to the inside ends as the margin allows: all δ as large as they can be.
    Inside,
    /// As near to the outside ends as the margin allows.
    Outside,
    /// Anywhere on the grid edges, drawn from this seed.
    Random(u64),
    /// At these δ, one for each vertex, from 0 to 1: those of an earlier result, say. What would only
    /// prepare the work with another energy is left out.
    Given(Arc<[f64]>),
}

/// Creases: edges stay sharp between faces that become flat, where the data has them.
///
/// A vertex where its curve turns by much more than the angle counts next to nothing: the square of
/// its turning is weighted by `1/(1 + (θ/angle)²)²`, frozen for each pass, which makes the energy one
/// of Geman and McClure. For shapes that have edges and flat faces; smooth shapes become faceted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crease {
    /// The angle in radians by which a curve may turn at a vertex without a crease. Range [0.01, 1];
    /// default 0.1.
    pub angle: f64,
}

impl Default for Crease {
    fn default() -> Self {
        Self { angle: 0.1 }
    }
}

/// Whether the volume that the surface encloses is left to the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum VolumeRule {
    /// It is.
    #[default]
    Free,
    /// Every connected component of the surface encloses as many voxel volumes as voxels, as far as the
    /// bounds allow: a constraint with one Lagrange multiplier for each. For [`Solver::Newton`] and a
    /// closed border.
    Keep,
}

/// Settings of the optimisation.
#[derive(Clone)]
pub struct Settings {
    /// What to minimise. Default none: what the preset is made for, see [`Settings::energy`].
    pub energy: Option<Energy>,
    /// The method. Default [`Solver::Newton`].
    pub solver: Solver,
    /// How much work [`Solver::Newton`] does. Default [`Preset::Default`].
    pub preset: Preset,
    /// Where to start from. Default [`Start::Blur`].
    pub start: Start,
    /// δ stays within `[margin, 1 − margin]`, so that no vertex touches a lattice point.
    /// Range [1e-6, 0.1]; default 0.002.
    pub margin: f64,
    /// What is known of every δ: it stays within its interval, as far as that leaves the margin. One for
    /// each vertex, the lower end first, both from 0 to 1. Not where volumes are kept. Default none.
    pub intervals: Option<Arc<[[f64; 2]]>>,
    /// Whether volumes are kept. Default [`VolumeRule::Free`].
    pub volume: VolumeRule,
    /// When to stop. `Newton` with [`Preset::Exact`]: when, with weights frozen anew, the root mean
    /// square of the next step falls to it, every move counted up to 0.01, and that of the projected
    /// step too; the other presets do not look at it. `Sweeps`: when ‖δᵏ − δᵏ⁺¹‖/‖δᵏ⁺¹‖ falls to
    /// it, the paper's rule.
    /// Range (0, 1); default 5e-4 for `Newton`, 1e-6 for `Sweeps`.
    pub tolerance: Option<f64>,
    /// Hard limit on Gauss–Newton steps or sweeps. Default 100, or 400 where volumes are kept, or 1000.
    pub max_iterations: Option<usize>,
    /// Whether creases stay; not with what [`converges`](Settings::converges), as their weights never
    /// come to rest. Default none: all is smooth.
    pub crease: Option<Crease>,
    /// Lattice points near which the surface need not be smooth: the energy does not count at vertices
    /// whose grid edge has one of them as an end. On the grid of the volume. Default none.
    pub rough: Option<Arc<Occupancy>>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            energy: None,
            solver: Solver::default(),
            preset: Preset::default(),
            start: Start::default(),
            margin: 0.002,
            intervals: None,
            volume: VolumeRule::default(),
            tolerance: None,
            max_iterations: None,
            crease: None,
            rough: None,
        }
    }
}

impl Settings {
    /// The energy in force: unless another one is asked for [`Variation`] with [`Preset::Exact`], else
    /// [`Bending`].
    pub fn energy(&self) -> Energy {
        match &self.energy {
            Some(energy) => energy.clone(),
            None if self.solver == Solver::Newton && self.preset == Preset::Exact => {
                Variation.into()
            }
            None => Bending.into(),
        }
    }

    /// The tolerance in force.
    pub fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(match self.solver {
            Solver::Newton => 5e-4,
            Solver::Sweeps => 1e-6,
        })
    }

    /// The iteration limit in force.
    pub fn max_iterations(&self) -> usize {
        self.max_iterations.unwrap_or(match self.solver {
            Solver::Newton if self.volume == VolumeRule::Keep => 400,
            Solver::Newton => 100,
            Solver::Sweeps => 1000,
        })
    }

    /// Between what positions along the grid edges stay.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        [self.margin, 1.0 - self.margin]
    }

    /// Whether the work goes on until the stop rule is satisfied.
    pub fn converges(&self) -> bool {
        self.solver == Solver::Sweeps || self.preset == Preset::Exact
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        let refuse =
            |name, value: f64, range| Err(Error::Setting { name, value: value.to_string(), range });
        if !(1e-6..=0.1).contains(&self.margin) {
            return refuse("margin", self.margin, "between 1e-6 and 0.1");
        }
        if !(self.tolerance() > 0.0 && self.tolerance() < 1.0) {
            return refuse("tolerance", self.tolerance(), "above 0 and below 1");
        }
        if self.volume == VolumeRule::Keep && self.solver == Solver::Sweeps {
            return Err(cannot_keep("free for the sweeps"));
        }
        if self.volume == VolumeRule::Keep && self.intervals.is_some() {
            return Err(cannot_keep("free where intervals are given"));
        }
        match self.crease {
            Some(Crease { angle }) if !(0.01..=1.0).contains(&angle) => {
                refuse("crease angle", angle, "between 0.01 and 1 radians")
            }
            Some(_) if self.converges() => Err(Error::Setting {
                name: "crease",
                value: "on".into(),
                range: "off for the exact preset and for the sweeps, which converge",
            }),
            _ => Ok(()),
        }
    }
}

/// That volumes cannot be kept, and what is possible.
pub(super) fn cannot_keep(range: &'static str) -> Error {
    Error::Setting { name: "volume", value: "keep".into(), range }
}
