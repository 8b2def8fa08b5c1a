//! `shrouds unpack`: a `.shroud` file in, a mesh, meshes or a volume out.

mod labels;
mod mesh;
mod volume;

use std::time::Instant;

use shrouds::Occupancy;
use shrouds::volume::{Border, FaceRule};
use shrouds_codec::{Chunk, Content, Header, read_header, unpack, unpack_labels, unpack_partial};
use shrouds_io::{mesh_format, written_format, written_label_format};

use crate::args::{self, UnpackArgs};
use crate::console::Console;
use crate::each::Target;
use crate::failure::Failure;
use crate::output::check_targets;
use crate::packed::open;
use crate::progress::Progress;
use crate::selection::list;

/// A volume and where it comes from.
struct Volume {
    header: Header,
    occupancy: Occupancy,
    selection: String,
    /// The bit planes that are there.
    planes: Vec<Chunk>,
    /// What the file should hold and does not.
    lost: Option<String>,
}

pub(crate) fn run(args: &UnpackArgs, console: Console) -> Result<(), Failure> {
    let start = Instant::now();
    let header = open(&args.input, read_header)?;
    let is_map = matches!(header.content, Content::Labels(_));
    let is_each = is_map && args.labels.is_empty();
    let is_mesh = mesh_format(&args.output).is_ok();
    let target = Target { output: &args.output, extension: &args.format, input: &args.input };
    let is_folder = is_each && target.is_folder();
    match is_mesh || is_folder {
        true => {}
        false if is_each => drop(written_label_format(&args.output)?),
        false => drop(written_format(&args.output)?),
    }
    check_bits(args, &header, is_mesh || is_folder)?;
    if !is_folder {
        check_targets(&[&args.output], &[&args.input])?;
    }
    let progress = Progress::new(console.quiet);
    progress.stage("unpacking");
    match (is_each, is_mesh || is_folder) {
        (true, true) => labels::meshes(args, target, &header, start, console, progress),
        (true, false) => labels::write(args, console, progress),
        (false, true) => mesh::run(args, read(args, is_map)?, start, console, progress),
        (false, false) => volume::run(args, read(args, is_map)?, console, progress),
    }
}

/// Refuses to read bits that the file does not have, or that are not wanted.
fn check_bits(args: &UnpackArgs, header: &Header, is_mesh: bool) -> Result<(), Failure> {
    let problem = match args.bits {
        Some(_) if !is_mesh => "--bits is for meshes, and a volume has no places of vertices",
        Some(bits) if bits > header.planes => {
            return Err(Failure::Call(format!(
                "{}: --bits {bits} is more than the {} that the file has for the places of the vertices",
                args.input.display(),
                header.planes
            )));
        }
        _ => return Ok(()),
    };
    Err(Failure::Call(problem.into()))
}

fn read(args: &UnpackArgs, is_map: bool) -> Result<Volume, Failure> {
    if !is_map {
        if !args.labels.is_empty() {
            let message = "--label is for packed labels, and this file holds a volume";
            return Err(Failure::Call(format!("{}: {message}", args.input.display())));
        }
        let read = |file| if args.partial { unpack_partial(file) } else { unpack(file) };
        let unpacked = open(&args.input, read)?;
        return Ok(Volume {
            header: unpacked.header,
            occupancy: unpacked.volume,
            selection: "all that was packed".into(),
            planes: unpacked.planes,
            lost: unpacked.lost,
        });
    }
    let (header, map) = open(&args.input, unpack_labels)?;
    if let Some(missing) = args.labels.iter().find(|label| !map.labels().contains(label)) {
        let there = list(map.labels().iter().map(i64::to_string));
        let message =
            format!("there is no label {missing}; the labels are {there}: change --label");
        return Err(Failure::Undone(format!("{}: {message}", args.input.display())));
    }
    let mut occupancy = Occupancy::empty(map.grid().clone());
    args.labels.iter().for_each(|&label| occupancy.unite(&map.occupancy(label)));
    let selection = list(args.labels.iter().map(i64::to_string));
    Ok(Volume { header, occupancy, selection, planes: Vec::new(), lost: None })
}

/// The arguments of the shroud, with the conventions of the file.
fn shroud_args(args: &UnpackArgs, header: &Header) -> Result<args::ShroudArgs, Failure> {
    let mut shroud = args.shroud.clone();
    let Header { faces, border, .. } = *header;
    let solve = &mut shroud.solve;
    let is_asked = |differs: bool, is_usual: bool| differs && !is_usual;
    if is_asked(solve.faces != faces, solve.faces == FaceRule::Separate)
        || is_asked(solve.border != border, solve.border == Border::Closed)
    {
        let message = "--faces and --border are those the file was packed with; leave them out";
        return Err(Failure::Call(format!("{}: {message}", args.input.display())));
    }
    (solve.faces, solve.border) = (faces, border);
    Ok(shroud)
}
