//! The arguments of `pack` and `unpack`.

use std::path::PathBuf;

use clap::Args;

use crate::args::shroud::FrameArgs;
use crate::args::{Border, Each, Faces, Profile, ShroudArgs, VolumeArgs};

pub(crate) const PACK_HELP: &str = "\
The file holds the volume, without loss, its frame, and how its surface is to be made: docs/format.md has it
byte by byte. `shrouds unpack` makes the same shroud from it as `shrouds mesh` from the volume.

Example, the liver (label 6) of a segmentation, and all of its labels with their boundaries once:
  shrouds pack organs.nii.gz --label 6 -o liver.shroud
  shrouds pack organs.nii.gz --labels all -o organs.shroud";

pub(crate) const UNPACK_HELP: &str = "\
Written are, by the extension, the shroud as .ply, .stl, .obj, .glb, .vtp or .3mf, or the volume as .nii,
.nii.gz, .nrrd, .vti or .npy. Packed labels are written whole to .npy; to others with --label.

Example, a mesh, and the volume again:
  shrouds unpack liver.shroud -o liver.ply
  shrouds unpack liver.shroud -o liver.nii.gz";

#[derive(Args)]
pub(crate) struct PackArgs {
    /// The volume: a file, or a folder for formats that are one
    pub(crate) input: PathBuf,
    /// The file to write: .shroud
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// How the volume is coded
    #[arg(long, value_enum, default_value_t = Profile::Dense)]
    pub(crate) profile: Profile,
    /// Pack all labels as they are, instead of what is inside
    #[arg(long = "labels", value_enum, value_name = "all", conflicts_with_all = ["labels", "threshold"])]
    pub(crate) each: Option<Each>,
    /// Layers that are packed together; a damaged file is good up to the slab with the damage [default:
    /// as many as have 2^24 voxels]
    #[arg(long, value_name = "LAYERS", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) slab: Option<u32>,
    /// Code every slab by itself: some larger, but on all threads
    #[arg(long, requires = "slab")]
    pub(crate) independent: bool,
    /// How ambiguous cell faces are to be cut
    #[arg(long, value_enum, default_value_t = Faces::Separate)]
    pub(crate) faces: Faces,
    /// What lies beyond the volume
    #[arg(long, value_enum, default_value_t = Border::Closed)]
    pub(crate) border: Border,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
}

#[derive(Args)]
#[command(mut_arg("faces", |arg| arg.hide(true)), mut_arg("border", |arg| arg.hide(true)))]
pub(crate) struct UnpackArgs {
    /// The packed file: .shroud
    pub(crate) input: PathBuf,
    /// The mesh or volume file to write
    #[arg(short, long, value_name = "MESH|VOLUME")]
    pub(crate) output: PathBuf,
    /// Of packed labels, those that are inside; repeat it for several
    #[arg(long = "label", value_name = "LABEL", allow_negative_numbers = true)]
    pub(crate) labels: Vec<i64>,
    /// Of a damaged file, take what is there of the volume
    #[arg(long)]
    pub(crate) partial: bool,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
    #[command(flatten)]
    pub(crate) frame: FrameArgs,
}
