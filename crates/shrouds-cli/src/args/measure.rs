//! The arguments of `shrouds measure`.

use std::path::PathBuf;

use clap::Args;

use crate::args::{Each, ShroudArgs, VolumeArgs};

pub(crate) const MEASURE_HELP: &str = "\
Every column names its unit, that of the file: mm, mm², 1/mm. Positions and directions are in the world
coordinates of the file, which the first line names. Beside volume and area stand the span they could have
over all separating surfaces and a calibrated error. docs/measurements.md says what each number means.
The preset is exact unless another is given, and default for contacts.

Examples, the liver (label 6), and all labels of an atlas with the areas in which they touch:
  shrouds measure organs.nii.gz --label 6
  shrouds measure atlas.nii.gz --labels all --contacts --csv atlas.csv

A mesh of any origin, and how far it is from the shroud of a volume:
  shrouds measure other.ply
  shrouds measure organs.nii.gz --label 6 --distance-to other.ply --json";

#[derive(Args)]
pub(crate) struct MeasureArgs {
    /// A volume file, which is shrouded first, or a mesh file: .ply, .stl or .obj; of several materials, label
    /// by label, .ply
    pub(crate) input: PathBuf,
    /// One row for each label but 0
    #[arg(long = "labels", value_enum, value_name = "all", conflicts_with_all = ["labels", "threshold"])]
    pub(crate) each: Option<Each>,
    /// One row for each connected component: of the voxels, joined as the surface joins them, or of a mesh
    #[arg(long)]
    pub(crate) components: bool,
    /// Also the distance to another surface: a mesh, or a volume from which the same is selected
    #[arg(long, value_name = "OTHER", conflicts_with = "components")]
    pub(crate) distance_to: Option<PathBuf>,
    /// Also the areas in which the labels touch each other and the outside
    #[arg(long, requires = "each")]
    pub(crate) contacts: bool,
    /// Also write all columns as a table with commas; contacts go to a second one, NAME-contacts.csv
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Print everything as JSON to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}
