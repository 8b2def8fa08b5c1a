//! How a volume file is read, and which of its voxels are inside.

use clap::Args;

use crate::args::{Axes, values};

#[derive(Args)]
#[command(next_help_heading = "Volume")]
pub(crate) struct VolumeArgs {
    /// Inside are the voxels with this label; repeat it for several [default: all but 0]
    #[arg(long = "label", value_name = "N", allow_negative_numbers = true)]
    pub(crate) labels: Vec<i128>,
    /// Inside are the voxels with a value above this [default: all but 0]
    #[arg(long, value_name = "T", conflicts_with = "labels", allow_negative_numbers = true,
        value_parser = values::finite)]
    pub(crate) threshold: Option<f64>,
    /// Order of the axes of an NPY array; other formats name their axes
    #[arg(long, value_enum, default_value_t = Axes::Zyx)]
    pub(crate) axes: Axes,
    /// Distance of the voxels along x, y, z in the unit of the file; replaces the whole frame of the
    /// file, origin and directions too [default: what the file says; 1,1,1 for NPY]
    #[arg(long, value_name = "SX,SY,SZ", value_parser = values::spacing)]
    pub(crate) spacing: Option<[f64; 3]>,
}
