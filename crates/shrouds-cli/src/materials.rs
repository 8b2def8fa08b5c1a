//! The labels of a volume file.

use std::path::Path;

use shrouds::Grid;
use shrouds::materials::Labels;

use crate::args::VolumeArgs;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;

/// The labels of a volume file, with their places on this lattice.
pub(crate) fn labels(
    path: &Path,
    args: &VolumeArgs,
    lattice: &Grid,
    progress: &Progress,
) -> Result<Labels, Failure> {
    let volume = input::volume(path, args, args.layer(), progress)?;
    let problem = |text: String| Failure::Undone(format!("{}: {text}", path.display()));
    let values = volume.values.whole().ok_or_else(|| {
        problem("the values are no labels; --materials wants whole numbers".into())
    })?;
    let labels = Labels::new(lattice, &values).map_err(|error| problem(error.to_string()))?;
    match labels.values() {
        [_] => Err(problem("all values are 0; check that this is the segmentation".into())),
        _ => Ok(labels),
    }
}
