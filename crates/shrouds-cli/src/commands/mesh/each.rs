//! `shrouds mesh --labels all`: a mesh for every label of a volume.

use std::path::Path;
use std::time::Instant;

use shrouds::{Select, TriMesh};
use shrouds_io::{Contents, Volume};

use super::{check_attributes, check_files};
use crate::args::MeshArgs;
use crate::console::Console;
use crate::each::{Each, Finished, Label, Target};
use crate::failure::Failure;
use crate::input;
use crate::output::write_picture;
use crate::picture::View;
use crate::progress::Progress;
use crate::settings::Job;
use crate::work::Extras;

pub(super) fn run(
    args: &MeshArgs,
    job: &Job,
    extras: &Extras,
    start: Instant,
    console: Console,
) -> Result<(), Failure> {
    let target = Target { output: &args.output, extension: &args.format, input: &args.input };
    check_attributes(args, target.format()?)?;
    let files: &[&Path] = if target.is_folder() { &[] } else { &[&args.output] };
    check_files(args, files)?;
    job.warn(console);
    let progress = Progress::new(console.quiet);
    let (lattice, frame, contents) = input::contents(&args.input, &args.volume, console)?;
    let (keeps_meshes, done) = (args.picture.is_some(), Vec::new());
    let mut each = Each { target, job, extras, console, progress, keeps_meshes, done };
    let layers = match args.volume.layer() {
        Some(layer) => vec![Some(layer)],
        None if contents.has_layers_of_segments() => (0..contents.layers).map(Some).collect(),
        None => vec![None],
    };
    for layer in layers {
        let volume = input::volume(&args.input, &args.volume, layer, &each.progress)?;
        add(&mut each, &volume, layer.unwrap_or(0), &contents)?;
    }
    each.require_labels()?;
    each.progress.part("");
    each.progress.stage("writing");
    let picture = match &args.picture {
        Some(path) => Some((path, View::usual().draw(&merged(&each.done), &[])?)),
        None => None,
    };
    each.write_file(&lattice, &frame)?;
    if let Some((path, picture)) = picture {
        write_picture(path, &picture)?;
    }
    each.finish(start, args.report.as_deref(), args.json)
}

/// The labels of one layer of the file.
fn add(each: &mut Each, volume: &Volume, layer: usize, contents: &Contents) -> Result<(), Failure> {
    let path = each.target.input;
    let labels = volume.values.labels().ok_or_else(|| {
        let message = "the values are no labels; give --threshold instead of --labels";
        Failure::Undone(format!("{}: {message}", path.display()))
    })?;
    let count = labels.len();
    for (n, (label, _)) in labels.into_iter().filter(|(label, _)| *label != 0).enumerate() {
        each.progress.part(&format!("label {label}, {} of {count}", n + 1));
        let segment = contents.segments_of(layer).find(|segment| segment.label == label);
        let name = segment.map_or(String::new(), |segment| segment.name.clone());
        let occupancy = input::occupancy(path, volume, &Select::Labels(vec![label]))?;
        let layer = (contents.layers > 1).then_some(layer);
        each.add(Label { label, name, layer }, occupancy, &volume.frame)?;
    }
    Ok(())
}

/// All meshes in one, for the picture.
fn merged(done: &[Finished]) -> TriMesh {
    let mut all = TriMesh::default();
    for Finished { made, .. } in done {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&made.mesh.vertices);
        all.triangles.extend(made.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        all.normals.extend(&made.mesh.normals);
    }
    all
}
