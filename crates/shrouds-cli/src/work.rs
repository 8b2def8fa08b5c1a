//! The middle of every verb that makes a surface: shroud, check, write, judge.

use std::path::Path;
use std::time::Instant;

use shrouds::check::{CheckReport, CheckSettings, check};
use shrouds::measure::curvatures;
use shrouds::network::Network;
use shrouds::optimize::{self, Status};
use shrouds::volume::Border;
use shrouds::{Grid, Occupancy, Settings, Shroud, TriMesh, shroud_observed};
use shrouds_io::{Frame, Part, mesh_format, write_meshes};
use shrouds_view::LineSet;

use crate::args::{Attribute, FrameChoice};
use crate::console::{Console, plural};
use crate::failure::Failure;
use crate::frame;
use crate::input::Source;
use crate::output::{write_json, write_picture};
use crate::picture::{View, network_lines};
use crate::progress::Progress;
use crate::report::{Report, peak_memory};
use crate::settings::Job;

/// Where the results go.
pub(crate) struct Outputs<'a> {
    pub(crate) mesh: &'a Path,
    pub(crate) picture: Option<&'a Path>,
    pub(crate) report: Option<&'a Path>,
}

/// What is wanted of a shroud besides its mesh.
#[derive(Debug, Clone, Default)]
pub(crate) struct Extras {
    /// The slice curves, for the picture.
    pub(crate) network: bool,
    /// Numbers per vertex.
    pub(crate) attributes: Vec<Attribute>,
}

/// A shroud that was checked, in world coordinates.
pub(crate) struct Made {
    pub(crate) mesh: TriMesh,
    /// Numbers per vertex with their names.
    pub(crate) attributes: Vec<(&'static str, Vec<f32>)>,
    pub(crate) lines: Vec<LineSet>,
    pub(crate) report: Report,
    optimization: optimize::Report,
}

/// What was done.
pub(crate) struct Done {
    pub(crate) report: Report,
    optimization: optimize::Report,
}

/// Shrouds a volume, checks the mesh and writes all files, the mesh first. `start` is when the verb
/// began.
pub(crate) fn produce(
    source: &Source,
    job: &Job,
    outputs: &Outputs,
    extras: &Extras,
    start: Instant,
    console: Console,
    progress: &Progress,
) -> Result<Done, Failure> {
    let mut made = make(source, job, extras, progress)?;
    progress.stage("writing");
    let writing = Instant::now();
    // Drawn first: once the mesh is in place nothing but a full disk keeps the others from it.
    let picture = match outputs.picture {
        Some(path) => Some((path, View::usual().draw(&made.mesh, &made.lines)?)),
        None => None,
    };
    let part = PartOf::new(&mut made, String::new(), None);
    write(outputs.mesh, &mut [part], &source.lattice, &source.frame, job.frame, console)?;
    if let Some((path, picture)) = picture {
        write_picture(path, &picture)?;
    }
    let Made { mut report, optimization, .. } = made;
    report.times.write = writing.elapsed().as_secs_f64();
    report.times.total = start.elapsed().as_secs_f64();
    report.memory = peak_memory();
    if let Some(path) = outputs.report {
        write_json(path, &report)?;
    }
    Ok(Done { report, optimization })
}

/// Shrouds a volume and checks the mesh.
pub(crate) fn make(
    source: &Source,
    job: &Job,
    extras: &Extras,
    progress: &Progress,
) -> Result<Made, Failure> {
    let shroud = shroud(&source.occupancy, job, progress)?;
    let lines = if extras.network { network_lines(&shroud) } else { Vec::new() };
    let attributes = attributes(&shroud, &extras.attributes);
    let Shroud { surface, delta, mesh, report: optimization, times } = shroud;
    // The check takes their room.
    drop((surface, delta));
    progress.stage("checking");
    let report = judge(&mesh, source, job, &optimization, times)?;
    Ok(Made { mesh, attributes, lines, report, optimization })
}

/// Checks a mesh and reports on it.
pub(crate) fn judge(
    mesh: &TriMesh,
    source: &Source,
    job: &Job,
    optimization: &optimize::Report,
    times: shrouds::Times,
) -> Result<Report, Failure> {
    let checking = Instant::now();
    let checks = certify(mesh, &source.occupancy, job)?;
    let mut report = Report::new(source, job, optimization, times, &checks);
    report.times.check = checking.elapsed().as_secs_f64();
    Ok(report)
}

/// Numbers for every vertex of a primal mesh.
fn attributes(shroud: &Shroud, wanted: &[Attribute]) -> Vec<(&'static str, Vec<f32>)> {
    let mut found = Vec::new();
    if wanted.contains(&Attribute::Delta) {
        found.push(("delta", shroud.delta.iter().map(|delta| *delta as f32).collect()));
    }
    if wanted.contains(&Attribute::Curvature) {
        let network = Network::trace(&shroud.surface);
        let curvatures = curvatures(&network, &shroud.mesh.vertices, &shroud.mesh.normals);
        found.push(("mean_curvature", curvatures.iter().map(|c| c.mean() as f32).collect()));
        found
            .push(("gaussian_curvature", curvatures.iter().map(|c| c.gaussian() as f32).collect()));
    }
    found
}

/// The shroud of a volume.
pub(crate) fn shroud(
    volume: &Occupancy,
    job: &Job,
    progress: &Progress,
) -> Result<Shroud, Failure> {
    require_surface(volume, job)?;
    shroud_with(volume, &job.settings, progress)
}

/// Fails for a full volume that ends nowhere.
pub(crate) fn require_surface(volume: &Occupancy, job: &Job) -> Result<(), Failure> {
    if job.settings.border == Border::Open && volume.count() == volume.grid().point_count() as u64 {
        let message = "there is no surface: every voxel is inside and the border is open; use --border closed or select less";
        return Err(Failure::Undone(message.into()));
    }
    Ok(())
}

/// The shroud of a volume that has a surface, made with these settings.
pub(crate) fn shroud_with(
    volume: &Occupancy,
    settings: &Settings,
    progress: &Progress,
) -> Result<Shroud, Failure> {
    progress.stage("finding the surface");
    Ok(shroud_observed(volume, settings, &mut |now| {
        progress.optimize(now);
        progress.goes_on()
    })?)
}

/// The certificate of a shroud, less the search for self-intersections.
pub(crate) fn certify(
    mesh: &TriMesh,
    volume: &Occupancy,
    job: &Job,
) -> Result<CheckReport, Failure> {
    let settings = CheckSettings {
        border: job.settings.border,
        faces: job.settings.faces,
        all_axes: false,
        self_intersections: false,
    };
    Ok(check(mesh, volume, &settings)?)
}

/// A mesh on its way into a file.
pub(crate) struct PartOf<'a> {
    pub(crate) name: String,
    pub(crate) label: Option<i128>,
    pub(crate) mesh: &'a mut TriMesh,
    /// Numbers per vertex with their names.
    pub(crate) attributes: &'a [(&'static str, Vec<f32>)],
}

impl<'a> PartOf<'a> {
    pub(crate) fn new(made: &'a mut Made, name: String, label: Option<i128>) -> Self {
        Self { name, label, mesh: &mut made.mesh, attributes: &made.attributes }
    }
}

/// Writes meshes from the same lattice to one file, in the coordinates that were chosen.
pub(crate) fn write(
    path: &Path,
    parts: &mut [PartOf],
    lattice: &Grid,
    world: &Frame,
    choice: FrameChoice,
    console: Console,
) -> Result<(), Failure> {
    let mut spacing = lattice.min_spacing();
    if choice == FrameChoice::Index {
        parts.iter_mut().for_each(|part| frame::to_index(part.mesh, lattice));
        spacing = 1.0;
    }
    let frame = frame::name(choice, world);
    let meshes: Vec<&TriMesh> = parts.iter().map(|part| &*part.mesh).collect();
    let (options, warning) = frame::mesh_options(&meshes, mesh_format(path)?, frame, spacing);
    let numbers: Vec<Vec<shrouds_io::Attribute>> = parts
        .iter()
        .map(|part| {
            let attributes = part.attributes.iter();
            attributes.map(|(name, values)| shrouds_io::Attribute { name, values }).collect()
        })
        .collect();
    let parts: Vec<Part> = parts
        .iter()
        .zip(&numbers)
        .map(|(part, attributes)| Part {
            name: &part.name,
            label: part.label.and_then(|label| label.try_into().ok()),
            mesh: part.mesh,
            attributes,
        })
        .collect();
    write_meshes(path, &parts, &options)?;
    if let Some(warning) = warning {
        console.warn(&format!("{}: {warning}", path.display()));
    }
    Ok(())
}

impl Made {
    /// As [`Done::verdict`].
    pub(crate) fn verdict(&self, job: &Job, console: Console) -> Result<(), Failure> {
        verdict(&self.report, &self.optimization, job, console)
    }
}

impl Done {
    /// How the work ended, once all is written: a failure when the check found a fault, or when the
    /// optimisation did not converge under `--strict`.
    pub(crate) fn verdict(&self, job: &Job, console: Console) -> Result<(), Failure> {
        verdict(&self.report, &self.optimization, job, console)
    }
}

fn verdict(
    report: &Report,
    optimization: &optimize::Report,
    job: &Job,
    console: Console,
) -> Result<(), Failure> {
    if let Some(problem) = report.checks.problems.first() {
        return Err(Failure::Undone(format!(
            "the mesh fails its check: {problem}; this is a fault of the program: please report it with the volume"
        )));
    }
    converged(optimization, job, console)
}

/// Warns when the optimisation was to converge and did not, or fails if that was asked for.
pub(crate) fn converged(
    report: &optimize::Report,
    job: &Job,
    console: Console,
) -> Result<(), Failure> {
    if matches!(report.status, Status::Converged | Status::Preset) {
        return Ok(());
    }
    let advice = match report.status {
        Status::IterationLimit => "raise --max-iterations or --tolerance",
        _ => "no step lowers the energy any more; accept that with a larger --tolerance",
    };
    let message = format!(
        "the optimisation did not converge: {} after {}, remaining step {:.1e} voxels; {advice}",
        report.status.name(),
        plural(report.iterations, "iteration"),
        report.projected_step_rms
    );
    if job.strict {
        return Err(Failure::NotConverged(message));
    }
    console.warn(&message);
    Ok(())
}
