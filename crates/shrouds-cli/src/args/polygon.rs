//! The arguments of `shrouds polygon`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use crate::args::{ShroudArgs, VolumeArgs};

pub(crate) const POLYGON_HELP: &str = "\
Images are volumes of one slice, or slices of volumes, as for `shrouds mesh`.
The preset is exact unless another one is chosen: an image takes little time.

Example, slice 12 of a segmentation as a picture:
  shrouds polygon organs.nii.gz --label 6 --slice z=12 -o liver.svg";

#[derive(Args)]
pub(crate) struct PolygonArgs {
    /// The image: a volume file, as for `shrouds mesh`
    pub(crate) input: PathBuf,
    /// The file to write: a picture (.svg), lines (.obj, or .vtp with length and area of each), or polygons and report (.json)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Which slice of the volume, such as z=12: the axis across it and its index from 0 [default: the
    /// only one]
    #[arg(long, value_name = "AXIS=N")]
    pub(crate) slice: Option<Slice>,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}

/// A slice of a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Slice {
    /// The axis across it: 0, 1 or 2.
    pub(crate) axis: usize,
    pub(crate) index: usize,
}

impl FromStr for Slice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (axis, index) = text.split_once('=').unwrap_or_default();
        let axis = ["x", "y", "z"].iter().position(|name| *name == axis);
        match (axis, index.parse()) {
            (Some(axis), Ok(index)) => Ok(Self { axis, index }),
            _ => Err("give an axis and an index from 0, such as z=12".into()),
        }
    }
}

impl std::fmt::Display for Slice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", ["x", "y", "z"][self.axis], self.index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_read_or_refused() {
        assert_eq!("y=7".parse(), Ok(Slice { axis: 1, index: 7 }));
        assert_eq!("y=7".parse::<Slice>().unwrap().to_string(), "y=7");
        for text in ["", "z", "z=", "=3", "w=3", "z=-1", "z=1.5", "3"] {
            assert!(text.parse::<Slice>().is_err(), "{text}");
        }
    }
}
