//! The report file: what went in, what was asked, what came out, and whether it holds.

use std::path::Path;

use serde::Serialize;
use shrouds::Choice;
use shrouds::check::CheckReport;
use shrouds::optimize::{self, Preset};
pub(crate) use shrouds_report::{
    Checks, FirstLast, Geometry, Lattice, RmsMax, SolverReport, Times, Topology, peak_memory,
};

use crate::console::plural;
use crate::input::Source;
use crate::settings::{Job, SettingsReport};

/// Everything about one shroud.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Report {
    pub(crate) input: Input,
    pub(crate) settings: SettingsReport,
    pub(crate) topology: Topology,
    pub(crate) solver: SolverReport,
    pub(crate) geometry: Geometry,
    pub(crate) checks: Checks,
    pub(crate) times: Times,
    /// Largest memory in bytes so far, where the system tells it.
    pub(crate) memory: Option<u64>,
    pub(crate) version: &'static str,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Input {
    pub(crate) file: String,
    /// Which voxels are inside, in words.
    pub(crate) selection: String,
    #[serde(flatten)]
    pub(crate) lattice: Lattice,
    /// Number of inside voxels.
    pub(crate) inside: u64,
}

impl Report {
    /// The report of a shroud that was checked in world coordinates. Times of checking, writing and
    /// all together, and the memory, come when they are known.
    pub(crate) fn new(
        source: &Source,
        job: &Job,
        optimization: &optimize::Report,
        times: shrouds::Times,
        checks: &CheckReport,
    ) -> Self {
        Self {
            input: Input::new(source),
            settings: job.report.clone(),
            topology: Topology::new(checks),
            solver: SolverReport::new(optimization),
            geometry: Geometry::new(&source.occupancy, source.truth, checks),
            checks: Checks::new(checks),
            times: Times::new(source.seconds, times),
            memory: None,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// In words, that the preset stopped before the minimum, and what is left, unless it is one that
    /// converges. Together the vertices would move farther than each one alone.
    pub(crate) fn shortfall(&self) -> Option<String> {
        let preset = self.settings.preset.filter(|&preset| preset != Preset::Exact.name())?;
        Some(format!(
            "--preset {preset} stopped after {}, before convergence: each vertex alone would still move {:.1e} voxels RMS",
            plural(self.solver.iterations, "iteration"),
            self.solver.projected_step.rms,
        ))
    }

    /// In words, how well volumes were kept, if they were to be.
    pub(crate) fn kept(&self) -> Option<String> {
        let components = plural(self.solver.volumes.len(), "component");
        let held = self.solver.volumes.iter().filter(|volume| volume.held).count();
        let free = self.solver.volumes.iter().filter(|volume| !volume.held);
        let error = free.map(|volume| volume.relative_error).fold(0.0, f64::max);
        match (self.solver.volumes.len(), held) {
            (0, _) => None,
            (_, 0) => Some(format!("volume of {components} kept to {error:.0e}")),
            _ => Some(format!(
                "volume of {components} kept to {error:.0e}, but for {held} held by the bounds"
            )),
        }
    }
}

impl Input {
    pub(crate) fn new(source: &Source) -> Self {
        Self {
            file: name(&source.path),
            selection: source.selection.clone(),
            lattice: Lattice::new(&source.lattice, &source.frame.name, &source.frame.unit),
            inside: source.occupancy.count(),
        }
    }
}

/// A path as text.
pub(crate) fn name(path: &Path) -> String {
    path.display().to_string()
}
