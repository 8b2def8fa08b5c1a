//! `shrouds contain`: where a target can be, contact by contact.

mod report;

use std::path::{Path, PathBuf};
use std::time::Instant;

use shrouds::containment::{Membership, Step};
use shrouds_io::{Part, mesh_format, write_meshes, write_volume};

use crate::args::{ContainArgs, FrameChoice, Paint};
use crate::console::{Console, print_json};
use crate::failure::Failure;
use crate::frame::mesh_options;
use crate::output::{check_targets, make_folder, write_json, write_picture};
use crate::picture::View;
use crate::progress::Progress;
use crate::scene::{self, Painter};
use crate::settings::Job;
use crate::work;

use report::{Report, ShroudReport, StepReport, Written};

/// What the steps share.
struct Work<'a> {
    args: &'a ContainArgs,
    job: &'a Job,
    painter: Painter,
    progress: Progress,
}

pub(crate) fn run(args: &ContainArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let job = Job::new(&args.shroud, FrameChoice::World)?;
    let told = scene::read(&args.scene)?;
    job.warn(console);
    let report_file = prepare(args)?;
    let painter =
        Painter::new(&told, View::new(&args.view, Paint::Plain(args.colour)), args.colour);
    let work = Work { args, job: &job, painter, progress: Progress::new(console.quiet) };
    let mut report = Report::new(args, &told, &job);
    let membership = if args.one_sided { Membership::Cell } else { Membership::Centre };
    let count = told.scene.contacts().len();
    work.progress.part(&format!("contact 1 of {count}"));
    work.progress.stage("finding the region");
    for step in told.scene.steps(membership) {
        let step = step?;
        let last = step.contact + 1 == count;
        let wanted = last || (step.contact + 1).is_multiple_of(args.every as usize);
        let mut found = StepReport::new(&told, &step);
        if wanted && !step.is_empty() {
            let (shroud, written) = work.write(&step, console)?;
            found = found.with_files(shroud, written);
        }
        report.add(found);
        work.progress.part(&format!("contact {} of {count}", step.contact + 2));
        work.progress.stage("finding the region");
    }
    report.finish(start.elapsed().as_secs_f64());
    write_json(&report_file, &report)?;
    drop(work);
    if args.json {
        print_json(&report)?;
    } else {
        console.result(&report.in_words(&args.output))?;
    }
    report.verdict()
}

/// Makes the folder and finds out whether files can appear in it.
fn prepare(args: &ContainArgs) -> Result<PathBuf, Failure> {
    let folder = &args.output;
    make_folder(folder)?;
    let report = folder.join("report.json");
    check_targets(&[&report], &[&args.scene])?;
    Ok(report)
}

impl Work<'_> {
    /// Shrouds the region, checks the mesh and writes volume, mesh and picture.
    fn write(&self, step: &Step, console: Console) -> Result<(ShroudReport, Written), Failure> {
        let number = step.contact + 1;
        let name =
            |extension: &str| self.args.output.join(format!("region-{number:03}.{extension}"));
        let written =
            Written { volume: name(&self.args.format), mesh: name("ply"), picture: name("png") };
        let start = Instant::now();
        let volume = if self.args.one_sided { step.enclosing()? } else { step.region.clone() };
        let shroud = work::shroud(&volume, self.job, &self.progress)?;
        let seconds = start.elapsed().as_secs_f64();
        self.progress.stage("checking");
        let checks = work::certify(&shroud.mesh, &volume, self.job)?;
        if let Some(problem) = checks.problems().first() {
            return Err(Failure::Undone(format!(
                "the mesh of contact {number} fails its check: {problem}; this is a fault of the program: please report it with the scene"
            )));
        }
        work::converged(&shroud.report, self.job, console)?;
        self.progress.stage("writing");
        let picture = self.painter.draw(step, &shroud.mesh)?;
        write_volume(&written.volume, &step.region, &scene::frame())?;
        write_mesh(&written.mesh, &shroud.mesh, step.region.grid().min_spacing())?;
        write_picture(&written.picture, &picture)?;
        Ok((ShroudReport::new(&shroud, &checks, seconds), written))
    }
}

fn write_mesh(path: &Path, mesh: &shrouds::TriMesh, spacing: f64) -> Result<(), Failure> {
    let (options, _) = mesh_options(&[mesh], mesh_format(path)?, scene::frame(), spacing);
    let part = Part { name: "", label: None, mesh, attributes: &[] };
    Ok(write_meshes(path, &[part], &options)?)
}
