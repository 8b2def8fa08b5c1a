//! `shrouds check`: the certificate of a mesh against its volume.

use serde::Serialize;
use shrouds::check::{CheckReport, CheckSettings, Found, check};
use shrouds::{Grid, Occupancy};
use shrouds_io::{mesh_format, read_mesh, volume_format};

use crate::args::{CheckArgs, FrameChoice};
use crate::console::{Console, grouped, print_json};
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;
use crate::report::{Checks, name};
use crate::selection::Selection;
use crate::settings::{border, face_rule};

pub(crate) fn run(args: &CheckArgs, console: Console) -> Result<(), Failure> {
    mesh_format(&args.mesh)?;
    volume_format(&args.volume)?;
    let progress = Progress::new(console.quiet);
    let volume = volume(args, console, &progress)?;
    progress.stage("reading the mesh");
    let mesh = read_mesh(&args.mesh)?;
    progress.stage("checking");
    let settings = CheckSettings {
        border: border(args.border),
        faces: face_rule(args.faces),
        all_axes: args.all_axes,
        self_intersections: true,
    };
    let report = check(&mesh, &volume, &settings)
        .map_err(|error| Failure::Undone(format!("{}: {error}", args.mesh.display())))?;
    drop(progress);
    if args.json {
        print_json(&Certificate::new(args, &report))?;
    } else {
        console.result(&lines(&report, &volume))?;
    }
    verdict(args, &report)
}

/// The inside points in the frame of the mesh, possibly none.
fn volume(args: &CheckArgs, console: Console, progress: &Progress) -> Result<Occupancy, Failure> {
    let (path, arguments) = (&args.volume, &args.selection);
    let (_, _, contents) = input::contents(path, arguments, console)?;
    let selection = Selection::new(path, arguments, &contents)?;
    let volume = input::selected(path, arguments, &selection, console, progress)?.occupancy;
    match arguments.coordinates() {
        FrameChoice::World => Ok(volume),
        FrameChoice::Index => {
            let grid = Grid::new(volume.grid().dims(), [1.0; 3])?;
            Ok(volume.with_grid(grid)?)
        }
    }
}

fn verdict(args: &CheckArgs, report: &CheckReport) -> Result<(), Failure> {
    let problems = report.problems();
    let Some(first) = problems.first() else { return Ok(()) };
    let more = match problems.len() - 1 {
        0 => String::new(),
        1 => " (and one more problem)".into(),
        more => format!(" (and {more} more problems)"),
    };
    Err(Failure::Undone(format!(
        "{} does not separate the voxels of {} as it should: {first}{more}; \
         see that selection, --frame, --border and --faces are those the mesh was made with",
        args.mesh.display(),
        args.volume.display()
    )))
}

/// The certificate as JSON.
#[derive(Serialize)]
struct Certificate {
    mesh: String,
    volume: String,
    vertices: u64,
    triangles: u64,
    checks: Checks,
    /// Euler characteristic of each component.
    euler: Vec<i64>,
    notes: Vec<String>,
    version: &'static str,
}

impl Certificate {
    fn new(args: &CheckArgs, report: &CheckReport) -> Self {
        let structure = &report.structure;
        Self {
            mesh: name(&args.mesh),
            volume: name(&args.volume),
            vertices: structure.vertices + structure.unused_vertices,
            triangles: structure.triangles,
            checks: Checks::new(report),
            euler: structure.components.iter().map(|component| component.euler).collect(),
            notes: report.notes(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// The certificate in words, a line for each thing that was looked at.
fn lines(report: &CheckReport, volume: &Occupancy) -> String {
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
