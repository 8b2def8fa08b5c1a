//! `shrouds check`: a mesh against its volume, or a certificate against its files.

use std::path::Path;

use serde::Serialize;
use shrouds::Occupancy;
use shrouds::check::{CheckReport, Found};
use shrouds::volume::{Border, FaceRule};
use shrouds_io::read_materials;

use super::check_materials;
use crate::args::{Axes, CheckArgs};
use crate::certificate::{self, Examined, Subject, Verdict};
use crate::console::{Console, grouped, print_json};
use crate::failure::Failure;
use crate::lines::{self, FairnessReport};
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::{Checks, name};

pub(crate) fn run(args: &CheckArgs, console: Console) -> Result<(), Failure> {
    let is_certificate = args.mesh.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    match &args.volume {
        _ if is_certificate => verify(args, console),
        Some(volume) => {
            let subject = subject(args, volume);
            subject.check_formats()?;
            match read_materials(&args.mesh)? {
                Some(mesh) => check_materials::run(args, volume, &mesh, console),
                None => check(args, &subject, console),
            }
        }
        None => Err(Failure::Call(format!(
            "{}: a mesh is checked against its volume: give it with --volume",
            args.mesh.display()
        ))),
    }
}

fn subject<'a>(args: &'a CheckArgs, volume: &'a Path) -> Subject<'a> {
    Subject {
        mesh: &args.mesh,
        volume,
        selection: &args.selection,
        border: args.border.unwrap_or(Border::Closed),
        faces: args.faces.unwrap_or(FaceRule::Separate),
        all_axes: args.all_axes,
    }
}

fn check(args: &CheckArgs, subject: &Subject, console: Console) -> Result<(), Failure> {
    if let Some(path) = &args.certificate {
        check_targets(&[path], &[&args.mesh, subject.volume])?;
    }
    let progress = Progress::new(console.quiet);
    let examined = subject.examine(console, &progress)?;
    if let Some(path) = &args.certificate {
        certificate::write(path, subject, &examined, &progress)?;
    }
    progress.stage("measuring the fairness");
    let fairness = lines::fairness(&examined.mesh, Some(examined.volume.grid()))?;
    drop(progress);
    if args.json {
        print_json(&Report::new(subject, &examined, fairness))?;
    } else {
        console.result(&lines(&examined.report, &examined.volume, fairness))?;
    }
    verdict(subject, &examined.report)
}

fn verdict(subject: &Subject, report: &CheckReport) -> Result<(), Failure> {
    let problems = report.problems();
    let Some(first) = problems.first() else { return Ok(()) };
    Err(Failure::Undone(format!(
        "{} does not separate the voxels of {} as it should: {first}{}; \
         see that selection, --frame, --border and --faces are those the mesh was made with",
        subject.mesh.display(),
        subject.volume.display(),
        more("problem", problems.len() - 1)
    )))
}

fn more(what: &str, count: usize) -> String {
    match count {
        0 => String::new(),
        1 => format!(" (and one more {what})"),
        more => format!(" (and {more} more {what}s)"),
    }
}

/// The findings as JSON.
#[derive(Serialize)]
struct Report {
    mesh: String,
    volume: String,
    vertices: u64,
    triangles: u64,
    checks: Checks,
    /// Euler characteristic of each component.
    euler: Vec<i64>,
    /// Null for a mesh without triangles.
    fairness: Option<FairnessReport>,
    notes: Vec<String>,
    version: &'static str,
}

impl Report {
    fn new(subject: &Subject, examined: &Examined, fairness: Option<FairnessReport>) -> Self {
        let report = &examined.report;
        let structure = &report.structure;
        Self {
            mesh: name(subject.mesh),
            volume: name(subject.volume),
            vertices: structure.vertices + structure.unused_vertices,
            triangles: structure.triangles,
            checks: Checks::new(report),
            euler: structure.components.iter().map(|component| component.euler).collect(),
            fairness,
            notes: report.notes(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// The findings in words, a line for each thing that was looked at.
fn lines(report: &CheckReport, volume: &Occupancy, fairness: Option<FairnessReport>) -> String {
    let (structure, separation) = (&report.structure, &report.separation);
    let mut lines = vec![
        none("edges with one triangle", &report.stray_boundary_edges),
        none("edges with more than two triangles", &structure.non_manifold_edges),
        none("edges whose triangles face opposite sides", &structure.inconsistent_edges),
        none("vertices with more than one fan of triangles", &structure.non_manifold_vertices),
        none("triangles without area", &structure.degenerate_triangles),
    ];
    if let Some(pairs) = &report.self_intersections {
        lines.push(none("pairs of triangles that intersect", pairs));
    }
    lines.push(line(!separation.inverted, "normals point outside"));
    let points = grouped(volume.grid().point_count() as u64);
    lines.push(none(
        &format!("of {points} lattice points on the wrong side"),
        &separation.wrong_side,
    ));
    lines.push(none(
        "lattice points with a winding number other than 0 and 1",
        &separation.odd_winding,
    ));
    let (found, wanted) = (structure.components.len() as u64, report.expected.surface_components);
    lines.push(topology("number of components", found, wanted));
    let (found, wanted) = (structure.euler(), report.expected.euler);
    lines.push(topology("Euler characteristic", found, Some(wanted)));
    lines.extend(report.problems().iter().map(|problem| format!("      {problem}")));
    lines.extend(report.notes().iter().map(|note| format!("note  {note}")));
    lines.extend(fairness.map(|fairness| format!("note  {}", fairness.in_words())));
    lines.join("\n")
}

fn line(ok: bool, text: &str) -> String {
    format!("{}  {text}", if ok { "ok  " } else { "FAIL" })
}

fn none<T>(what: &str, found: &Found<T>) -> String {
    line(found.is_empty(), &format!("{} {what}", grouped(found.count)))
}

fn topology<T: PartialEq + std::fmt::Display>(what: &str, found: T, wanted: Option<T>) -> String {
    match wanted {
        None => line(true, &format!("{what} {found} (at an open border any may be right)")),
        Some(wanted) if wanted == found => {
            line(true, &format!("{what} {found}, as the voxels ask"))
        }
        Some(wanted) => line(false, &format!("{what} {found}, but the voxels ask for {wanted}")),
    }
}

fn verify(args: &CheckArgs, console: Console) -> Result<(), Failure> {
    let selection = &args.selection;
    let more_is_given = args.volume.is_some()
        || args.certificate.is_some()
        || args.faces.is_some()
        || args.border.is_some()
        || args.all_axes
        || selection.is_given()
        || selection.axes != Axes::Zyx;
    if more_is_given {
        return Err(Failure::Call(format!(
            "{}: a certificate says itself what it is about: give it alone",
            args.mesh.display()
        )));
    }
    let progress = Progress::new(console.quiet);
    let verdict = certificate::verify(&args.mesh, console, &progress)?;
    drop(progress);
    if args.json {
        print_json(&verdict)?;
    } else {
        console.result(&verdict.in_words())?;
    }
    verdict.judge(&args.mesh)
}

impl Verdict {
    /// A line for each part of the certificate, and for each field of it that the files contradict.
    fn in_words(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        let part = |name: &str| -> String { name.split('.').take(2).collect::<Vec<_>>().join(".") };
        for fields in self.fields.chunk_by(|a, b| part(&a.name) == part(&b.name)) {
            if fields.iter().all(|field| field.agrees) {
                lines.push(line(true, &part(&fields[0].name)));
            }
            for field in fields.iter().filter(|field| !field.agrees) {
                let text = format!(
                    "{}: the certificate says {}, the files say {}",
                    field.name, field.certificate, field.files
                );
                lines.push(line(false, &text));
            }
        }
        lines.join("\n")
    }

    fn judge(&self, path: &Path) -> Result<(), Failure> {
        let wrong: Vec<&str> =
            self.fields.iter().filter(|f| !f.agrees).map(|f| f.name.as_str()).collect();
        let path = path.display();
        match wrong[..] {
            [] if self.holds => Ok(()),
            [] => Err(Failure::Undone(format!(
                "{path} is true, and says that the mesh is not as it should be: see its properties"
            ))),
            [first, ..] => {
                // Another file explains all the rest.
                let hash = wrong.iter().find(|name| name.ends_with("sha256"));
                Err(Failure::Undone(format!(
                    "{path} is not true of its files: {} differs{}; \
                     get the files that were certified, or check the mesh anew",
                    hash.unwrap_or(&first),
                    more("field", wrong.len() - 1)
                )))
            }
        }
    }
}
