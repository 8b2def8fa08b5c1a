//! The arguments of `shrouds contain`.

use std::path::PathBuf;

use clap::Args;

use crate::args::{ShroudArgs, ViewArgs, values};

pub(crate) const CONTAIN_HELP: &str = "\
What a scene holds stands in docs/containment.md; examples/scenes/ has some. Exit code 1 means, too, that a
contact contradicts those before it; the steps before it are written all the same.

Example, every second contact into a folder, with surfaces that are proved to contain the target:
  shrouds contain examples/scenes/figure11.toml --every 2 --one-sided -o regions";

#[derive(Args)]
pub(crate) struct ContainArgs {
    /// The scene: sea, platform, contacts, target
    pub(crate) scene: PathBuf,
    /// Folder for region-N.nii.gz, .ply and .png of every contact and for report.json; made if need be
    #[arg(short, long, value_name = "DIR", default_value = "shrouds-contain")]
    pub(crate) output: PathBuf,
    /// Write files for every Nth contact only, and for the last one
    #[arg(long, value_name = "N", default_value_t = 1, hide_default_value = true,
        value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) every: u32,
    /// Take in each voxel in whose cell the target can be, and make the surface one that is proved to
    /// contain these cells
    #[arg(long)]
    pub(crate) one_sided: bool,
    /// Format of the volumes
    #[arg(long, value_name = "EXTENSION", value_parser = ["nii.gz", "nii", "nrrd", "npy", "vti"],
        default_value = "nii.gz")]
    pub(crate) format: String,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    /// Colour of the region: six hexadecimal digits
    #[arg(long, default_value = "DEB880", value_name = "RRGGBB", help_heading = "Picture",
        value_parser = values::colour)]
    pub(crate) colour: [u8; 3],
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}
