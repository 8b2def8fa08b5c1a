//! `shrouds pack`: a volume in, a `.shroud` file out.

use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use shrouds_codec::{LabelMap, Packed, Settings, pack, pack_labels};
use shrouds_io::{Frame, Selected, write_atomically};

use crate::args::{PackArgs, Profile};
use crate::commands::unpack::is_packed;
use crate::console::{Console, grouped, plural, print_json};
use crate::failure::Failure;
use crate::input;
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::name;
use crate::selection::Selection;
use crate::settings::{border, face_rule};

/// What was packed, and into how much.
#[derive(Serialize)]
struct Report {
    input: String,
    output: String,
    selection: String,
    dims: [usize; 3],
    profile: Profile,
    /// Labels that were packed; null for a volume.
    labels: Option<usize>,
    /// Voxels inside; null for labels.
    inside: Option<u64>,
    /// Grid edges whose ends differ: the vertices of the surface, or of the boundaries of all labels.
    vertices: u64,
    /// Bytes of the file, and of the topology in it.
    bytes: u64,
    topology_bytes: u64,
    chunks: u64,
    /// Bits of topology per triangle, of which there are two for each vertex; null without vertices.
    bits_per_triangle: Option<f64>,
    seconds: f64,
}

pub(crate) fn run(args: &PackArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    args.volume.refuse_coordinates()?;
    if !is_packed(&args.output) {
        let message = "packed volumes are written to .shroud";
        return Err(Failure::Call(format!("{}: {message}", args.output.display())));
    }
    check_targets(&[&args.output], &[&args.input])?;
    let progress = Progress::new(console.quiet);
    let mut report = if args.each.is_some() {
        labels(args, console, &progress)
    } else {
        volume(args, console, &progress)
    }?;
    drop(progress);
    report.seconds = start.elapsed().as_secs_f64();
    if args.json {
        return print_json(&report);
    }
    console.message(&report.in_words());
    Ok(())
}

fn volume(args: &PackArgs, console: Console, progress: &Progress) -> Result<Report, Failure> {
    let (_, _, contents) = input::contents(&args.input, &args.volume, console)?;
    let selection = Selection::new(&args.input, &args.volume, &contents)?;
    let Selected { occupancy, frame, .. } =
        input::selected(&args.input, &args.volume, &selection, console, progress)?;
    let inside = occupancy.count();
    if inside == 0 {
        let words = &selection.words;
        console.warn(&format!("{}: nothing is inside ({words})", args.input.display()));
    }
    let packed = write(args, progress, |out| pack(&occupancy, &settings(args, &frame), out))?;
    let dims = occupancy.grid().dims();
    Ok(Report::new(args, selection.words, dims, packed, None, Some(inside)))
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
    let packed =
        write(args, progress, |out| pack_labels(&map, &settings(args, &volume.frame), out))?;
    let (dims, count) = (map.grid().dims(), map.labels().len());
    Ok(Report::new(args, "all labels".into(), dims, packed, Some(count), None))
}

fn settings(args: &PackArgs, frame: &Frame) -> Settings {
    Settings {
        profile: match args.profile {
            Profile::Fast => shrouds_codec::Profile::Fast,
            Profile::Dense => shrouds_codec::Profile::Dense,
        },
        slab_height: args.slab.map(|layers| layers as usize),
        independent: args.independent,
        faces: face_rule(args.faces),
        border: border(args.border),
        space: frame.name.clone(),
        unit: frame.unit.clone(),
    }
}

/// Writes a file that appears whole or not at all.
fn write(
    args: &PackArgs,
    progress: &Progress,
    pack: impl FnOnce(&mut Vec<u8>) -> Result<Packed, shrouds_codec::Error>,
) -> Result<Packed, Failure> {
    progress.stage("packing");
    let mut bytes = Vec::new();
    let packed = pack(&mut bytes)?;
    write_atomically(&args.output, |out| out.write_all(&bytes))?;
    Ok(packed)
}

impl Report {
    fn new(
        args: &PackArgs,
        selection: String,
        dims: [usize; 3],
        packed: Packed,
        labels: Option<usize>,
        inside: Option<u64>,
    ) -> Self {
        let bits = 8.0 * packed.topology as f64;
        Self {
            input: name(&args.input),
            output: name(&args.output),
            selection,
            dims,
            profile: args.profile,
            labels,
            inside,
            vertices: packed.vertices,
            bytes: packed.bytes,
            topology_bytes: packed.topology,
            chunks: packed.chunks,
            bits_per_triangle: (packed.vertices > 0).then(|| bits / (2.0 * packed.vertices as f64)),
            seconds: 0.0,
        }
    }

    fn in_words(&self) -> String {
        let what =
            self.labels.map_or(String::new(), |count| format!("{}, ", plural(count, "label")));
        let rate = self
            .bits_per_triangle
            .map_or(String::new(), |bits| format!(", {bits:.3} bits per triangle"));
        format!(
            "{}: {what}{} vertices in {} bytes{rate}, {:.2} s",
            Path::new(&self.output).display(),
            grouped(self.vertices),
            grouped(self.bytes),
            self.seconds
        )
    }
}
