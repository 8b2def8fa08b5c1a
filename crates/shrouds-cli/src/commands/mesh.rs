//! `shrouds mesh`: a volume in, its shroud out.

use std::path::Path;
use std::time::Instant;

use shrouds_io::{mesh_format, volume_format};

use crate::args::MeshArgs;
use crate::console::{Console, grouped, number, print_json};
use crate::failure::Failure;
use crate::input;
use crate::output::{check_png, check_targets};
use crate::progress::Progress;
use crate::report::Report;
use crate::settings::Job;
use crate::work::{Outputs, produce};

pub(crate) fn run(args: &MeshArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let job = Job::new(&args.shroud, args.volume.coordinates())?;
    let outputs = Outputs {
        mesh: &args.output,
        picture: args.picture.as_deref(),
        report: args.report.as_deref(),
        network: false,
    };
    check_files(&args.input, &outputs)?;
    job.warn(console);
    let progress = Progress::new(console.quiet);
    let source = input::source(&args.input, &args.volume, console, &progress)?;
    let done = produce(&source, &job, &outputs, start, console, &progress)?;
    drop(progress);
    if args.json {
        print_json(&done.report)?;
    } else {
        console.message(&summary(&args.output, &done.report));
    }
    done.verdict(&job, console)
}

/// Finds out before the work whether the files can be what they are to be.
fn check_files(input: &Path, outputs: &Outputs) -> Result<(), Failure> {
    volume_format(input)?;
    mesh_format(outputs.mesh)?;
    outputs.picture.map_or(Ok(()), check_png)?;
    let targets = [Some(outputs.mesh), outputs.picture, outputs.report];
    check_targets(&targets.into_iter().flatten().collect::<Vec<_>>(), &[input])
}

fn summary(output: &Path, report: &Report) -> String {
    let (topology, geometry) = (&report.topology, &report.geometry);
    let shortfall = report.shortfall().map_or(String::new(), |text| format!("; {text}"));
    let kept = report.solver.kept().map_or(String::new(), |text| format!("; {text}"));
    format!(
        "{}: {} vertices, {} triangles, volume {}, area {}, {} of {} voxels on the wrong side, {:.2} s{kept}{shortfall}",
        output.display(),
        grouped(topology.vertices),
        grouped(topology.triangles),
        number(geometry.volume),
        number(geometry.area),
        report.checks.wrong_side,
        grouped(report.input.dims.iter().product::<usize>() as u64),
        report.times.total,
    )
}
