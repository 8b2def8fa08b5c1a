//! Volumes in: read, and every voxel put on its side, with messages that say what the file has.

use std::path::{Path, PathBuf};
use std::time::Instant;

use shrouds::{Grid, Occupancy, Select};
use shrouds_io::{
    Contents, Frame, Selected, Volume, VolumeOptions, mesh_format, read_contents, read_occupancy,
    read_volume, volume_format,
};

use crate::args::VolumeArgs;
use crate::console::{Console, number};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::selection::{Selection, list};
use crate::settings::volume_options;

/// An enumerated volume and where it comes from.
#[derive(Clone)]
pub(crate) struct Source {
    /// The file.
    pub(crate) path: PathBuf,
    /// What was selected, in words.
    pub(crate) selection: String,
    /// The inside points, perhaps without empty slices around them.
    pub(crate) occupancy: Occupancy,
    /// The lattice of the file.
    pub(crate) lattice: Grid,
    /// What world coordinates mean.
    pub(crate) frame: Frame,
    /// Volume and area of the body, where a formula gives them.
    pub(crate) truth: [Option<f64>; 2],
    /// Seconds that reading took.
    pub(crate) seconds: f64,
}

/// What a file is by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Volume,
    Mesh,
}

/// Whether the name of a file is that of a volume or of a mesh.
pub(crate) fn kind(path: &Path) -> Result<Kind, Failure> {
    match (mesh_format(path), volume_format(path)) {
        (Ok(_), _) => Ok(Kind::Mesh),
        (_, Ok(_)) => Ok(Kind::Volume),
        (_, Err(error)) => Err(Failure::Call(format!("{error}, meshes from .ply, .stl and .obj"))),
    }
}

/// What a volume file says of itself; tells what is doubtful about it.
pub(crate) fn contents(
    path: &Path,
    args: &VolumeArgs,
    console: Console,
) -> Result<(Grid, Frame, Contents), Failure> {
    let (lattice, frame, contents) = read_contents(path, &volume_options(args, &|_, _| {}))?;
    for warning in &contents.warnings {
        console.warn(&format!("{}: {warning}", path.display()));
    }
    Ok((lattice, frame, contents))
}

/// Reads one layer of a volume file.
pub(crate) fn volume(
    path: &Path,
    args: &VolumeArgs,
    layer: Option<usize>,
    progress: &Progress,
) -> Result<Volume, Failure> {
    progress.stage("reading");
    let report = |done, bytes| progress.read(done, bytes);
    let options = volume_options(args, &report);
    Ok(read_volume(path, &VolumeOptions { layer, ..options })?)
}

/// Reads a volume file and selects what is inside, possibly nothing.
pub(crate) fn selected(
    path: &Path,
    args: &VolumeArgs,
    selection: &Selection,
    console: Console,
    progress: &Progress,
) -> Result<Selected, Failure> {
    let mut all: Option<Selected> = None;
    for (layer, select) in &selection.parts {
        let part = layer_part(path, args, selection, (*layer, select), console, progress)?;
        match &mut all {
            Some(all) => all.occupancy.unite(&part.occupancy),
            None => all = Some(part),
        }
    }
    all.ok_or_else(|| Failure::Undone(format!("{}: nothing is selected", path.display())))
}

/// What is selected in one layer.
fn layer_part(
    path: &Path,
    args: &VolumeArgs,
    selection: &Selection,
    (layer, select): (Option<usize>, &Select),
    console: Console,
    progress: &Progress,
) -> Result<Selected, Failure> {
    // Of several labels some may be missing; to say so takes all values.
    if selection.has_several_labels() {
        let volume = volume(path, args, layer, progress)?;
        if let Some(missing) = missing_labels(&volume, select) {
            console.warn(&format!("{}: {missing}", path.display()));
        }
        let occupancy = occupancy(path, &volume, select)?;
        return Ok(Selected { occupancy, frame: volume.frame, contents: volume.contents });
    }
    progress.stage("reading");
    let report = |done, bytes| progress.read(done, bytes);
    let options = volume_options(args, &report);
    Ok(read_occupancy(path, &VolumeOptions { layer, ..options }, select)?)
}

/// Reads a volume file and selects what is inside; nothing inside is a failure.
pub(crate) fn source(
    path: &Path,
    args: &VolumeArgs,
    console: Console,
    progress: &Progress,
) -> Result<Source, Failure> {
    let start = Instant::now();
    let (_, _, contents) = contents(path, args, console)?;
    let selection = Selection::new(path, args, &contents)?;
    let Selected { occupancy, frame, .. } = selected(path, args, &selection, console, progress)?;
    if occupancy.count() == 0 {
        let (layer, select) = &selection.parts[0];
        let volume = volume(path, args, layer.or(args.layer()).or(Some(0)), progress)?;
        return Err(Failure::Undone(format!("{}: {}", path.display(), nothing(&volume, select))));
    }
    let seconds = start.elapsed().as_secs_f64();
    let (path, truth) = (path.into(), [None; 2]);
    let lattice = occupancy.grid().clone();
    Ok(Source { path, selection: selection.words, occupancy, lattice, frame, truth, seconds })
}

/// The inside points of a volume, possibly none.
pub(crate) fn occupancy(
    path: &Path,
    volume: &Volume,
    select: &Select,
) -> Result<Occupancy, Failure> {
    volume
        .occupancy(select)
        .map_err(|error| Failure::Undone(format!("{}: {error}", path.display())))
}

/// Why nothing is inside, and what to do.
fn nothing(volume: &Volume, select: &Select) -> String {
    let range = match volume.values.range() {
        Some((low, high)) => format!("the values go from {} to {}", number(low), number(high)),
        None => "there are no values".into(),
    };
    match select {
        Select::NonZero => {
            "nothing is inside: all values are 0; check that this is the segmentation".into()
        }
        Select::Above(level) => format!(
            "nothing is inside: no value is above {}, {range}; lower --threshold",
            number(*level)
        ),
        Select::Labels(labels) => {
            let present = match volume.values.labels() {
                Some(present) => format!("the labels of the file are {}", labels_in(&present)),
                None => format!("the values are no labels, {range}"),
            };
            let wanted = list(labels.iter().map(i128::to_string));
            format!("nothing is inside: no voxel has label {wanted}; {present}: change --label")
        }
    }
}

/// Which of the selected labels no voxel has, if some voxel has another of them.
fn missing_labels(volume: &Volume, select: &Select) -> Option<String> {
    let Select::Labels(wanted) = select else { return None };
    let present = volume.values.labels()?;
    let has = |label: &&i128| present.binary_search_by_key(*label, |(label, _)| *label).is_ok();
    let missing: Vec<&i128> = wanted.iter().filter(|label| !has(label)).collect();
    if missing.is_empty() || missing.len() == wanted.len() {
        return None;
    }
    let (missing, present) = (list(missing.iter().map(|l| l.to_string())), labels_in(&present));
    Some(format!("no voxel has label {missing}; the labels of the file are {present}"))
}

fn labels_in(present: &[(i128, u64)]) -> String {
    list(present.iter().map(|(label, _)| label.to_string()))
}
