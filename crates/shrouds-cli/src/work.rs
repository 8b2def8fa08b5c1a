//! The middle of every verb that makes a surface: shroud, check, write, judge.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use shrouds::check::{CheckReport, CheckSettings, check};
use shrouds::optimize::{self, Status};
use shrouds::volume::Border;
use shrouds::{Occupancy, Shroud, TriMesh, shroud_observed};
use shrouds_io::{mesh_format, write_mesh};

use crate::args::FrameChoice;
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
    /// Whether the picture shows the slice curves.
    pub(crate) network: bool,
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
    start: Instant,
    console: Console,
    progress: &Progress,
) -> Result<Done, Failure> {
    let shroud = shroud(&source.occupancy, job, progress)?;
    let lines = if outputs.network { network_lines(&shroud) } else { Vec::new() };
    let Shroud { surface, delta, mesh, report: optimization, times } = shroud;
    // The check takes their room.
    drop((surface, delta));
    progress.stage("checking");
    let checking = Instant::now();
    let checks = certify(&mesh, &source.occupancy, job)?;
    let mut report = Report::new(source, job, &optimization, times, &checks);
    report.times.check = checking.elapsed().as_secs_f64();

    progress.stage("writing");
    let writing = Instant::now();
    // Drawn first: once the mesh is in place nothing but a full disk keeps the others from it.
    let picture = match outputs.picture {
        Some(path) => Some((path, View::usual().draw(&mesh, &lines)?)),
        None => None,
    };
    write(outputs.mesh, mesh, source, job.frame, console)?;
    if let Some((path, picture)) = picture {
        write_picture(path, &picture)?;
    }
    report.times.write = writing.elapsed().as_secs_f64();
    report.times.total = start.elapsed().as_secs_f64();
    report.memory = peak_memory();
    if let Some(path) = outputs.report {
        write_json(path, &report)?;
    }
    Ok(Done { report, optimization })
}

/// The shroud of a volume.
pub(crate) fn shroud(
    volume: &Occupancy,
    job: &Job,
    progress: &Progress,
) -> Result<Shroud, Failure> {
    if job.settings.border == Border::Open && volume.count() == volume.grid().point_count() as u64 {
        let message = "there is no surface: every voxel is inside and the border is open; use --border closed or select less";
        return Err(Failure::Undone(message.into()));
    }
    progress.stage("finding the surface");
    Ok(shroud_observed(volume, &job.settings, &mut |now| {
        progress.optimize(now);
        ControlFlow::Continue(())
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

fn write(
    path: &Path,
    mut mesh: TriMesh,
    source: &Source,
    choice: FrameChoice,
    console: Console,
) -> Result<(), Failure> {
    let grid = source.occupancy.grid();
    let mut spacing = grid.min_spacing();
    if choice == FrameChoice::Index {
        frame::to_index(&mut mesh, grid);
        spacing = 1.0;
    }
    let name = frame::name(choice, &source.frame);
    let (options, warning) = frame::mesh_options(&mesh, mesh_format(path)?, name, spacing);
    write_mesh(path, &mesh, &options)?;
    if let Some(warning) = warning {
        console.warn(&format!("{}: {warning}", path.display()));
    }
    Ok(())
}

impl Done {
    /// How the work ended, once all is written: a failure when the check found a fault, or when the
    /// optimisation did not converge under `--strict`.
    pub(crate) fn verdict(&self, job: &Job, console: Console) -> Result<(), Failure> {
        if let Some(problem) = self.report.checks.problems.first() {
            return Err(Failure::Undone(format!(
                "the mesh fails its check: {problem}; this is a fault of the program: please report it with the volume"
            )));
        }
        converged(&self.optimization, job, console)
    }
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
