//! What `shrouds mesh --materials` reports: every label and every contact, and whether all holds.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds::check::{CheckSettings, check};
use shrouds::materials::{Labels, Shrouds};
use shrouds::{Grid, Occupancy, TriMesh};
use shrouds_io::Frame;

use crate::console::grouped;
use crate::failure::Failure;
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

/// A label with its closed boundary, in world units.
#[derive(Serialize)]
struct LabelReport {
    label: i64,
    name: String,
    voxels: u64,
    voxel_volume: f64,
    volume: f64,
    area: f64,
    triangles: usize,
    components: usize,
    #[serde(flatten)]
    checks: Checks,
}

/// Two labels that touch, in the order of their pair, and the area of their triangles.
#[derive(Serialize)]
struct Contact {
    labels: [i64; 2],
    triangles: usize,
    area: f64,
}

/// All should be 0. Of all labels together their sums.
#[derive(Serialize, Default, Clone, Copy)]
struct Checks {
    wrong_label: u64,
    boundary_edges: u64,
    non_manifold_edges: u64,
    non_manifold_vertices: u64,
    inconsistent_edges: u64,
    self_intersections: u64,
}

impl Checks {
    fn counts(&self) -> [u64; 6] {
        [
            self.wrong_label,
            self.boundary_edges,
            self.non_manifold_edges,
            self.non_manifold_vertices,
            self.inconsistent_edges,
            self.self_intersections,
        ]
    }

    fn add(&mut self, other: &Self) {
        self.wrong_label += other.wrong_label;
        self.boundary_edges += other.boundary_edges;
        self.non_manifold_edges += other.non_manifold_edges;
        self.non_manifold_vertices += other.non_manifold_vertices;
        self.inconsistent_edges += other.inconsistent_edges;
        self.self_intersections += other.self_intersections;
    }
}

impl Report {
    /// Checks every label; times of writing and all together come when they are known.
    pub(super) fn new(given: &Given, made: &Shrouds, job: &Job) -> Result<Self, Failure> {
        let start = Instant::now();
        let (mesh, labels) = (&made.mesh, label_reports(given, made)?);
        let mut checks = Checks::default();
        labels.iter().for_each(|label| checks.add(&label.checks));
        let contact = |(labels, (triangles, area))| Contact { labels, triangles, area };
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
            contacts: mesh.contacts().into_iter().map(contact).collect(),
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
        let faults: u64 = self.checks.counts()[1..].iter().sum();
        format!(
            "{}: {} labels, {} contacts, {} vertices, {} triangles, {} of {} voxels in another label, {} faults of label boundaries, {:.2} s",
            output.display(),
            self.labels.len(),
            self.contacts.len(),
            grouped(self.topology.vertices as u64),
            grouped(self.topology.triangles as u64),
            self.checks.wrong_label,
            grouped(self.input.lattice.dims.iter().product::<usize>() as u64),
            faults,
            self.times.total,
        )
    }
}

fn label_reports(given: &Given, made: &Shrouds) -> Result<Vec<LabelReport>, Failure> {
    let occupancies = given.labels.occupancies()?;
    let meshes: BTreeMap<i64, TriMesh> = made.mesh.closed_meshes().collect();
    let own = given.labels.values()[1..].iter().zip(&occupancies);
    own.map(|(&label, occupancy)| {
        let name = given.names.get(&label.into()).cloned().unwrap_or_default();
        label_report(label, name, &meshes[&label], occupancy)
    })
    .collect()
}

fn label_report(
    label: i64,
    name: String,
    mesh: &TriMesh,
    occupancy: &Occupancy,
) -> Result<LabelReport, Failure> {
    let found = check(mesh, occupancy, &CheckSettings::default())?;
    let (structure, voxels) = (&found.structure, occupancy.count());
    let separation = &found.separation;
    let checks = Checks {
        wrong_label: separation.wrong_side.count + separation.odd_winding.count,
        boundary_edges: structure.boundary_edges.count,
        non_manifold_edges: structure.non_manifold_edges.count,
        non_manifold_vertices: structure.non_manifold_vertices.count,
        inconsistent_edges: structure.inconsistent_edges.count,
        self_intersections: found.self_intersections.as_ref().map_or(0, |pairs| pairs.count),
    };
    Ok(LabelReport {
        label,
        name,
        voxels,
        voxel_volume: voxels as f64 * occupancy.grid().voxel_volume(),
        volume: structure.volume,
        area: structure.area,
        triangles: mesh.triangles.len(),
        components: structure.components.len(),
        checks,
    })
}
