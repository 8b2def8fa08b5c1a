//! `shrouds measure`: what can be said about a surface in numbers.

mod contacts;
mod report;
mod volumes;

use std::path::Path;
use std::time::Instant;

use shrouds::materials::MaterialMesh;
use shrouds::mesh::MeshKind;
use shrouds::optimize::{Preset, Solver};
use shrouds::{Grid, TriMesh};
use shrouds_io::{Frame, read_materials, read_mesh};
use shrouds_report::measure::{Body, Entries, Units, parts};

use crate::args::MeasureArgs;
use crate::console::{Console, print_json};
use crate::failure::Failure;
use crate::input::{self, Kind};
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::{name, peak_memory};
use crate::settings::Job;
use report::{Report, Row, contacts_path};
use volumes::{Name, Other, Run, effort};

/// What lengths are in when the file has no unit but its own.
const OWN_UNIT: &str = "unit";

pub(crate) fn run(args: &MeasureArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let kind = input::kind(&args.input)?;
    let job = job(args)?;
    check_call(args, kind)?;
    let progress = Progress::new(console.quiet);
    let run = Run { args, job: &job, console, progress: &progress, other: other(args)? };
    let (rows, contacts, bodies) = match kind {
        Kind::Mesh => match read_materials(&args.input)? {
            Some(mesh) => (run.materials(&mesh)?, Some(contacts::of_mesh(&mesh)), None),
            None => (run.mesh(&read_mesh(&args.input)?, &Name::default())?, None, None),
        },
        Kind::Volume => {
            job.warn(console);
            let mut bodies = run.volume()?;
            let contacts = args.contacts.then(|| std::mem::take(&mut bodies.contacts));
            (std::mem::take(&mut bodies.rows), contacts, Some(bodies))
        }
    };
    drop(progress);
    let bodies = bodies.as_ref();
    let columns = columns(&rows);
    let unit = bodies.map_or(OWN_UNIT.into(), |of| unit(&of.lattice, &of.frame));
    let report = Report {
        input: name(&args.input),
        selection: bodies.map(|of| of.selection.clone()),
        frame: bodies.map(|of| of.frame.name.clone()),
        handedness: bodies.and_then(|of| handedness(&of.frame)),
        units: Units { entries: &columns, length: &unit },
        unit: unit.clone(),
        settings: (kind == Kind::Volume).then_some(&job.report),
        distance_to: args.distance_to.as_deref().map(name),
        rows: &rows,
        contacts: contacts.as_deref(),
        time: start.elapsed().as_secs_f64(),
        memory: peak_memory(),
        version: env!("CARGO_PKG_VERSION"),
    };
    if let Some(path) = &args.csv {
        report.write_csv(path)?;
    }
    if args.json {
        print_json(&report)?;
    } else {
        console.result(&report.text())?;
        console.message(&effort(rows.len(), report.time));
    }
    strict(&job, &rows)
}

/// Settings of the shrouds: as near to the minimum as it gets, unless something else is asked for.
fn job(args: &MeasureArgs) -> Result<Job, Failure> {
    let mut shroud = args.shroud.clone();
    if shroud.solve.solver == Solver::Newton && shroud.crease.is_none() {
        shroud.solve.preset = shroud.solve.preset.or(Some(Preset::Exact));
    }
    Job::new(&shroud, args.volume.coordinates())
}

/// Finds out before the work what has no meaning, and whether files can be written.
fn check_call(args: &MeasureArgs, kind: Kind) -> Result<(), Failure> {
    args.volume.refuse_coordinates()?;
    if kind == Kind::Mesh && (args.each.is_some() || args.volume.is_given()) {
        let message =
            "is a mesh: --labels and the options of volumes have no meaning; leave them out";
        return Err(Failure::Call(format!("{}: {message}", args.input.display())));
    }
    let mut targets: Vec<&Path> = args.csv.as_deref().into_iter().collect();
    let contacts = args.csv.as_deref().filter(|_| args.contacts || kind == Kind::Mesh);
    let contacts = contacts.map(contacts_path);
    targets.extend(contacts.as_deref());
    let inputs: Vec<&Path> = [Some(&args.input), args.distance_to.as_ref()]
        .into_iter()
        .flatten()
        .map(|p| &**p)
        .collect();
    check_targets(&targets, &inputs)
}

/// The other surface, a volume not read yet.
fn other(args: &MeasureArgs) -> Result<Other, Failure> {
    let Some(path) = &args.distance_to else { return Ok(Other::Nothing) };
    match input::kind(path)? {
        Kind::Mesh => Ok(Other::Mesh(read_mesh(path)?)),
        Kind::Volume => Ok(Other::Volume),
    }
}

impl Run<'_> {
    /// Measures a mesh, or each of its parts.
    fn mesh(&self, mesh: &TriMesh, name: &Name) -> Result<Vec<Row>, Failure> {
        let parts = if self.args.components { parts(mesh) } else { vec![mesh.clone()] };
        let made = match self.other {
            Other::Volume => self.other_selection(None)?,
            _ => None,
        };
        let other = match &self.other {
            Other::Mesh(mesh) => Some(mesh),
            _ => made.as_ref(),
        };
        self.progress.stage("measuring");
        let row = |(n, mesh): (usize, &TriMesh)| {
            let body = Body { mesh, surface: None, kind: MeshKind::Primal, voxels: None };
            let measured = body.measure(other).map_err(|error| {
                let failure = Failure::from(error);
                Failure::Undone(format!("{}: {}", self.args.input.display(), failure.message()))
            })?;
            let component = self.args.components.then_some(n + 1);
            Ok(Row { name: Name { component, ..name.clone() }, measured })
        };
        parts.iter().enumerate().map(row).collect()
    }

    /// Measures every label of a mesh of several materials but the background.
    fn materials(&self, mesh: &MaterialMesh) -> Result<Vec<Row>, Failure> {
        if self.args.distance_to.is_some() {
            let message = "is a mesh of several materials; measure the distance of one closed mesh";
            return Err(Failure::Call(format!("{}: {message}", self.args.input.display())));
        }
        let outside = mesh.contacts();
        let mut rows = Vec::new();
        for (label, closed) in mesh.closed_meshes().filter(|(label, _)| *label != 0) {
            let name = Name { label: Some(label.into()), ..Name::default() };
            let mut of_label = self.mesh(&closed, &name)?;
            if !self.args.components {
                let area = outside.get(&[label, 0]).map_or(0.0, |(_, area)| *area);
                of_label.iter_mut().for_each(|row| row.add_outside(area));
            }
            rows.append(&mut of_label);
        }
        Ok(rows)
    }
}

/// The columns of the row that has most.
fn columns(rows: &[Row]) -> Entries {
    let longest = rows.iter().max_by_key(|row| row.measured.entries.0.len());
    longest.map_or(Entries::default(), |row| row.measured.entries.clone())
}

/// What lengths are in: voxels where nothing gives them another meaning.
fn unit(lattice: &Grid, frame: &Frame) -> String {
    match frame.unit.as_str() {
        "unknown" if frame.name == "index" && lattice.spacing() == [1.0; 3] => "voxel".into(),
        "unknown" => OWN_UNIT.into(),
        unit => unit.to_owned(),
    }
}

/// Whether x, y and z of the world are a right-handed or a left-handed system, where its name tells.
fn handedness(frame: &Frame) -> Option<&'static str> {
    match frame.name.as_str() {
        "RAS" | "LPS" => Some("right"),
        "LAS" => Some("left"),
        _ => None,
    }
}

/// A failure when something did not converge and that was asked for.
fn strict(job: &Job, rows: &[Row]) -> Result<(), Failure> {
    let is_late = |row: &&Row| row.measured.notes.iter().any(|note| note == volumes::LATE);
    match rows.iter().filter(is_late).count() {
        0 => Ok(()),
        _ if !job.strict => Ok(()),
        count => Err(Failure::NotConverged(format!(
            "the optimisation of {count} of {} bodies did not converge; raise --max-iterations or --tolerance",
            rows.len()
        ))),
    }
}
