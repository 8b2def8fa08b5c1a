//! `shrouds pack`: a volume or a mesh in, a `.shroud` file out.

mod call;
mod places;
mod report;
mod source;

use std::time::Instant;

use shrouds_codec::{LabelMap, Packed, Planes, Settings, pack_labels, pack_with_planes};
use shrouds_io::{Frame, write_atomically};

use crate::args::{PackArgs, Profile};
use crate::console::{Console, print_json};
use crate::failure::Failure;
use crate::input;
use crate::output::check_targets;
use crate::progress::Progress;
use call::Call;
use report::{PlanesReport, Report};

pub(crate) fn run(args: &PackArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let call = Call::check(args)?;
    let like = args.lattice.like.as_deref();
    let inputs: Vec<_> = std::iter::once(&*args.input).chain(like).collect();
    check_targets(&[&args.output], &inputs)?;
    let progress = Progress::new(console.quiet);
    let mut report = match call {
        Call::Labels => labels(args, console, &progress),
        _ => volume(args, &call, console, &progress),
    }?;
    drop(progress);
    report.seconds = start.elapsed().as_secs_f64();
    if args.json {
        return print_json(&report);
    }
    console.message(&report.in_words());
    Ok(())
}

fn volume(
    args: &PackArgs,
    call: &Call,
    console: Console,
    progress: &Progress,
) -> Result<Report, Failure> {
    let source = source::read(args, call, console, progress)?;
    let inside = source.occupancy.count();
    if inside == 0 {
        let words = &source.selection;
        console.warn(&format!("{}: nothing is inside ({words})", args.input.display()));
    }
    progress.stage("packing");
    let (planes, distances) = match &source.given {
        Some(given) => {
            let planes = given.encode(args.bits)?;
            progress.stage("measuring");
            let distances = given.distances(&planes, progress)?;
            (planes, Some(distances))
        }
        None => (Planes::default(), None),
    };
    progress.stage("packing");
    let settings = settings(args, &source.frame);
    let packed = write(args, |out| pack_with_planes(&source.occupancy, &settings, &planes, out))?;
    let mut report = Report::new(args, source.selection, source.occupancy.grid().dims(), &packed);
    report.inside = Some(inside);
    report.planes = call.places().zip(distances).map(|(from, distances)| PlanesReport {
        from,
        bits: args.bits,
        bytes: packed.planes,
        distances,
    });
    Ok(report)
}

fn labels(args: &PackArgs, console: Console, progress: &Progress) -> Result<Report, Failure> {
    let (_, _, contents) = input::contents(&args.input, &args.volume, console)?;
    if contents.has_layers_of_segments() && args.volume.layer().is_none() {
        let message = "its segments lie in several layers, perhaps over each other: name one of the layers with --frame N";
        return Err(Failure::Undone(format!("{}: {message}", args.input.display())));
    }
    let volume = input::volume(&args.input, &args.volume, args.volume.layer(), progress)?;
    let values = volume.values.whole().ok_or_else(|| {
        let message =
            "the values are no labels: some are not whole numbers; use --threshold or --label";
        Failure::Undone(format!("{}: {message}", args.input.display()))
    })?;
    let map = LabelMap::new(volume.grid.clone(), &values)?;
    progress.stage("packing");
    let settings = settings(args, &volume.frame);
    let packed = write(args, |out| pack_labels(&map, &settings, out))?;
    let mut report = Report::new(args, "all labels".into(), map.grid().dims(), &packed);
    report.labels = Some(map.labels().len());
    Ok(report)
}

fn settings(args: &PackArgs, frame: &Frame) -> Settings {
    Settings {
        profile: match args.profile {
            Profile::Fast => shrouds_codec::Profile::Fast,
            Profile::Dense => shrouds_codec::Profile::Dense,
        },
        slab_height: args.slab.map(|layers| layers as usize),
        independent: args.independent,
        faces: args.shroud.solve.faces,
        border: args.shroud.solve.border,
        space: frame.name.clone(),
        unit: frame.unit.clone(),
    }
}

/// Writes a file that appears whole or not at all.
fn write(
    args: &PackArgs,
    pack: impl FnOnce(&mut Vec<u8>) -> Result<Packed, shrouds_codec::Error>,
) -> Result<Packed, Failure> {
    let mut bytes = Vec::new();
    let packed = pack(&mut bytes)?;
    write_atomically(&args.output, |out| out.write_all(&bytes))?;
    Ok(packed)
}
