//! A packed volume as a mesh, smooth within what its bit planes say.

use std::time::Instant;

use serde::Serialize;
use shrouds::surface::Surface;
use shrouds_codec::geometry::{self, Places};

use super::{Volume, shroud_args};
use crate::args::{ShroudArgs, UnpackArgs};
use crate::console::{Console, grouped, plural, print_json};
use crate::failure::Failure;
use crate::input::Source;
use crate::packed::frame;
use crate::progress::Progress;
use crate::report::Report;
use crate::settings::Job;
use crate::work::{Extras, Outputs, produce};
use shrouds::optimize::{Preset, Solver, VolumeRule};

/// The report of the shroud, and what of the file it is made of.
#[derive(Serialize)]
struct MeshReport {
    /// Bits of the place of every vertex that were read.
    bits: usize,
    /// What the file should hold and does not.
    lost: Option<String>,
    #[serde(flatten)]
    report: Report,
}

pub(super) fn run(
    args: &UnpackArgs,
    volume: Volume,
    start: Instant,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    let fail = |problem: &str| Failure::Undone(format!("{}: {problem}", args.input.display()));
    if volume.occupancy.count() == 0 {
        return Err(fail("nothing is inside: there is no surface; write the volume instead"));
    }
    let places = places(args, &volume)?;
    let (bits, lost) = (places.planes, places.lost.clone());
    if let Some(lost) = &lost {
        if !args.partial {
            return Err(fail(&format!("{lost}; --partial takes what is there")));
        }
        console.warn(&format!("{}: {lost}", args.input.display()));
    }
    let job = job(args, &volume, &places)?;
    job.warn(console);
    let source = Source {
        path: args.input.clone(),
        selection: volume.selection,
        lattice: volume.occupancy.grid().clone(),
        occupancy: volume.occupancy,
        frame: frame(&volume.header),
        truth: [None; 2],
        seconds: start.elapsed().as_secs_f64(),
    };
    let outputs = Outputs { mesh: &args.output, picture: None, report: None };
    let done = produce(&source, &job, &outputs, &Extras::default(), start, console, &progress)?;
    drop(progress);
    let verdict = done.verdict(&job, console);
    if args.json {
        print_json(&MeshReport { bits, lost, report: done.report })?;
    } else {
        let topology = &done.report.topology;
        console.message(&format!(
            "{}: {} vertices placed by {}, {} triangles, {:.2} s",
            args.output.display(),
            grouped(topology.vertices),
            plural(bits, "bit"),
            grouped(topology.triangles),
            done.report.times.total
        ));
    }
    verdict
}

/// What the bit planes say that are there and wanted, and why it is less than was packed.
fn places(args: &UnpackArgs, volume: &Volume) -> Result<Places, Failure> {
    let header = &volume.header;
    let wanted = args.bits.unwrap_or(header.planes).into();
    let payloads: Vec<(&[u8], u32)> =
        volume.planes.iter().map(|plane| (&plane.payload[..], plane.decoded_sum)).collect();
    let surface = Surface::extract(&volume.occupancy, header.faces, header.border)?;
    let settings = &header.plane_settings;
    let mut places = geometry::decode(&surface, settings, &payloads[..payloads.len().min(wanted)]);
    let is_whole = volume.occupancy.grid().dims() == header.grid.dims();
    if places.planes < wanted || !is_whole {
        places.lost = places.lost.or_else(|| volume.lost.clone());
    }
    Ok(places)
}

/// The settings of the shroud: within the intervals of the bit planes, if there are any.
fn job(args: &UnpackArgs, volume: &Volume, places: &Places) -> Result<Job, Failure> {
    let mut shroud = shroud_args(args, &volume.header)?;
    if places.planes == 0 {
        return Job::new(&shroud, args.frame.frame);
    }
    if shroud.solve.volume == VolumeRule::Keep {
        let message = "--volume keep has no meaning where bit planes place the vertices: leave it out, or give --bits 0";
        return Err(Failure::Call(message.into()));
    }
    if is_preset_free(&shroud) {
        shroud.solve.preset = Some(Preset::Exact);
    }
    let mut job = Job::new(&shroud, args.frame.frame)?;
    job.settings.optimize.intervals = Some(places.intervals().collect());
    Ok(job)
}

/// Whether the preset is for the program to choose. Within intervals the one that converges comes much
/// nearer to the surface that was packed: docs/decisions.md.
fn is_preset_free(shroud: &ShroudArgs) -> bool {
    let solve = &shroud.solve;
    solve.preset.is_none() && solve.solver == Solver::Newton && shroud.crease.is_none()
}
