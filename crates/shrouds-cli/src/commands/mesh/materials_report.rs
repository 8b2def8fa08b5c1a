//! What `shrouds mesh --materials` reports.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds::Grid;
use shrouds::materials::{Labels, Shrouds};
use shrouds_io::Frame;
use shrouds_report::Materials;

use crate::console::grouped;
use crate::failure::Failure;
use crate::report::{Lattice, Times, name, peak_memory};
use crate::settings::{Job, SettingsReport};

/// What went in.
pub(crate) struct Given<'a> {
    pub(crate) input: &'a Path,
    pub(crate) lattice: &'a Grid,
    pub(crate) frame: &'a Frame,
    pub(crate) labels: &'a Labels,
    /// Names of labels, where the file has some.
    pub(crate) names: &'a BTreeMap<i128, String>,
}

/// What is said of interfaces and where their labels came from.
#[derive(Serialize)]
pub(crate) struct Report {
    input: Input,
    settings: SettingsReport,
    #[serde(flatten)]
    pub(crate) found: Materials,
    pub(crate) times: Times,
    pub(crate) memory: Option<u64>,
    version: &'static str,
}

#[derive(Serialize)]
struct Input {
    file: String,
    #[serde(flatten)]
    lattice: Lattice,
}

impl Report {
    /// Checks every label; times of writing and all together come when they are known.
    pub(crate) fn new(given: &Given, made: &Shrouds, job: &Job) -> Result<Self, Failure> {
        let start = Instant::now();
        let found = Materials::new(given.labels, made, given.names)?;
        let mut times = Times::new(0.0, made.times);
        times.check = start.elapsed().as_secs_f64();
        Ok(Self {
            input: Input {
                file: name(given.input),
                lattice: Lattice::new(given.lattice, &given.frame.name, &given.frame.unit),
            },
            settings: job.report.clone(),
            found,
            times,
            memory: None,
            version: env!("CARGO_PKG_VERSION"),
        })
    }

    pub(crate) fn finish(&mut self, writing: Instant, start: Instant) {
        self.times.write = writing.elapsed().as_secs_f64();
        self.times.total = start.elapsed().as_secs_f64();
        self.memory = peak_memory();
    }

    pub(crate) fn summary(&self, output: &Path) -> String {
        let found = &self.found;
        let kept = found.solver.kept_volumes.as_ref();
        format!(
            "{}: {} labels, {} contacts, {} vertices, {} triangles, {} of {} voxels in another label, {} faults of label boundaries, {:.2} s{}",
            output.display(),
            found.labels.len(),
            found.contacts.len(),
            grouped(found.topology.vertices as u64),
            grouped(found.topology.triangles as u64),
            found.checks.wrong_label,
            grouped(self.input.lattice.dims.iter().product::<usize>() as u64),
            found.checks.faults(),
            self.times.total,
            kept.map(|kept| format!("; {}", kept.summary())).unwrap_or_default(),
        )
    }
}
