//! A packed volume as one that other programs read.

use serde::Serialize;
use shrouds::Grid;
use shrouds_codec::Header;
use shrouds_io::write_volume;

use super::Volume;
use crate::args::UnpackArgs;
use crate::console::{Console, grouped, plural, print_json};
use crate::failure::Failure;
use crate::packed::frame;
use crate::progress::Progress;
use crate::report::{Lattice, name};

/// What came out.
#[derive(Serialize)]
pub(super) struct Report {
    input: String,
    output: String,
    #[serde(flatten)]
    lattice: Lattice,
    /// Voxels inside; null for labels.
    pub(super) inside: Option<u64>,
    /// Labels; null for a volume.
    pub(super) labels: Option<Vec<i64>>,
    /// What the file should hold and does not.
    lost: Option<String>,
}

pub(super) fn run(
    args: &UnpackArgs,
    volume: Volume,
    console: Console,
    progress: Progress,
) -> Result<(), Failure> {
    if let Some(lost) = &volume.lost {
        console.warn(&format!("{}: {lost}", args.input.display()));
    }
    progress.stage("writing");
    write_volume(&args.output, &volume.occupancy, &frame(&volume.header))?;
    drop(progress);
    let mut report = Report::new(args, &volume.header, volume.occupancy.grid());
    (report.inside, report.lost) = (Some(volume.occupancy.count()), volume.lost);
    report.tell(args, console)
}

impl Report {
    /// On the lattice that is there, which may be less than that of the header.
    pub(super) fn new(args: &UnpackArgs, header: &Header, grid: &Grid) -> Self {
        Self {
            input: name(&args.input),
            output: name(&args.output),
            lattice: Lattice::new(grid, &header.space, &header.unit),
            inside: None,
            labels: None,
            lost: None,
        }
    }

    pub(super) fn tell(&self, args: &UnpackArgs, console: Console) -> Result<(), Failure> {
        if args.json {
            return print_json(self);
        }
        let [nx, ny, nz] = self.lattice.dims;
        let what = match (&self.labels, self.inside) {
            (Some(labels), _) => plural(labels.len(), "label"),
            (None, inside) => format!("{} inside", grouped(inside.unwrap_or(0))),
        };
        console.message(&format!("{}: {nx} × {ny} × {nz} voxels, {what}", args.output.display()));
        Ok(())
    }
}
