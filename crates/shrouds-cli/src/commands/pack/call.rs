//! What a call of `pack` asks for, and what does not go together.
use shrouds::volume::Border;

use crate::args::{PackArgs, Places};
use crate::failure::Failure;
use crate::input::{Kind, kind};
use crate::packed::is_packed;

/// What is packed, and which surface says where the vertices lie, if one does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Call {
    Labels,
    Volume(Option<Places>),
    Mesh(Option<Places>),
}

impl Call {
    pub(super) fn check(args: &PackArgs) -> Result<Self, Failure> {
        let refuse = |message: String| Err(Failure::Call(message));
        args.volume.refuse_coordinates()?;
        if !is_packed(&args.output) {
            let message = "packed volumes are written to .shroud";
            return refuse(format!("{}: {message}", args.output.display()));
        }
        let call = match (kind(&args.input)?, args.each) {
            (Kind::Mesh, Some(_)) => {
                return refuse("--labels is for volumes, not for a mesh".into());
            }
            (Kind::Mesh, None) => Self::Mesh(places(args, Places::Mesh)),
            (Kind::Volume, Some(_)) => Self::Labels,
            (Kind::Volume, None) => Self::Volume(places(args, Places::Shroud)),
        };
        match problem(args, call) {
            Some(problem) => refuse(problem.into()),
            None => Ok(call),
        }
    }

    pub(super) fn places(self) -> Option<Places> {
        match self {
            Self::Labels => None,
            Self::Volume(places) | Self::Mesh(places) => places,
        }
    }
}

/// Where the places come from, if there are any.
fn places(args: &PackArgs, usual: Places) -> Option<Places> {
    (args.bits > 0).then(|| args.places.unwrap_or(usual))
}

/// What does not go together in a call, and what to do.
fn problem(args: &PackArgs, call: Call) -> Option<&'static str> {
    let is_mesh = matches!(call, Call::Mesh(_));
    let has_lattice =
        args.lattice.size.is_some() || args.lattice.like.is_some() || args.volume.spacing.is_some();
    Some(match call.places() {
        _ if call == Call::Labels && args.bits > 0 => {
            "--bits is for one surface, and --labels all packs many: choose some with --label, or leave --bits out"
        }
        None if args.places.is_some() => "--places is for --bits 1 to 8: give one of them",
        _ if args.shroud.is_mesh_given() => {
            "--surface and --triangles are not packed: give them to shrouds unpack"
        }
        places if args.shroud.is_given() && places != Some(Places::Shroud) => {
            "options of the shroud, such as --energy and --preset, are for --places shroud with --bits 1 to 8; without, give them to shrouds unpack"
        }
        Some(Places::Mesh) if !is_mesh => "--places mesh is for a mesh: .ply, .stl or .obj",
        Some(Places::Isosurface) if is_mesh => {
            "--places isosurface is for grey values, and a mesh has none: take mesh or shroud"
        }
        Some(Places::Isosurface) if args.volume.threshold.is_none() => {
            "--places isosurface needs the --threshold of the isosurface"
        }
        Some(Places::Mesh) if args.shroud.solve.border == Border::Open => {
            "--places mesh needs --border closed: a mesh does not end at the border of its lattice"
        }
        _ if !is_mesh && args.lattice.is_given() => {
            "--size, --like, --fit, --margin and --winding are for a mesh that is packed"
        }
        _ if is_mesh && !has_lattice => "a mesh needs a lattice: give --size, --spacing or --like",
        _ if is_mesh && args.volume.is_selecting() => {
            "options of a volume, such as --label and --threshold, are not for a mesh"
        }
        _ if is_mesh && has_two_lattices(args) => {
            "--size, --spacing and --like each give a lattice: keep one of them"
        }
        _ => return None,
    })
}

fn has_two_lattices(args: &PackArgs) -> bool {
    let given =
        [args.lattice.size.is_some(), args.lattice.like.is_some(), args.volume.spacing.is_some()];
    given.into_iter().filter(|&is_given| is_given).count() > 1
}
