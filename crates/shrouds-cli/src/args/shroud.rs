//! How a shroud is made.

use clap::Args;
use clap::builder::PossibleValuesParser;
use shrouds::energy::Parameter;
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::optimize::{Preset, Solver, Start, VolumeRule};
use shrouds::volume::{Border, FaceRule};

use crate::args::FrameChoice;
use crate::args::values;

#[derive(Args, Clone)]
#[command(next_help_heading = "Surface")]
pub(crate) struct ShroudArgs {
    /// What the slice curves minimise: measures with weights, see below [default: what the preset is
    /// made for, bending]
    #[arg(long, value_name = "TEXT", value_parser = values::energy)]
    pub(crate) energy: Option<String>,
    /// Keep edges sharp and faces flat, for boxes, letters and machine parts; smooth shapes become
    /// faceted. Vertices where a slice curve turns by much more than this many degrees count next to
    /// nothing; without a number 5.7. For --preset fast and default
    #[arg(long, value_name = "DEGREES", num_args = 0..=1, require_equals = true,
        default_missing_value = "5.7", value_parser = values::crease)]
    pub(crate) crease: Option<f64>,
    #[command(flatten)]
    pub(crate) solve: SolveArgs,
    /// Go on until the optimisation converges, and exit with code 3 when it does not; files are still
    /// written
    #[arg(long)]
    pub(crate) strict: bool,
}

impl ShroudArgs {
    /// Whether the call says how a shroud is to be made; how ambiguous faces are cut and what lies
    /// beyond the volume is asked of other surfaces, too.
    pub(crate) fn is_given(&self) -> bool {
        let solve = &self.solve;
        self.energy.is_some()
            || self.crease.is_some()
            || self.strict
            || solve.parameter.is_some()
            || solve.preset.is_some()
            || solve.tolerance.is_some()
            || solve.max_iterations.is_some()
            || solve.solver != Solver::Newton
            || solve.start != Start::Blur
            || solve.volume != VolumeRule::Free
    }

    /// Whether the call says which mesh is made of a surface.
    pub(crate) fn is_mesh_given(&self) -> bool {
        self.solve.surface != MeshKind::Primal || self.solve.triangles != Triangles::Fitted
    }
}

/// All but the energy.
#[derive(Args, Clone)]
#[command(next_help_heading = "Surface")]
pub(crate) struct SolveArgs {
    /// Parametrisation of the local quadratics, for the measures that have some and are written
    /// without, as in --energy curvature
    #[arg(long, value_parser = PossibleValuesParser::new(Parameter::ALL.map(Parameter::name)))]
    pub(crate) parameter: Option<String>,
    /// How much work newton puts into the minimum [default: default; exact for compare and under
    /// --tolerance or --strict]
    #[arg(long, value_parser = values::choice::<Preset>())]
    pub(crate) preset: Option<Preset>,
    /// How the minimum is sought
    #[arg(long, value_parser = values::choice::<Solver>(), default_value_t = Solver::Newton)]
    pub(crate) solver: Solver,
    /// When to stop, above 0 and below 1. newton: root mean square of the remaining step, in voxels;
    /// not for --preset fast or default [default: 5e-4]; sweeps: relative change in one sweep
    /// [default: 1e-6]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::fraction)]
    pub(crate) tolerance: Option<f64>,
    /// Most steps or sweeps, 0 to leave the start as it is [default: those of the
    /// preset, 100 for exact, 400 with --volume keep; 1000 sweeps]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) max_iterations: Option<u32>,
    /// Where the vertices start: blur (the blurred volume), midpoint (the middle of the grid edges),
    /// inside or outside (one of their ends) or random:SEED
    #[arg(long, default_value_t = Start::Blur)]
    pub(crate) start: Start,
    /// Whether the volume of every connected component is left to the energy
    #[arg(long, value_parser = values::choice::<VolumeRule>(), default_value_t = VolumeRule::Free)]
    pub(crate) volume: VolumeRule,
    /// How ambiguous cell faces are cut
    #[arg(long, value_parser = values::choice::<FaceRule>(), default_value_t = FaceRule::Separate)]
    pub(crate) faces: FaceRule,
    /// What lies beyond the volume
    #[arg(long, value_parser = values::choice::<Border>(), default_value_t = Border::Closed)]
    pub(crate) border: Border,
    /// Which mesh to make
    #[arg(long, value_parser = values::choice::<MeshKind>(), default_value_t = MeshKind::Primal)]
    pub(crate) surface: MeshKind,
    /// How patches are cut into triangles
    #[arg(long, value_parser = values::choice::<Triangles>(), default_value_t = Triangles::Fitted)]
    pub(crate) triangles: Triangles,
}

/// The coordinates of the mesh that is written or checked.
#[derive(Args, Clone, Copy)]
#[command(next_help_heading = "Surface")]
pub(crate) struct FrameArgs {
    /// Coordinates of the mesh
    #[arg(long, value_enum, default_value_t = FrameChoice::World)]
    pub(crate) frame: FrameChoice,
}
