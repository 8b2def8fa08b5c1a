//! Phantoms as sources of volumes.

use std::path::PathBuf;
use std::time::Instant;

use shrouds::volume::phantom::{Phantom, named};
use shrouds_io::Frame;

use crate::failure::Failure;
use crate::input::Source;

/// Voxels along each side of a phantom unless told otherwise: noise is all surface.
pub(crate) fn size(name: &str, wanted: Option<u16>) -> usize {
    let usual = if name == "noise" { 24 } else { 64 };
    wanted.map_or(usual, usize::from)
}

/// The phantom of a name as if it were read from a file; nothing inside is a failure.
pub(crate) fn source(
    name: &str,
    size: usize,
    path: PathBuf,
    start: Instant,
) -> Result<Source, Failure> {
    labelled(name, size, path, start).map(|(source, _)| source)
}

/// The same with the labels of its lattice points, x fastest, where it has several.
pub(crate) fn labelled(
    name: &str,
    size: usize,
    path: PathBuf,
    start: Instant,
) -> Result<(Source, Option<Vec<u8>>), Failure> {
    let Phantom { name, volume, labels, true_volume, true_area } = named(name, size)?;
    if volume.count() == 0 {
        return Err(Failure::Undone(format!(
            "the phantom {name} has no voxel inside at this size; raise --size"
        )));
    }
    let source = Source {
        path,
        selection: "all but 0".into(),
        lattice: volume.grid().clone(),
        occupancy: volume,
        frame: Frame { name: "index".into(), unit: "unknown".into(), source: "phantom" },
        truth: [true_volume, true_area],
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok((source, labels))
}
