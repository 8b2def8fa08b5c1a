//! `shrouds check` of a mesh of several materials: every label against its lattice points.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Serialize;
use shrouds::Grid;
use shrouds::materials::MaterialMesh;
use shrouds::volume::Border;
use shrouds_report::{Contact, LabelChecks, LabelReport, contacts, label_reports};

use crate::args::{CheckArgs, FrameChoice};
use crate::commands::mesh::materials::names;
use crate::console::{Console, grouped, print_json};
use crate::failure::Failure;
use crate::input;
use crate::materials::labels;
use crate::progress::Progress;
use crate::report::name;

/// The findings as JSON.
#[derive(Serialize)]
struct Report {
    mesh: String,
    volume: String,
    vertices: usize,
    triangles: usize,
    /// Sums over all labels.
    checks: LabelChecks,
    /// Labels of the mesh that the volume has not.
    unknown_labels: Vec<i64>,
    labels: Vec<LabelReport>,
    contacts: Vec<Contact>,
    version: &'static str,
}

pub(super) fn run(
    args: &CheckArgs,
    volume: &Path,
    mesh: &MaterialMesh,
    console: Console,
) -> Result<(), Failure> {
    refuse_other_settings(args)?;
    let progress = Progress::new(console.quiet);
    let (lattice, _, contents) = input::contents(volume, &args.selection, console)?;
    let lattice = match args.selection.coordinates() {
        FrameChoice::World => lattice,
        FrameChoice::Index => Grid::new(lattice.dims(), [1.0; 3])?,
    };
    let labels = labels(volume, &args.selection, &lattice, &progress)?;
    progress.stage("checking");
    let names = names(&contents);
    let reports = label_reports(&labels, &names, mesh)?;
    let known: BTreeSet<i64> = labels.values().iter().copied().collect();
    let report = Report {
        mesh: name(&args.mesh),
        volume: name(volume),
        vertices: mesh.surface.vertices.len(),
        triangles: mesh.surface.triangles.len(),
        checks: LabelChecks::of_all(&reports),
        unknown_labels: mesh.labels().into_iter().filter(|l| !known.contains(l)).collect(),
        labels: reports,
        contacts: contacts(mesh),
        version: env!("CARGO_PKG_VERSION"),
    };
    drop(progress);
    if args.json {
        print_json(&report)?;
    } else {
        console.result(&report.lines(lattice.point_count()))?;
    }
    report.judge(args, volume)
}

/// Which labels there are says the mesh, and its borders are closed.
fn refuse_other_settings(args: &CheckArgs) -> Result<(), Failure> {
    let given = [
        (args.certificate.is_some(), "--certificate"),
        (args.faces.is_some(), "--faces"),
        (args.border == Some(Border::Open), "--border open"),
        (args.all_axes, "--all-axes"),
        (args.selection.labels.len() == 1, "--label"),
        (args.selection.threshold.is_some(), "--threshold"),
    ];
    match given.into_iter().find(|(is_given, _)| *is_given) {
        None => Ok(()),
        Some((_, flag)) => Err(Failure::Call(format!(
            "{}: a mesh of several materials cannot go with {flag}; leave it out, or name the closed mesh of one label",
            args.mesh.display()
        ))),
    }
}

impl Report {
    /// What is wrong, in words; nothing if all is well.
    fn problems(&self) -> Vec<String> {
        let checks = &self.checks;
        let counts = [
            (checks.wrong_label, "lattice points lie in another label"),
            (checks.boundary_edges, "edges of labels have one triangle"),
            (checks.non_manifold_edges, "edges of labels have more than two triangles"),
            (
                checks.non_manifold_vertices,
                "vertices of labels have more than one fan of triangles",
            ),
            (checks.inconsistent_edges, "edges of labels have triangles that face opposite sides"),
            (checks.self_intersections, "pairs of triangles of labels intersect"),
            (self.unknown_labels.len() as u64, "labels of the mesh are not in the volume"),
        ];
        let wrong = counts.into_iter().filter(|(count, _)| *count > 0);
        wrong.map(|(count, what)| format!("{} {what}", grouped(count))).collect()
    }

    /// A line for all labels, one for each that something is wrong with, and one for each problem.
    fn lines(&self, points: usize) -> String {
        let is_well = |checks: &LabelChecks| checks.wrong_label + checks.faults() == 0;
        let well = self.labels.iter().filter(|label| is_well(&label.checks)).count();
        let mark = |ok: bool| if ok { "ok  " } else { "FAIL" };
        let mut lines = vec![format!(
            "{}  {well} of {} labels are closed and oriented manifolds that keep their lattice points, {} in all",
            mark(well == self.labels.len()),
            self.labels.len(),
            grouped(points as u64)
        )];
        lines.extend(self.labels.iter().filter(|label| !is_well(&label.checks)).map(|label| {
            let LabelReport { label, name, checks, .. } = label;
            format!(
                "FAIL  label {label} {name}: {} of its lattice points in another label or others in it, {} faults of its boundary",
                checks.wrong_label,
                checks.faults()
            )
        }));
        lines.extend(self.problems().into_iter().map(|problem| format!("      {problem}")));
        lines.push(format!("note  {} contacts between labels", self.contacts.len()));
        lines.join("\n")
    }

    fn judge(&self, args: &CheckArgs, volume: &Path) -> Result<(), Failure> {
        match self.problems().first() {
            None => Ok(()),
            Some(first) => Err(Failure::Undone(format!(
                "{} does not separate the labels of {} as it should: {first}; see that --frame is the one the mesh was made with",
                args.mesh.display(),
                volume.display()
            ))),
        }
    }
}
