//! `shrouds render`: a mesh, or the shroud of a volume, into a picture.

use shrouds::TriMesh;
use shrouds_io::read_mesh;
use shrouds_view::LineSet;

use crate::args::{FrameChoice, RenderArgs, SurfaceKind};
use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Kind};
use crate::output::{check_png, check_targets, write_picture};
use crate::picture::{NETWORK_ON_DUAL, View, network_lines};
use crate::progress::Progress;
use crate::settings::Job;
use crate::work;

pub(crate) fn run(args: &RenderArgs, console: Console) -> Result<(), Failure> {
    args.volume.refuse_coordinates()?;
    let job = Job::new(&args.shroud, FrameChoice::World)?;
    let kind = input::kind(&args.input)?;
    check_network(args, kind)?;
    check_png(&args.output)?;
    check_targets(&[&args.output], &[&args.input])?;
    let progress = Progress::new(console.quiet);
    match kind {
        Kind::Mesh => {
            progress.stage("reading");
            let mesh = read_mesh(&args.input)?;
            draw(args, &mesh, &[], &progress)
        }
        Kind::Volume => {
            job.warn(console);
            let source = input::source(&args.input, &args.volume, console, &progress)?;
            let shroud = work::shroud(&source.occupancy, &job, &progress)?;
            let lines = if args.network { network_lines(&shroud) } else { Vec::new() };
            draw(args, &shroud.mesh, &lines, &progress)?;
            drop(progress);
            work::converged(&shroud.report, &job, console)
        }
    }
}

fn check_network(args: &RenderArgs, kind: Kind) -> Result<(), Failure> {
    let message = match kind {
        _ if !args.network => return Ok(()),
        Kind::Mesh => "--network needs a volume: a mesh file does not hold the slice curves",
        Kind::Volume if args.shroud.solve.surface == SurfaceKind::Dual => NETWORK_ON_DUAL,
        Kind::Volume => return Ok(()),
    };
    Err(Failure::Call(message.into()))
}

fn draw(
    args: &RenderArgs,
    mesh: &TriMesh,
    lines: &[LineSet],
    progress: &Progress,
) -> Result<(), Failure> {
    progress.stage("drawing");
    let picture = View::new(&args.view).draw(mesh, lines)?;
    write_picture(&args.output, &picture)
}
