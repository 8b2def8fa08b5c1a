//! The report on a shroud, as the program writes it.

use pyo3::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value};
use shrouds::check::CheckReport;
use shrouds::{Occupancy, optimize};
use shrouds_report::{Checks, Geometry, Lattice, SolverReport, Times, Topology, peak_memory};

/// What only the caller knows.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Said {
    /// Which voxels are inside, in words.
    selection: String,
    /// Name of the world.
    pub(crate) frame: String,
    /// Unit of length.
    pub(crate) unit: String,
    /// Seconds that packing the array to bits took.
    pub(crate) seconds: f64,
}

/// Everything about one shroud.
#[derive(Serialize)]
pub(crate) struct Report {
    input: Input,
    settings: Map<String, Value>,
    topology: Topology,
    solver: SolverReport,
    geometry: Geometry,
    checks: Checks,
    times: Times,
    memory: Option<u64>,
    version: &'static str,
}

#[derive(Serialize)]
struct Input {
    /// An array comes from none.
    file: Option<String>,
    selection: String,
    #[serde(flatten)]
    lattice: Lattice,
    inside: u64,
}

impl Report {
    pub(crate) fn new(
        volume: &Occupancy,
        said: Said,
        settings: Map<String, Value>,
        optimization: &optimize::Report,
        times: shrouds::Times,
        checks: &CheckReport,
        check_seconds: f64,
    ) -> Self {
        let mut times = Times::new(said.seconds, times);
        times.check = check_seconds;
        times.total = times.read + times.surface + times.optimize + times.mesh + times.check;
        Self {
            input: Input {
                file: None,
                selection: said.selection,
                lattice: Lattice::new(volume.grid(), &said.frame, &said.unit),
                inside: volume.count(),
            },
            settings,
            topology: Topology::new(checks),
            solver: SolverReport::new(optimization),
            geometry: Geometry::new(volume, [None; 2], checks),
            checks: Checks::new(checks),
            times,
            memory: peak_memory(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}
