//! What can be typed on the command line. These types stay here: [`crate::settings`] turns them into
//! those of the libraries.

mod contain;
mod lines;
mod measure;
mod names;
mod operations;
mod pack;
mod polygon;
mod shroud;
mod values;
mod verbs;
mod view;
mod volume;

use clap::{Args, Parser, Subcommand};

use crate::energies;

pub(crate) use contain::ContainArgs;
pub(crate) use lines::{ContoursArgs, NetworkArgs};
pub(crate) use measure::MeasureArgs;
pub(crate) use names::{
    Attribute, Axes, Each, Field, FrameChoice, Interpolation, Operation, Places, PlaneAxis,
    Profile, Winding,
};
pub(crate) use operations::{
    CleanArgs, CombineArgs, CropArgs, EditArgs, LatticeArgs, OffsetArgs, ResampleArgs,
    VoxelizeArgs, Window,
};
pub(crate) use pack::{PackArgs, UnpackArgs};
pub(crate) use polygon::{PolygonArgs, Slice};
pub(crate) use shroud::{ShroudArgs, SolveArgs};
pub(crate) use values::{Every, Paint};
pub(crate) use verbs::{
    AZIMUTH, CheckArgs, CompareArgs, DemoArgs, ELEVATION, InfoArgs, MeshArgs, RenderArgs, ViewArgs,
};
pub(crate) use view::TestBedArgs;
pub(crate) use volume::{Reading, VolumeArgs};

/// Smooth triangle surfaces that provably keep every voxel of a segmentation on its own side.
///
/// Results go to files and to standard output, messages to standard error. Exit codes: 0 done,
/// 1 could not be done, 2 the call is wrong, 3 not converged under --strict.
#[derive(Parser)]
#[command(name = "shrouds", version, max_term_width = 100, disable_help_subcommand = true)]
#[command(after_help = "Begin with:\n  shrouds demo\n  shrouds mesh --help")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) verb: Verb,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// What every verb understands.
#[derive(Args, Clone, Copy)]
#[command(next_help_heading = "Everywhere")]
pub(crate) struct Common {
    /// Number of threads, 1 to 1024 [default: as many as the machine has]. Results are the same, bit
    /// by bit, for any number
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true,
        value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// No progress, warnings or summaries: only errors, and what --json prints
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Subcommand)]
pub(crate) enum Verb {
    /// Build a phantom and shroud it: needs no input
    #[command(after_help = with_energies(verbs::DEMO_HELP))]
    Demo(DemoArgs),
    /// Turn a segmented volume into its shroud, a smooth triangle mesh
    #[command(after_help = with_energies(verbs::MESH_HELP))]
    Mesh(MeshArgs),
    /// Certify a mesh, of any origin, against its volume
    #[command(after_help = verbs::CHECK_HELP)]
    Check(CheckArgs),
    /// Tell what a volume or mesh file holds
    #[command(after_help = verbs::INFO_HELP)]
    Info(InfoArgs),
    /// Draw a mesh, or the shroud of a volume, into a PNG file
    #[command(after_help = with_energies(verbs::RENDER_HELP))]
    Render(RenderArgs),
    /// Shroud a volume with one energy after the other: a table and a contact sheet to choose by
    #[command(after_help = with_energies(verbs::COMPARE_HELP))]
    Compare(CompareArgs),
    /// Measure a mesh, or the shroud of a volume: size, shape, curvature, thickness, contact, distance
    #[command(after_help = with_energies(measure::MEASURE_HELP))]
    Measure(MeasureArgs),
    /// The slice curves of a volume's shroud, as lines
    #[command(after_help = with_energies(lines::NETWORK_HELP))]
    Network(NetworkArgs),
    /// Cut a mesh, or the shroud of a volume, by planes: contours as lines, with lengths and areas
    #[command(after_help = with_energies(lines::CONTOURS_HELP))]
    Contours(ContoursArgs),
    /// Separate an image, or a slice of a volume: the same in two dimensions
    #[command(after_help = with_energies(polygon::POLYGON_HELP))]
    Polygon(PolygonArgs),
    /// Boolean operations: union, intersect, subtract, xor
    #[command(after_help = operations::COMBINE_HELP)]
    Combine(CombineArgs),
    /// Grow or shrink a volume by a distance
    #[command(after_help = operations::OFFSET_HELP)]
    Offset(OffsetArgs),
    /// Cut a box out of a volume
    #[command(after_help = operations::CROP_HELP)]
    Crop(CropArgs),
    /// Bring a volume onto another lattice
    #[command(after_help = operations::RESAMPLE_HELP)]
    Resample(ResampleArgs),
    /// Remove small parts, fill cavities
    #[command(after_help = operations::CLEAN_HELP)]
    Clean(CleanArgs),
    /// Turn a triangle mesh into a volume
    #[command(after_help = operations::VOXELIZE_HELP)]
    Voxelize(VoxelizeArgs),
    /// Pack a volume, or all its labels, into a few kilobytes
    #[command(after_help = pack::PACK_HELP)]
    Pack(PackArgs),
    /// Turn a packed volume back into a mesh or a volume
    #[command(after_help = pack::UNPACK_HELP)]
    Unpack(UnpackArgs),
    /// Where a target can be, from what a towed array has heard of it, contact by contact
    #[command(after_help = with_energies(contain::CONTAIN_HELP))]
    Contain(ContainArgs),
    /// Open the test bed: choose, watch and measure in the browser
    #[command(after_help = view::VIEW_HELP)]
    View(TestBedArgs),
}

/// The end of a help text, and the energies there are.
fn with_energies(text: &str) -> String {
    format!("{text}\n\n{}", energies::list())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_definitions_hold_together() {
        super::Cli::command().debug_assert();
    }
}
