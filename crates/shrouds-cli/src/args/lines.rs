//! The arguments of `shrouds network` and `shrouds contours`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use crate::args::{PlaneAxis, ShroudArgs, VolumeArgs, values};

pub(crate) const NETWORK_HELP: &str = "\
Every line is the curve in which one slice of the volume cuts its shroud, through the vertices of the
primal mesh; .vtp has for each its axis (0, 1, 2), its slice, whether it is closed, length and area.

Example, the network of the liver (label 6), for a viewer:
  shrouds network organs.nii.gz --label 6 -o network.vtp";

pub(crate) const CONTOURS_HELP: &str = "\
Planes across x, y, z lie at positions of the file's frame, in its unit; those across i, j, k at voxel
indices of a volume. A plane through vertices cuts what is just below it. Lines have the inside on their
left, seen from where positions grow: areas of holes are negative.

Examples, a contour every 5 mm, and one in each slice of a volume:
  shrouds contours liver.ply --axis z --every 5 -o contours.vtp
  shrouds contours organs.nii.gz --label 6 --axis k --every 1 -o slices.obj

At two places, with length and area of every contour:
  shrouds contours liver.ply --axis x --at -12.5,30 -o two.vtp --json";

#[derive(Args)]
pub(crate) struct NetworkArgs {
    /// The volume: a file, or a folder for formats that are one
    pub(crate) input: PathBuf,
    /// The lines to write: .vtp or .obj
    #[arg(short, long, value_name = "LINES")]
    pub(crate) output: PathBuf,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}

#[derive(Args)]
#[command(group = ArgGroup::new("where").required(true).args(["every", "at"]))]
pub(crate) struct ContoursArgs {
    /// A mesh file, or a volume file, which is shrouded first
    pub(crate) input: PathBuf,
    /// The lines to write: .vtp, with numbers for each, or .obj
    #[arg(short, long, value_name = "LINES")]
    pub(crate) output: PathBuf,
    /// The axis across the planes
    #[arg(long, value_enum)]
    pub(crate) axis: PlaneAxis,
    /// Distance of the planes: in the unit of the file, or in voxels across i, j, k
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = values::positive)]
    pub(crate) every: Option<f64>,
    /// Position of one of the planes that --every makes
    #[arg(long, value_name = "POSITION", allow_negative_numbers = true, default_value_t = 0.0,
        value_parser = values::finite, conflicts_with = "at")]
    pub(crate) offset: f64,
    /// Positions of the planes, with commas between them
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true,
        value_parser = values::finite)]
    pub(crate) at: Vec<f64>,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}
