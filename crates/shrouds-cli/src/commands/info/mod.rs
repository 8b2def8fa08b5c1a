//! `shrouds info`: what a volume, mesh or packed file holds.

mod mesh;
mod packed;
mod volume;

use serde::Serialize;
use shrouds_io::read_mesh;

use crate::args::InfoArgs;
use crate::console::{Console, grouped, number, print, print_json};
use crate::failure::Failure;
use crate::input::{self, Kind};
use crate::packed::is_packed;
use crate::progress::Progress;
use crate::report::Lattice;
use mesh::MeshInfo;
use packed::PackedInfo;
use volume::VolumeInfo;

pub(crate) fn run(args: &InfoArgs, console: Console) -> Result<(), Failure> {
    args.volume.refuse_coordinates()?;
    if is_packed(&args.file) {
        let info = PackedInfo::read(&args.file)?;
        return tell(args, &info, PackedInfo::in_words);
    }
    let kind = input::kind(&args.file)?;
    let progress = Progress::new(console.quiet);
    match kind {
        Kind::Volume => {
            // Warnings are part of what is told.
            let quiet = Console { quiet: true };
            let (_, _, contents) = input::contents(&args.file, &args.volume, quiet)?;
            let info = VolumeInfo::new(&args.file, &args.volume, contents, &progress)?;
            drop(progress);
            tell(args, &info, VolumeInfo::in_words)
        }
        Kind::Mesh => {
            progress.stage("reading");
            let mesh = read_mesh(&args.file)?;
            progress.stage("measuring");
            let info = MeshInfo::new(&args.file, &mesh)?;
            drop(progress);
            tell(args, &info, MeshInfo::in_words)
        }
    }
}

fn tell<T: Serialize>(
    args: &InfoArgs,
    info: &T,
    in_words: impl FnOnce(&T) -> String,
) -> Result<(), Failure> {
    if args.json { print_json(info) } else { print(&in_words(info)) }
}

/// How large a lattice is.
fn lattice_in_words(lattice: &Lattice) -> [(&'static str, String); 2] {
    let [nx, ny, nz] = lattice.dims;
    let points = grouped((nx * ny * nz) as u64);
    [
        ("dims", format!("{nx} × {ny} × {nz} = {points}")),
        ("spacing", format!("{} (unit: {})", vector(lattice.spacing), lattice.unit)),
    ]
}

fn vector(v: [f64; 3]) -> String {
    format!("({})", v.map(number).join(", "))
}

fn table(rows: &[(&str, String)]) -> String {
    rows.iter().map(|(key, value)| format!("{key:<13}{value}")).collect::<Vec<_>>().join("\n")
}
