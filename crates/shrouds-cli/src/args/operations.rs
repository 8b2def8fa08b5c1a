//! The arguments of the verbs that make volumes out of volumes.

use std::ops::Range;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{ArgGroup, Args};
use shrouds::volume::{Border, FaceRule};

use crate::args::{Interpolation, Operation, VolumeArgs, Winding, values};

pub(crate) const COMBINE_HELP: &str = "\
Both volumes must have the same lattice; `shrouds resample B --like A` brings one onto that of the other.
The result has 1 inside and 0 outside, in the frame of A.

Example, the liver without its tumour, two labels of one file:
  shrouds combine subtract organs.nii.gz organs.nii.gz --label liver --label-b tumour -o healthy.nii.gz";

pub(crate) const OFFSET_HELP: &str = "\
Distances are exact Euclidean ones between voxel centres in the unit of the file, whatever the spacing.

Example, a margin of 5 mm around the tumour (label 2), and its shroud:
  shrouds offset organs.nii.gz --label 2 --by 5 -o margin.nii.gz
  shrouds mesh margin.nii.gz -o margin.ply";

pub(crate) const CROP_HELP: &str = "\
Voxels keep their places in the world.

Example, what is around the liver, three voxels more on every side:
  shrouds crop organs.nii.gz --label 6 --margin 3 -o liver.nii.gz";

pub(crate) const RESAMPLE_HELP: &str = "\
Example, to voxels of half a millimetre:
  shrouds resample liver.nii.gz --to 0.5 -o fine.nii.gz";

pub(crate) const CLEAN_HELP: &str = "\
What is asked for is done in the order of the options below.

Example, one solid part:
  shrouds clean liver.nii.gz --keep-largest --fill-cavities -o solid.nii.gz";

pub(crate) const VOXELIZE_HELP: &str = "\
Voxels whose centre lies inside the mesh are inside, exactly. A mesh with holes, or whose parts overlap or
face opposite sides, is judged by its winding number, with a warning.

Example, a scan as a volume of at most 256 voxels a side, and on the lattice of another volume:
  shrouds voxelize bunny.ply --size 256 -o bunny.nrrd
  shrouds voxelize implant.stl --like head.nii.gz -o implant.nii.gz

The rabbit of the letters, filling their lattice:
  shrouds voxelize bunny.ply --like letters.npy --fit -o rabbit.npy
  shrouds combine intersect rabbit.npy letters.npy -o both.npy";

/// A volume in, a volume out.
#[derive(Args)]
pub(crate) struct EditArgs {
    /// The volume: a file, or a folder for formats that are one
    pub(crate) input: PathBuf,
    /// The volume file to write: 1 inside, 0 outside
    #[arg(short, long, value_name = "VOLUME")]
    pub(crate) output: PathBuf,
    /// Print what was done as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
}

#[derive(Args)]
pub(crate) struct CombineArgs {
    /// What to make of the two
    pub(crate) operation: Operation,
    /// The first volume
    pub(crate) a: PathBuf,
    /// The second volume
    pub(crate) b: PathBuf,
    /// The volume file to write: 1 inside, 0 outside
    #[arg(short, long, value_name = "VOLUME")]
    pub(crate) output: PathBuf,
    /// Label of B, a number or a name; repeat it for several [default: as for A]
    #[arg(long = "label-b", value_name = "LABEL", allow_negative_numbers = true)]
    pub(crate) labels_b: Vec<String>,
    /// Print what was done as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
}

#[derive(Args)]
pub(crate) struct OffsetArgs {
    #[command(flatten)]
    pub(crate) edit: EditArgs,
    /// Distance in the unit of the file: above 0 grows, below 0 shrinks
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true,
        value_parser = values::finite)]
    pub(crate) by: f64,
    /// Keep the lattice; what grows ends at its border [default: the lattice grows as needed]
    #[arg(long)]
    pub(crate) keep_lattice: bool,
    /// What lies beyond the volume: with closed it shrinks away from the border too
    #[arg(long, value_parser = values::choice::<Border>(), default_value_t = Border::Closed)]
    pub(crate) border: Border,
}

#[derive(Args)]
pub(crate) struct CropArgs {
    #[command(flatten)]
    pub(crate) edit: EditArgs,
    /// First voxel and the one after the last along x, y, z, from 0 [default: what holds all that is
    /// inside]
    #[arg(long = "box", value_name = "X0:X1,Y0:Y1,Z0:Z1")]
    pub(crate) window: Option<Window>,
    /// Voxels more on every side, as far as the lattice goes [default: 1 without --box, else 0]
    #[arg(long, value_name = "N")]
    pub(crate) margin: Option<u32>,
}

#[derive(Args)]
#[command(group = ArgGroup::new("target").required(true).args(["to", "like"]))]
pub(crate) struct ResampleArgs {
    #[command(flatten)]
    pub(crate) edit: EditArgs,
    /// New distance of the voxels, one for all axes or along x, y, z, in the unit of the file; the
    /// lattice covers what it did
    #[arg(long, value_name = "S|SX,SY,SZ", value_parser = values::lengths)]
    pub(crate) to: Option<[f64; 3]>,
    /// Take the lattice of this volume
    #[arg(long, value_name = "VOLUME")]
    pub(crate) like: Option<PathBuf>,
    /// How the side of a point between voxels is found
    #[arg(long, value_enum, default_value_t = Interpolation::Linear)]
    pub(crate) interpolation: Interpolation,
}

#[derive(Args)]
#[command(group = ArgGroup::new("what").required(true).multiple(true)
    .args(["drop_below", "keep_largest", "fill_cavities"]))]
pub(crate) struct CleanArgs {
    #[command(flatten)]
    pub(crate) edit: EditArgs,
    /// Remove the connected components of fewer voxels
    #[arg(long, value_name = "VOXELS")]
    pub(crate) drop_below: Option<u64>,
    /// Keep only so many connected components, the largest [without a number: 1]
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true,
        default_missing_value = "1", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) keep_largest: Option<u32>,
    /// Fill the cavities that do not reach the border, with a number only those of at most so many
    /// voxels
    #[arg(long, value_name = "VOXELS", num_args = 0..=1, require_equals = true,
        default_missing_value = "18446744073709551615", hide_default_value = true)]
    pub(crate) fill_cavities: Option<u64>,
    /// What connects voxels, as in the surface
    #[arg(long, value_parser = values::choice::<FaceRule>(), default_value_t = FaceRule::Separate)]
    pub(crate) faces: FaceRule,
}

#[derive(Args)]
#[command(group = ArgGroup::new("lattice").required(true).args(["size", "spacing", "like"]))]
pub(crate) struct VoxelizeArgs {
    /// The mesh: .ply, .stl or .obj
    pub(crate) mesh: PathBuf,
    /// The volume file to write: 1 inside, 0 outside
    #[arg(short, long, value_name = "VOLUME")]
    pub(crate) output: PathBuf,
    /// Distance of the voxels, one for all axes or along x, y, z, in the unit of the mesh
    #[arg(long, value_name = "H|HX,HY,HZ", value_parser = values::lengths)]
    pub(crate) spacing: Option<[f64; 3]>,
    #[command(flatten)]
    pub(crate) lattice: LatticeArgs,
    /// Print what was done as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// The lattice on which a mesh is voxelised, and what is inside of it.
#[derive(Args)]
#[command(next_help_heading = "Lattice of a mesh")]
pub(crate) struct LatticeArgs {
    /// So many voxels along the longest side, margins included
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) size: Option<u32>,
    /// Take the lattice of this volume
    #[arg(long, value_name = "VOLUME")]
    pub(crate) like: Option<PathBuf>,
    /// Scale and move the mesh so that it fills the lattice of --like
    #[arg(long, requires = "like")]
    pub(crate) fit: bool,
    /// Voxels more on every side than the mesh needs; with --like only for --fit
    #[arg(long, value_name = "N", default_value_t = Self::MARGIN)]
    pub(crate) margin: u32,
    /// Which winding numbers are inside
    #[arg(long, value_enum, default_value_t = Winding::NonZero)]
    pub(crate) winding: Winding,
}

impl LatticeArgs {
    /// The margin without another.
    const MARGIN: u32 = 1;

    /// Whether the call says anything about a mesh to voxelise.
    pub(crate) fn is_given(&self) -> bool {
        self.size.is_some()
            || self.like.is_some()
            || self.margin != Self::MARGIN
            || self.winding != Winding::NonZero
    }
}

/// Ranges of voxel indices along x, y, z.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Window(pub(crate) [Range<usize>; 3]);

impl FromStr for Window {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range = |part: &str| {
            let (start, end) = part.split_once(':')?;
            let (start, end) = (start.trim().parse().ok()?, end.trim().parse().ok()?);
            (start < end).then_some(start..end)
        };
        let ranges: Option<Vec<Range<usize>>> = text.split(',').map(range).collect();
        let ranges = ranges.and_then(|ranges| ranges.try_into().ok());
        ranges.map(Self).ok_or_else(|| {
            "give three ranges of indices, the end not included, such as 0:40,10:50,0:20".into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_read_or_refused() {
        assert_eq!("0:4, 2:5,7:8".parse(), Ok(Window([0..4, 2..5, 7..8])));
        for text in ["", "0:4,2:5", "0:4,2:5,7:7", "4:0,2:5,7:8", "-1:3,0:1,0:1", "0:1,0:1,0:1,0:1"]
        {
            assert!(text.parse::<Window>().is_err(), "{text}");
        }
    }
}
