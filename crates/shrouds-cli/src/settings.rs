//! From what was typed to settings that the library takes, or a message that says what is wrong.

use serde::Serialize;
use shrouds::energy::{self, Bending, Curvature, Linear};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::volume::{self, FaceRule};
use shrouds::{Select, Settings, optimize};
use shrouds_io::{Progress, VolumeOptions};

use crate::args::{
    Axes, Border, Energy, Faces, FrameChoice, Parameter, Preset, ShroudArgs, Solver, Start,
    SurfaceKind, TriangleRule, VolumeArgs,
};
use crate::failure::Failure;

/// The settings of a shroud as the report has them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SettingsReport {
    energy: Energy,
    parameter: Option<Parameter>,
    solver: Solver,
    /// Null for the sweeps.
    pub(crate) preset: Option<Preset>,
    /// Null for a preset that does not converge.
    tolerance: Option<f64>,
    max_iterations: usize,
    start: Start,
    margin: f64,
    faces: Faces,
    border: Border,
    surface: SurfaceKind,
    triangles: TriangleRule,
    frame: FrameChoice,
}

/// Checked settings of a shroud.
pub(crate) struct Job {
    /// For the library.
    pub(crate) settings: Settings,
    /// For the report.
    pub(crate) report: SettingsReport,
    /// Coordinates of the mesh.
    pub(crate) frame: FrameChoice,
    /// Whether not to converge is a failure.
    pub(crate) strict: bool,
}

impl Job {
    pub(crate) fn new(args: &ShroudArgs, frame: FrameChoice) -> Result<Self, Failure> {
        if args.surface == SurfaceKind::Dual && args.border == Border::Open {
            let message = "--surface dual needs --border closed; leave one of them out";
            return Err(Failure::Call(message.into()));
        }
        let (energy, parameter) = energy(args)?;
        let preset = preset(args)?;
        let settings = Settings {
            faces: face_rule(args.faces),
            border: border(args.border),
            optimize: optimize_settings(args, energy, preset),
            mesh: match args.surface {
                SurfaceKind::Primal => MeshKind::Primal,
                SurfaceKind::Dual => MeshKind::Dual,
            },
            triangles: match args.triangles {
                TriangleRule::Fitted => Triangles::Fitted,
                TriangleRule::Fixed => Triangles::Fixed,
            },
        };
        let report = SettingsReport {
            energy: args.energy,
            parameter,
            solver: args.solver,
            preset,
            tolerance: settings.optimize.converges().then(|| settings.optimize.tolerance()),
            max_iterations: settings.optimize.max_iterations(),
            start: args.start,
            margin: settings.optimize.margin,
            faces: args.faces,
            border: args.border,
            surface: args.surface,
            triangles: args.triangles,
            frame,
        };
        Ok(Self { settings, report, frame, strict: args.strict })
    }
}

/// The preset; the sweeps have none.
fn preset(args: &ShroudArgs) -> Result<Option<Preset>, Failure> {
    let to_the_end = if args.strict { "--strict" } else { "--tolerance" };
    let is_to_the_end = args.strict || args.tolerance.is_some();
    match (args.solver, args.preset) {
        (Solver::Sweeps, None) => Ok(None),
        (Solver::Sweeps, Some(_)) => Err(Failure::Call(
            "--preset has no meaning for --solver sweeps, which always converges: leave it out"
                .into(),
        )),
        (Solver::Newton, Some(Preset::Fast | Preset::Default)) if is_to_the_end => {
            Err(Failure::Call(format!(
                "{to_the_end} has no meaning for --preset fast and default, which stop before convergence; use --preset exact or leave --preset out"
            )))
        }
        (Solver::Newton, None) if is_to_the_end => Ok(Some(Preset::Exact)),
        (Solver::Newton, preset) => Ok(Some(preset.unwrap_or(Preset::Default))),
    }
}

/// The energy, and the parameter it uses, if it uses one.
fn energy(args: &ShroudArgs) -> Result<(energy::Energy, Option<Parameter>), Failure> {
    Ok(match args.energy {
        Energy::Bending if args.parameter.is_some() => {
            let message = "--parameter has no meaning for --energy bending: leave it out, or choose --energy curvature or linear";
            return Err(Failure::Call(message.into()));
        }
        Energy::Bending => (Bending.into(), None),
        Energy::Curvature => {
            let name = args.parameter.unwrap_or(Parameter::Chord);
            (Curvature { parameter: parameter(name) }.into(), Some(name))
        }
        Energy::Linear => {
            let name = args.parameter.unwrap_or(Parameter::Uniform);
            (Linear { parameter: parameter(name) }.into(), Some(name))
        }
    })
}

fn parameter(name: Parameter) -> energy::Parameter {
    match name {
        Parameter::Uniform => energy::Parameter::Uniform,
        Parameter::Chord => energy::Parameter::Chord,
        Parameter::Centripetal => energy::Parameter::Centripetal,
    }
}

fn optimize_settings(
    args: &ShroudArgs,
    energy: energy::Energy,
    preset: Option<Preset>,
) -> optimize::Settings {
    optimize::Settings {
        preset: match preset {
            Some(Preset::Fast) => optimize::Preset::Fast,
            Some(Preset::Default) => optimize::Preset::Default,
            Some(Preset::Exact) | None => optimize::Preset::Exact,
        },
        energy: Some(energy),
        solver: match args.solver {
            Solver::Newton => optimize::Solver::Newton,
            Solver::Sweeps => optimize::Solver::Sweeps,
        },
        start: match args.start {
            Start::Blur => optimize::Start::Blur,
            Start::Midpoint => optimize::Start::Midpoint,
            Start::Random(seed) => optimize::Start::Random(seed),
        },
        tolerance: args.tolerance,
        max_iterations: args.max_iterations.map(|n| n as usize),
        ..optimize::Settings::default()
    }
}

pub(crate) fn face_rule(faces: Faces) -> FaceRule {
    match faces {
        Faces::Separate => FaceRule::Separate,
        Faces::Join => FaceRule::Join,
    }
}

pub(crate) fn border(border: Border) -> volume::Border {
    match border {
        Border::Closed => volume::Border::Closed,
        Border::Open => volume::Border::Open,
    }
}

/// Which voxels are inside.
pub(crate) fn select(args: &VolumeArgs) -> Select {
    match args.threshold {
        Some(level) => Select::Above(level),
        None if args.labels.is_empty() => Select::NonZero,
        None => Select::Labels(args.labels.clone()),
    }
}

/// How the file is read.
pub(crate) fn volume_options<'a>(args: &VolumeArgs, progress: Progress<'a>) -> VolumeOptions<'a> {
    VolumeOptions {
        axes: match args.axes {
            Axes::Zyx => shrouds_io::Axes::Zyx,
            Axes::Xyz => shrouds_io::Axes::Xyz,
        },
        spacing: args.spacing,
        progress: Some(progress),
    }
}
