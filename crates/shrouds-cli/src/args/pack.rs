//! The arguments of `pack` and `unpack`.

use std::path::PathBuf;

use clap::Args;

use crate::args::shroud::FrameArgs;
use crate::args::{Each, LatticeArgs, Places, Profile, ShroudArgs, VolumeArgs, values};

pub(crate) const PACK_HELP: &str = "\
The file holds the volume, without loss, its frame, and how its surface is to be made: docs/format.md has it
byte by byte. `shrouds unpack` makes the same shroud from it as `shrouds mesh` from the volume.

With --bits the places of the vertices go with it. They may be those of a shroud made with other options, of
the isosurface of grey values, or of a mesh (.ply, .stl, .obj), which is voxelised first.

Example, the liver (label 6) of a segmentation, and all of its labels with their boundaries once:
  shrouds pack organs.nii.gz --label 6 -o liver.shroud
  shrouds pack organs.nii.gz --labels all -o organs.shroud

Grey values with their isosurface to a sixteenth of a voxel, and a mesh to a quarter:
  shrouds pack ct.nii.gz --threshold 300 --bits 4 --places isosurface -o bone.shroud
  shrouds pack statue.ply --size 200 --bits 2 -o statue.shroud";

pub(crate) const UNPACK_HELP: &str = "\
Written are, by the extension, the shroud as .ply, .stl, .obj, .glb, .vtp or .3mf, or the volume as .nii,
.nii.gz, .nrrd, .vti or .npy. Packed labels go to one volume (no .vti), or a mesh of each into a folder, or
into one .ply, .obj, .glb, .vtp or .3mf; --label makes a volume of 0 and 1 of some.

Where the file has bit planes, the mesh is the smoothest that agrees with them, and unless another --preset is
asked for the optimisation goes on until it converges.

Example, a mesh, the volume again, and a mesh of every packed label:
  shrouds unpack liver.shroud -o liver.ply
  shrouds unpack liver.shroud -o liver.nii.gz
  shrouds unpack organs.shroud -o organs";

#[derive(Args)]
#[command(mut_arg("surface", |arg| arg.hide(true)), mut_arg("triangles", |arg| arg.hide(true)))]
pub(crate) struct PackArgs {
    /// The volume, a file, or a folder for formats that are one; or a mesh
    pub(crate) input: PathBuf,
    /// The file to write: .shroud
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// How the volume is coded
    #[arg(long, value_enum, default_value_t = Profile::Dense)]
    pub(crate) profile: Profile,
    /// Bits for the place of every vertex on its grid edge: 0, 1, 2, 4 or 8. With 0 whoever unpacks the
    /// file makes the shroud from the volume alone
    #[arg(long, value_name = "BITS", default_value_t = 0, value_parser = values::bits)]
    pub(crate) bits: u8,
    /// Which surface says where the vertices lie, for --bits 1 to 8 [default: shroud for a volume, mesh
    /// for a mesh]
    #[arg(long, value_enum)]
    pub(crate) places: Option<Places>,
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
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) lattice: LatticeArgs,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}

#[derive(Args)]
#[command(mut_arg("faces", |arg| arg.hide(true)), mut_arg("border", |arg| arg.hide(true)))]
pub(crate) struct UnpackArgs {
    /// The packed file: .shroud
    pub(crate) input: PathBuf,
    /// The mesh or volume file to write; for packed labels also a folder, which is made if need be
    #[arg(short, long, value_name = "MESH|VOLUME")]
    pub(crate) output: PathBuf,
    /// Of packed labels, those that are inside; repeat it for several
    #[arg(long = "label", value_name = "LABEL", allow_negative_numbers = true)]
    pub(crate) labels: Vec<i64>,
    /// Format of the files in a folder
    #[arg(long, value_name = "EXTENSION",
        value_parser = ["ply", "stl", "obj", "glb", "vtp", "3mf"], default_value = "ply")]
    pub(crate) format: String,
    /// Read only so many of the bits that the file has for the places of the vertices [default: all]
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u8).range(..=8))]
    pub(crate) bits: Option<u8>,
    /// Of a damaged file, take what is there of the volume and of the places of the vertices
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
