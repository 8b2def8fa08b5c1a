//! What `shrouds mesh --materials` reports: every label and every contact, and whether all holds.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds::Grid;
use shrouds::materials::{Labels, Shrouds};
use shrouds_io::Frame;

use crate::console::grouped;
use crate::failure::Failure;
use crate::materials::{Checks, Contact, LabelReport, contacts, label_reports};
use crate::report::{Lattice, Times, name, peak_memory};
use crate::settings::{Job, SettingsReport};

/// What went in.
pub(super) struct Given<'a> {
    pub(super) input: &'a Path,
    pub(super) lattice: &'a Grid,
    pub(super) frame: &'a Frame,
    pub(super) labels: &'a Labels,
    /// Names of labels, where the file has some.
    pub(super) names: &'a BTreeMap<i128, String>,
}

#[derive(Serialize)]
pub(super) struct Report {
    input: Input,
    settings: SettingsReport,
    topology: Topology,
    solver: Solver,
    /// All labels but the background.
    labels: Vec<LabelReport>,
    contacts: Vec<Contact>,
    checks: Checks,
    pub(super) times: Times,
    memory: Option<u64>,
    version: &'static str,
}

#[derive(Serialize)]
struct Input {
    file: String,
    #[serde(flatten)]
    lattice: Lattice,
}

#[derive(Serialize)]
struct Topology {
    vertices: usize,
    crossings: usize,
    junction_points: usize,
    cell_points: usize,
    triangles: usize,
    junction_lines: usize,
}

#[derive(Serialize)]
struct Solver {
    status: &'static str,
    iterations: usize,
    /// At the start of every pass and after each step.
    energies: Vec<Vec<f64>>,
}

impl Report {
    /// Checks every label; times of writing and all together come when they are known.
    pub(super) fn new(given: &Given, made: &Shrouds, job: &Job) -> Result<Self, Failure> {
        let start = Instant::now();
        let (mesh, labels) = (&made.mesh, label_reports(given.labels, given.names, &made.mesh)?);
        let checks = Checks::of_all(&labels);
        let vertices = mesh.surface.vertices.len();
        Ok(Self {
            input: Input {
                file: name(given.input),
                lattice: Lattice::new(given.lattice, &given.frame.name, &given.frame.unit),
            },
            settings: job.report.clone(),
            topology: Topology {
                vertices,
                crossings: made.crossings,
                junction_points: made.junctions,
                cell_points: vertices - made.crossings - made.junctions,
                triangles: mesh.surface.triangles.len(),
                junction_lines: mesh.lines.len(),
            },
            solver: Solver {
                status: made.report.status.name(),
                iterations: made.report.steps(),
                energies: made.report.passes.clone(),
            },
            labels,
            contacts: contacts(mesh),
            checks,
            times: Times {
                read: 0.0,
                surface: made.times.surface,
                optimize: made.times.optimize,
                mesh: made.times.mesh,
                check: start.elapsed().as_secs_f64(),
                write: 0.0,
                total: 0.0,
            },
            memory: None,
            version: env!("CARGO_PKG_VERSION"),
        })
    }

    pub(super) fn finish(&mut self, writing: Instant, start: Instant) {
        self.times.write = writing.elapsed().as_secs_f64();
        self.times.total = start.elapsed().as_secs_f64();
        self.memory = peak_memory();
    }

    pub(super) fn summary(&self, output: &Path) -> String {
        format!(
            "{}: {} labels, {} contacts, {} vertices, {} triangles, {} of {} voxels in another label, {} faults of label boundaries, {:.2} s",
            output.display(),
            self.labels.len(),
            self.contacts.len(),
            grouped(self.topology.vertices as u64),
            grouped(self.topology.triangles as u64),
            self.checks.wrong_label,
            grouped(self.input.lattice.dims.iter().product::<usize>() as u64),
            self.checks.faults(),
            self.times.total,
        )
    }
}
