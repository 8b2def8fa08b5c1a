//! From what was typed to settings that the library takes, or a message that says what is wrong.

use std::path::Path;
use std::sync::Arc;

use serde::Serialize;
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::optimize::{Preset, Solver, Start, VolumeRule};
use shrouds::volume::{Border, FaceRule};
use shrouds::{Choice, Occupancy, Settings, optimize};
use shrouds_io::{Progress, VolumeOptions};

use crate::args::{Axes, FrameChoice, ShroudArgs, SolveArgs, VolumeArgs};
use crate::console::Console;
use crate::energies;
use crate::failure::Failure;
use crate::report::name;

/// The settings of a shroud as the report has them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SettingsReport {
    /// The one in force, arguments included; left out where every result has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) energy: Option<String>,
    /// In degrees; null if all is smooth.
    crease: Option<f64>,
    /// The mask of places that need not be smooth; null without.
    rough: Option<String>,
    #[serde(with = "crate::by_name")]
    solver: Solver,
    /// Null for the sweeps.
    pub(crate) preset: Option<&'static str>,
    /// Null for a preset that does not converge.
    tolerance: Option<f64>,
    max_iterations: usize,
    #[serde(with = "crate::by_name")]
    start: Start,
    margin: f64,
    #[serde(with = "crate::by_name")]
    volume: VolumeRule,
    #[serde(with = "crate::by_name")]
    faces: FaceRule,
    #[serde(with = "crate::by_name")]
    border: Border,
    #[serde(with = "crate::by_name")]
    surface: MeshKind,
    #[serde(with = "crate::by_name")]
    triangles: Triangles,
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
        let job = Self::with_energy(&args.solve, args.energy.as_deref(), args.strict, frame)?;
        job.with_crease(args.crease)
    }

    /// With creases from these degrees on, if any are asked for.
    fn with_crease(mut self, degrees: Option<f64>) -> Result<Self, Failure> {
        if degrees.is_some() && self.settings.optimize.converges() {
            return Err(Failure::Call(
                "--crease has no meaning for --preset exact, --solver sweeps, --strict and --tolerance, which go on until they converge: leave one of them out"
                    .into(),
            ));
        }
        let crease = |degrees: f64| optimize::Crease { angle: degrees.to_radians() };
        self.settings.optimize.crease = degrees.map(crease);
        self.report.crease = degrees;
        Ok(self)
    }

    /// With places of the volume's lattice where the surface need not be smooth.
    pub(crate) fn with_rough(mut self, path: &Path, places: Occupancy) -> Self {
        self.settings.optimize.rough = Some(Arc::new(places));
        self.report.rough = Some(name(path));
        self
    }

    /// With the energy of the preset if none is given.
    pub(crate) fn with_energy(
        args: &SolveArgs,
        energy: Option<&str>,
        strict: bool,
        frame: FrameChoice,
    ) -> Result<Self, Failure> {
        if args.surface == MeshKind::Dual && args.border == Border::Open {
            let message = "--surface dual needs --border closed; leave one of them out";
            return Err(Failure::Call(message.into()));
        }
        check_volume_rule(args)?;
        let preset = preset(args, strict)?;
        let settings = Settings {
            faces: args.faces,
            border: args.border,
            optimize: optimize_settings(args, energy, preset)?,
            mesh: args.surface,
            triangles: args.triangles,
        };
        let report = SettingsReport {
            energy: Some(settings.optimize.energy().to_string()),
            crease: None,
            rough: None,
            solver: args.solver,
            preset: preset.map(Preset::name),
            tolerance: settings.optimize.converges().then(|| settings.optimize.tolerance()),
            max_iterations: settings.optimize.max_iterations(),
            start: args.start.clone(),
            margin: settings.optimize.margin,
            volume: args.volume,
            faces: args.faces,
            border: args.border,
            surface: args.surface,
            triangles: args.triangles,
            frame,
        };
        Ok(Self { settings, report, frame, strict })
    }

    /// The energy in force.
    pub(crate) fn energy(&self) -> String {
        self.settings.optimize.energy().to_string()
    }

    /// Warns of an energy that may destroy thin parts.
    pub(crate) fn warn(&self, console: Console) {
        if let Some(names) = energies::destructive(&self.energy()) {
            console.warn(&format!(
                "{names} may destroy parts one voxel thin; --energy bending keeps them"
            ));
        }
    }
}

/// Refuses what does not go together with keeping volumes.
fn check_volume_rule(args: &SolveArgs) -> Result<(), Failure> {
    let needed = match args {
        SolveArgs { volume: VolumeRule::Free, .. } => return Ok(()),
        SolveArgs { solver: Solver::Sweeps, .. } => "--solver newton",
        SolveArgs { border: Border::Open, .. } => "--border closed",
        SolveArgs { surface: MeshKind::Dual, .. } => "--surface primal",
        _ => return Ok(()),
    };
    Err(Failure::Call(format!("--volume keep needs {needed}; change one of them")))
}

/// The preset; the sweeps have none.
fn preset(args: &SolveArgs, strict: bool) -> Result<Option<Preset>, Failure> {
    let to_the_end = if strict { "--strict" } else { "--tolerance" };
    let is_to_the_end = strict || args.tolerance.is_some();
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

fn optimize_settings(
    args: &SolveArgs,
    energy: Option<&str>,
    preset: Option<Preset>,
) -> Result<optimize::Settings, Failure> {
    Ok(optimize::Settings {
        preset: preset.unwrap_or(Preset::Exact),
        energy: energies::read(energy, args.parameter.as_deref())?,
        solver: args.solver,
        start: args.start.clone(),
        volume: args.volume,
        tolerance: args.tolerance,
        max_iterations: args.max_iterations.map(|n| n as usize),
        ..optimize::Settings::default()
    })
}

/// How the file is read.
pub(crate) fn volume_options<'a>(
    args: &'a VolumeArgs,
    progress: Progress<'a>,
) -> VolumeOptions<'a> {
    VolumeOptions {
        axes: match args.axes {
            Axes::Zyx => shrouds_io::Axes::Zyx,
            Axes::Xyz => shrouds_io::Axes::Xyz,
        },
        spacing: args.spacing,
        layer: args.layer(),
        array: args.array.as_deref(),
        level: args.level,
        raw: args.raw(),
        progress: Some(progress),
    }
}
