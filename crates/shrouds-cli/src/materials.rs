//! The labels of a volume file.

use std::collections::BTreeSet;
use std::path::Path;

use shrouds::materials::Labels;
use shrouds::{Grid, Select};
use shrouds_io::{Contents, Volume};

use crate::args::VolumeArgs;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;
use crate::selection::{Selection, list};

/// The labels of a volume file, those that are chosen or all, with their places on this lattice.
pub(crate) fn labels(
    path: &Path,
    args: &VolumeArgs,
    lattice: &Grid,
    progress: &Progress,
) -> Result<Labels, Failure> {
    let volume = input::volume(path, args, args.layer(), progress)?;
    labels_of(&volume, path, args, lattice)
}

/// The labels of a volume that was read, those that are chosen or all; the others count as background.
pub(crate) fn labels_of(
    volume: &Volume,
    path: &Path,
    args: &VolumeArgs,
    lattice: &Grid,
) -> Result<Labels, Failure> {
    let problem = |text: String| Failure::Undone(format!("{}: {text}", path.display()));
    let mut values = volume.values.whole().ok_or_else(|| {
        problem("the values are no labels; --materials wants whole numbers".into())
    })?;
    let chosen = chosen(path, args, &volume.contents)?;
    if let Some(chosen) = &chosen {
        keep(&mut values, chosen);
    }
    let labels = Labels::new(lattice, &values).map_err(|error| problem(error.to_string()))?;
    match (labels.values(), chosen) {
        ([_], None) => Err(problem("all values are 0; check that this is the segmentation".into())),
        ([_], Some(chosen)) => {
            let wanted = list(chosen.iter().map(i64::to_string));
            Err(problem(format!("no voxel has label {wanted}; choose labels that are there")))
        }
        ([_, one], Some(_)) => {
            Err(problem(format!("of the labels chosen only {one} has voxels; choose another, too")))
        }
        _ => Ok(labels),
    }
}

/// The labels that are asked for; nothing for all of them.
fn chosen(
    path: &Path,
    args: &VolumeArgs,
    contents: &Contents,
) -> Result<Option<BTreeSet<i64>>, Failure> {
    if args.labels.is_empty() {
        return Ok(None);
    }
    let call = |text: &str| Failure::Call(format!("{}: {text}", path.display()));
    let Selection { parts, .. } = Selection::new(path, args, contents)?;
    let [(_, Select::Labels(labels))] = &parts[..] else {
        return Err(call(
            "the labels chosen lie in several layers; --materials takes those of one",
        ));
    };
    let labels = labels.iter().copied().filter_map(|label| i64::try_from(label).ok());
    let labels: BTreeSet<i64> = labels.filter(|label| *label != 0).collect();
    match labels.len() {
        0 | 1 => Err(call("--materials wants no --label, for all, or at least two besides 0")),
        _ => Ok(Some(labels)),
    }
}

/// Turns all labels but these into background.
fn keep(values: &mut [i64], chosen: &BTreeSet<i64>) {
    let mut last = (0, false);
    for value in values {
        if *value != last.0 {
            last = (*value, chosen.contains(value));
        }
        if !last.1 {
            *value = 0;
        }
    }
}
