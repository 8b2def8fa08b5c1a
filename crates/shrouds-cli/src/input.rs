//! Volumes in: read, and every voxel put on its side, with messages that say what the file has.

use std::path::{Path, PathBuf};
use std::time::Instant;

use shrouds::{Occupancy, Select};
use shrouds_io::{Frame, Volume, mesh_format, read_occupancy, read_volume, volume_format};

use crate::args::VolumeArgs;
use crate::console::{Console, number};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::settings::{select, volume_options};

/// Most labels that a message lists.
const LISTED: usize = 20;

/// An enumerated volume and where it comes from.
pub(crate) struct Source {
    /// The file.
    pub(crate) path: PathBuf,
    /// What was selected, in words.
    pub(crate) selection: String,
    /// The inside points.
    pub(crate) occupancy: Occupancy,
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

/// Reads a volume file.
pub(crate) fn volume(
    path: &Path,
    args: &VolumeArgs,
    progress: &Progress,
) -> Result<Volume, Failure> {
    progress.stage("reading");
    let report = |done, bytes| progress.read(done, bytes);
    Ok(read_volume(path, &volume_options(args, &report))?)
}

/// Reads a volume file and selects what is inside; nothing inside is a failure.
pub(crate) fn source(
    path: &Path,
    args: &VolumeArgs,
    console: Console,
    progress: &Progress,
) -> Result<Source, Failure> {
    let start = Instant::now();
    let select = select(args);
    // Of several labels some may be missing; to say so, and why nothing is inside, takes all values.
    let several = matches!(&select, Select::Labels(wanted) if wanted.len() > 1);
    let whole = if several { Some(volume(path, args, progress)?) } else { None };
    let (occupancy, frame) = match &whole {
        Some(volume) => (occupancy(path, volume, &select)?, volume.frame.clone()),
        None => {
            progress.stage("reading");
            let report = |done, bytes| progress.read(done, bytes);
            let selected = read_occupancy(path, &volume_options(args, &report), &select)?;
            (selected.occupancy, selected.frame)
        }
    };
    if occupancy.count() == 0 {
        let volume = whole.map_or_else(|| volume(path, args, progress), Ok)?;
        return Err(Failure::Undone(format!("{}: {}", path.display(), nothing(&volume, &select))));
    }
    if let Some(missing) = whole.and_then(|volume| missing_labels(&volume, &select)) {
        console.warn(&format!("{}: {missing}", path.display()));
    }
    let seconds = start.elapsed().as_secs_f64();
    let selection = in_words(&select);
    let (path, truth) = (path.into(), [None; 2]);
    Ok(Source { path, selection, occupancy, frame, truth, seconds })
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

/// The selection as a person would say it.
pub(crate) fn in_words(select: &Select) -> String {
    match select {
        Select::NonZero => "all but 0".into(),
        Select::Above(level) => format!("above {}", number(*level)),
        Select::Labels(labels) => list(labels),
    }
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
            let wanted = list(labels);
            format!("nothing is inside: no voxel has label {wanted}; {present}: change --label")
        }
    }
}

/// Which of the selected labels no voxel has.
fn missing_labels(volume: &Volume, select: &Select) -> Option<String> {
    let Select::Labels(wanted) = select else { return None };
    let present = volume.values.labels()?;
    let has = |label: &i128| present.binary_search_by_key(label, |(label, _)| *label).is_ok();
    let missing: Vec<i128> = wanted.iter().copied().filter(|label| !has(label)).collect();
    let present = labels_in(&present);
    (!missing.is_empty()).then(|| {
        format!("no voxel has label {}; the labels of the file are {present}", list(&missing))
    })
}

fn labels_in(present: &[(i128, u64)]) -> String {
    list(&present.iter().map(|(label, _)| *label).collect::<Vec<_>>())
}

fn list(labels: &[i128]) -> String {
    let shown: Vec<String> = labels.iter().take(LISTED).map(i128::to_string).collect();
    let more = labels.len() - shown.len();
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}
