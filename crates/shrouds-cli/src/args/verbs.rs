//! The arguments of each verb.

use std::path::PathBuf;

use clap::Args;
use shrouds::volume::{Border, FaceRule};

use crate::args::shroud::FrameArgs;
use crate::args::{Attribute, Each, Every, Paint, ShroudArgs, SolveArgs, VolumeArgs, values};

/// Where the viewer stands unless told otherwise: seen from there each of the linked tori shows its hole.
pub(crate) const AZIMUTH: f64 = -75.0;
pub(crate) const ELEVATION: f64 = 40.0;

pub(crate) const DEMO_HELP: &str = "\
Phantoms: tori, ball, ellipsoid, box, gyroid, letters (or letters:TEXT), point, rod, plate, noise,
and cells, a ball of twelve labels, the surface of which is that of the ball
Figures of the paper: figure1 to figure11, or figures for all of them and a page about them

Example, a larger gyroid into a folder of its own, its slice curves on the picture:
  shrouds demo gyroid --size 96 --network --output gyroid

The paper's Figure 3, two linked tori before, after one sweep and in the limit:
  shrouds demo figure3 --output figures";

pub(crate) const MESH_HELP: &str = "\
Volumes: .nii, .nii.gz, .nrrd, .nhdr, .seg.nrrd, .mha, .mhd, .dcm, .tif, .npy, .npz, .vti, .raw, and folders
of .tif or of (OME-)Zarr. Meshes: .ply, .stl, .obj, .glb, .vtp, .3mf.

Example, the liver (label 6) of a segmentation, with a picture and the report:
  shrouds mesh organs.nii.gz --label 6 -o liver.ply --picture liver.png --report liver.json

Every label a mesh of its own, in a folder, and all of them in one file for a viewer:
  shrouds mesh organs.nii.gz --labels all -o organs
  shrouds mesh organs.nii.gz --labels all -o organs.glb

The interfaces between all labels, which meet without gaps, and the areas of all contacts; or between some:
  shrouds mesh organs.nii.gz --materials -o organs.vtp --report organs.json
  shrouds mesh organs.nii.gz --materials --label 6 --label 7 -o two.ply

The same as near to the minimum as it gets, or else exit code 3:
  shrouds mesh organs.nii.gz --label 6 -o liver.ply --strict

A volume larger than memory, cube by cube; the same call goes on where one that was broken off stopped:
  shrouds mesh neurons.zarr --label 17 --chunk 256 -o neuron.ply";

pub(crate) const CHECK_HELP: &str = "\
Exit code 0 means certified, 1 that something is wrong.

Example:
  shrouds check liver.ply --volume organs.nii.gz --label 6

The certificate in a file, and later, from that file, the mesh and the volume alone:
  shrouds check liver.ply --volume organs.nii.gz --label 6 --certificate liver.json
  shrouds check liver.json";

pub(crate) const INFO_HELP: &str = "\
Volumes as for `shrouds mesh`. Meshes: .ply, .stl, .obj. Packed: .shroud.

Example:
  shrouds info organs.nii.gz";

pub(crate) const RENDER_HELP: &str = "\
The options of volume and surface are for volumes only.

Example, the slice curves on the shroud of a small volume, from the upper right:
  shrouds render organs.nii.gz --label 6 --network --azimuth 30 --elevation 40 -o liver.png

Mean curvature as colour, with contours every 10 mm, a scale bar and a caption:
  shrouds render organs.nii.gz --label 6 --colour mean-curvature --contours z:10 --scale-bar --caption \
    -o curved.png";

pub(crate) const COMPARE_HELP: &str = "\
INPUT may also be a phantom, demo:NAME (see `shrouds demo --help`). The table has the distance to its
surface where that is known: tori, ball, ellipsoid, box, and gyroid from --size 64 on.

Example, three energies on the liver (label 6), each also from five random starts:
  shrouds compare organs.nii.gz --label 6 --energies 'bending;bending+0.3*variation;linear' \\
    --multistart 5 --picture sheet.png

The usual list, on two small linked tori:
  shrouds compare demo:tori --size 24 --picture sheet.png";

#[derive(Args)]
pub(crate) struct DemoArgs {
    /// Name of the phantom or of a figure of the paper, see below
    #[arg(default_value = "tori")]
    pub(crate) name: String,
    /// For figures: the folder with real data, see `cargo xtask data`; what is missing is made up
    #[arg(long, value_name = "DIR", default_value = "target/data")]
    pub(crate) data: PathBuf,
    /// Voxels along each side of the volume, 1 to 2048 [default: 64; 24 for noise, which is all surface]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=2048))]
    pub(crate) size: Option<u16>,
    /// Folder for mesh.ply, picture.png, report.json and volume.npy; made if need be
    #[arg(short, long, value_name = "DIR", default_value = "shrouds-demo")]
    pub(crate) output: PathBuf,
    /// Draw the slice curves on the picture: across x red, across y white, across z blue; not with
    /// --surface dual
    #[arg(long)]
    pub(crate) network: bool,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
    #[command(flatten)]
    pub(crate) frame: FrameArgs,
}

#[derive(Args)]
pub(crate) struct MeshArgs {
    /// The volume: a file, or a folder for formats that are one; see below
    pub(crate) input: PathBuf,
    /// The mesh file to write: .ply, .stl, .obj, .glb, .vtp or .3mf. With --labels all and --materials also
    /// a folder, which is made if need be
    #[arg(short, long, value_name = "MESH")]
    pub(crate) output: PathBuf,
    /// One mesh for each label but 0: to a folder, a file each, or all to one file, as objects of OBJ,
    /// GLB and 3MF, or told apart by the data `label` of PLY and VTP
    #[arg(long = "labels", value_enum, value_name = "all", group = "several",
        conflicts_with_all = ["labels", "threshold"])]
    pub(crate) each: Option<Each>,
    /// The interfaces between all labels in one mesh, each there once and with both its labels, and the
    /// lines where three or more meet; to a folder, a closed mesh for each label but 0, whose triangles
    /// are those of its neighbours where they touch. With --label only those labels, at least two; the
    /// others count as background
    #[arg(long, group = "several",
        conflicts_with_all = ["each", "threshold", "rough", "certificate", "attributes"])]
    pub(crate) materials: bool,
    /// Format of the files in a folder
    #[arg(long, value_name = "EXTENSION", requires = "several",
        value_parser = ["ply", "stl", "obj", "glb", "vtp", "3mf"], default_value = "ply",
        hide_default_value = false)]
    pub(crate) format: String,
    /// Numbers for every vertex, with commas between them; for .ply, .glb and .vtp
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',')]
    pub(crate) attributes: Vec<Attribute>,
    /// A mask on the same lattice, all but 0: at its voxels the surface need not be smooth
    #[arg(long, value_name = "VOLUME", conflicts_with = "each")]
    pub(crate) rough: Option<PathBuf>,
    /// Work on cubes of so many voxels one after another, for volumes that do not fit into memory: to one
    /// .ply, or to a folder with a .ply of each cube. The surface is the same. The same call continues
    /// one that was broken off
    #[arg(long, value_name = "VOXELS",
        conflicts_with_all = ["each", "attributes", "rough", "picture", "certificate"])]
    pub(crate) chunk: Option<usize>,
    /// Also write the report (JSON)
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Also draw a picture (PNG)
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// Also check the mesh as it was written and write its certificate (JSON), as `shrouds check` does;
    /// for .ply, .stl and .obj
    #[arg(long, value_name = "FILE", conflicts_with = "each")]
    pub(crate) certificate: Option<PathBuf>,
    /// Print the report to standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}

#[derive(Args)]
pub(crate) struct CheckArgs {
    /// The mesh file: .ply, .stl or .obj; of several materials, all labels of which are checked, .ply; or a
    /// certificate, .json, alone, which is verified from the files that it names
    #[arg(value_name = "MESH|CERTIFICATE")]
    pub(crate) mesh: PathBuf,
    /// The volume file it is to be the surface of, as for `shrouds mesh`
    #[arg(long, value_name = "FILE")]
    pub(crate) volume: Option<PathBuf>,
    /// Also write the certificate (JSON), whether or not the mesh is as it should be; it names mesh and
    /// volume relative to itself
    #[arg(long, value_name = "FILE", requires = "volume")]
    pub(crate) certificate: Option<PathBuf>,
    /// How the mesh should pass through ambiguous cell faces, which decides the expected topology
    /// [default: separate]
    #[arg(long, value_parser = values::choice::<FaceRule>())]
    pub(crate) faces: Option<FaceRule>,
    /// Where the mesh may end [default: closed]
    #[arg(long, value_parser = values::choice::<Border>())]
    pub(crate) border: Option<Border>,
    /// Follow the voxel rows along y and z too: finds more on meshes with holes
    #[arg(long)]
    pub(crate) all_axes: bool,
    /// Print the certificate as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) selection: VolumeArgs,
}

#[derive(Args)]
pub(crate) struct InfoArgs {
    /// The volume, mesh or .shroud file
    pub(crate) file: PathBuf,
    /// Print everything as JSON, all labels included
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
}

#[derive(Args)]
pub(crate) struct RenderArgs {
    /// A mesh file, or a volume file, which is shrouded first
    pub(crate) input: PathBuf,
    /// The picture to write: .png
    #[arg(short, long, value_name = "PNG")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    #[command(flatten)]
    pub(crate) figure: FigureArgs,
    /// Draw the slice curves: across x red, across y white, across z blue; for volumes only,
    /// and not with --surface dual
    #[arg(long, help_heading = "Picture")]
    pub(crate) network: bool,
    /// Draw contours across an axis, so far apart: x, y, z in the unit of the file, or i, j, k of a volume
    /// in voxels. With commas for several
    #[arg(long, value_name = "AXIS:DISTANCE", value_delimiter = ',', help_heading = "Picture",
        value_parser = values::every)]
    pub(crate) contours: Vec<Every>,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) shroud: ShroudArgs,
}

#[derive(Args)]
pub(crate) struct CompareArgs {
    /// The volume file, as for `shrouds mesh`; or demo:NAME for a phantom
    pub(crate) input: PathBuf,
    /// The energies, parted by semicolons; `preset` stands for what the preset is made for [default:
    /// that one, those that keep thin parts, variation, and the two of the paper with each
    /// parametrisation]
    #[arg(long, visible_alias = "energy", value_name = "LIST")]
    pub(crate) energies: Option<String>,
    /// Also start from so many random places, 0 to 1000, and tell how far apart the results lie
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true,
        value_parser = clap::value_parser!(u64).range(..=1000))]
    pub(crate) multistart: u64,
    /// Also draw a contact sheet (PNG): every surface from the same side
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// Print the comparison as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Voxels along each side of a phantom, 1 to 2048 [default: 64; 24 for noise]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=2048))]
    pub(crate) size: Option<u16>,
    #[command(flatten)]
    pub(crate) volume: VolumeArgs,
    #[command(flatten)]
    pub(crate) solve: SolveArgs,
}

/// How a picture looks.
#[derive(Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct ViewArgs {
    /// Pixels across, 1 to 32768
    #[arg(long, default_value_t = 1200, value_name = "PIXELS",
        value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub(crate) width: u32,
    /// Pixels down, 1 to 32768
    #[arg(long, default_value_t = 900, value_name = "PIXELS",
        value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub(crate) height: u32,
    /// Direction of the viewer around the z axis in degrees, 0 on +x and 90 on +y
    #[arg(long, default_value_t = AZIMUTH, value_name = "DEGREES", allow_negative_numbers = true,
        value_parser = values::finite)]
    pub(crate) azimuth: f64,
    /// Height of the viewer above the horizon in degrees, -90 to 90
    #[arg(long, default_value_t = ELEVATION, value_name = "DEGREES", allow_negative_numbers = true,
        value_parser = values::elevation)]
    pub(crate) elevation: f64,
    /// Magnification, above 0; 1 fits the picture
    #[arg(long, default_value_t = 1.0, value_name = "FACTOR", value_parser = values::positive)]
    pub(crate) zoom: f64,
    /// Perspective, with a field of view of 40 degrees or of the number given, 1 to 120 [default:
    /// parallel rays]
    #[arg(long, value_name = "DEGREES", num_args = 0..=1, require_equals = true,
        default_missing_value = "40", value_parser = values::field_of_view)]
    pub(crate) perspective: Option<f64>,
    /// Blend the light across triangles instead of showing each one flat
    #[arg(long)]
    pub(crate) smooth: bool,
}

/// What is seen beside the shape.
#[derive(Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct FigureArgs {
    /// Colour of the outer side: six hexadecimal digits; or numbers as colours, with a legend:
    /// mean-curvature, gaussian-curvature, maximum-curvature, minimum-curvature (positive where convex),
    /// or delta (place on the grid edge, 1 at its inside end; for volumes only, and not with
    /// --surface dual)
    #[arg(long, default_value = "DEB880", value_name = "RRGGBB|NUMBERS", value_parser = values::paint)]
    pub(crate) colour: Paint,
    /// The numbers with the first and the last colour [default: delta 0,1; curvatures as far to both sides
    /// as 95 of 100 vertices go]
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true, value_parser = values::range)]
    pub(crate) range: Option<[f64; 2]>,
    /// A scale bar below the picture; not with --perspective
    #[arg(long, conflicts_with = "perspective")]
    pub(crate) scale_bar: bool,
    /// A caption below the picture: name, number of triangles, and fairness, the bending energy of contours
    /// as a multiple of that of a sphere
    #[arg(long)]
    pub(crate) caption: bool,
}
