//! The report file: what went in, what was asked, what came out, and whether it holds.

use std::fs;
use std::path::Path;

use serde::Serialize;
use shrouds::check::CheckReport;
use shrouds::optimize::{self, ComponentVolume, Preset, Round};
use shrouds::{Choice, Grid};

use crate::console::plural;
use crate::input::Source;
use crate::settings::{Job, SettingsReport};

/// Everything about one shroud.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Report {
    pub(crate) input: Input,
    pub(crate) settings: SettingsReport,
    pub(crate) topology: Topology,
    pub(crate) solver: SolverReport,
    pub(crate) geometry: Geometry,
    pub(crate) checks: Checks,
    pub(crate) times: Times,
    /// Largest memory in bytes so far, where the system tells it.
    pub(crate) memory: Option<u64>,
    pub(crate) version: &'static str,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Input {
    pub(crate) file: String,
    /// Which voxels are inside, in words.
    pub(crate) selection: String,
    #[serde(flatten)]
    pub(crate) lattice: Lattice,
    /// Number of inside voxels.
    pub(crate) inside: u64,
}

/// A lattice and where it lies.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Lattice {
    /// Lattice points along x, y, z.
    pub(crate) dims: [usize; 3],
    pub(crate) spacing: [f64; 3],
    pub(crate) affine: [[f64; 4]; 3],
    pub(crate) frame: String,
    pub(crate) unit: String,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Topology {
    pub(crate) vertices: u64,
    pub(crate) triangles: u64,
    pub(crate) components: usize,
    /// Euler characteristic of each component.
    pub(crate) euler: Vec<i64>,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct SolverReport {
    pub(crate) status: &'static str,
    pub(crate) iterations: usize,
    pub(crate) energy: FirstLast,
    /// Norm of the projected gradient.
    pub(crate) projected_gradient: f64,
    /// In grid edge lengths.
    pub(crate) projected_step: RmsMax,
    /// What a vertex can gain at most by moving alone.
    largest_gain: f64,
    /// How far above the minimum the energy can be; null where that is not known.
    energy_gap: Option<f64>,
    /// Share of the vertices at a bound, 0 to 1.
    pub(crate) at_bound: f64,
    pub(crate) rounds: Vec<RoundReport>,
    /// Those of the surface's components, where they are kept.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) volumes: Vec<VolumeReport>,
}

/// The volume of a connected component in cubic world units, negative for a cavity.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct VolumeReport {
    /// Voxels times the volume of one.
    pub(crate) target: f64,
    pub(crate) reached: f64,
    pub(crate) relative_error: f64,
    /// How fast the least energy grows with the target.
    pub(crate) multiplier: f64,
    /// Whether the bounds keep it from its target.
    pub(crate) held: bool,
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct FirstLast {
    pub(crate) first: f64,
    pub(crate) last: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct RmsMax {
    pub(crate) rms: f64,
    pub(crate) max: f64,
}

/// Iterations with the same weights and barrier.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RoundReport {
    pub(crate) status: &'static str,
    /// At the start and after every iteration.
    pub(crate) energy: Vec<f64>,
}

/// In world units, whatever the frame of the mesh.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Geometry {
    pub(crate) volume: f64,
    pub(crate) area: f64,
    /// Inside voxels times the volume of one.
    pub(crate) voxel_volume: f64,
    /// What the formula of a phantom says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) true_volume: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) true_area: Option<f64>,
}

/// The certificate in numbers; all counts but those of components should be 0.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Checks {
    pub(crate) ok: bool,
    /// What is wrong, in sentences.
    pub(crate) problems: Vec<String>,
    pub(crate) wrong_side: u64,
    pub(crate) odd_winding: u64,
    /// Lattice points within 1e-4 voxels of the surface.
    pub(crate) touching: u64,
    pub(crate) inverted: bool,
    pub(crate) non_manifold_edges: u64,
    pub(crate) non_manifold_vertices: u64,
    pub(crate) inconsistent_edges: u64,
    /// Edges of one triangle, away from the border of the volume if that is open.
    pub(crate) boundary_edges: u64,
    pub(crate) degenerate_triangles: u64,
    /// Null where not looked for.
    pub(crate) self_intersections: Option<u64>,
    pub(crate) components: FoundExpected<u64>,
    pub(crate) euler: FoundExpected<i64>,
}

/// What the mesh has and what the voxels ask for, where that is known.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct FoundExpected<T> {
    pub(crate) found: T,
    pub(crate) expected: Option<T>,
}

/// Seconds.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Times {
    pub(crate) read: f64,
    pub(crate) surface: f64,
    pub(crate) optimize: f64,
    pub(crate) mesh: f64,
    pub(crate) check: f64,
    /// Mesh and picture, drawing included.
    pub(crate) write: f64,
    pub(crate) total: f64,
}

impl Report {
    /// The report of a shroud that was checked in world coordinates. Times of checking, writing and
    /// all together, and the memory, come when they are known.
    pub(crate) fn new(
        source: &Source,
        job: &Job,
        optimization: &optimize::Report,
        times: shrouds::Times,
        checks: &CheckReport,
    ) -> Self {
        Self {
            input: Input::new(source),
            settings: job.report.clone(),
            topology: Topology::new(checks),
            solver: SolverReport::new(optimization),
            geometry: Geometry::new(source, checks),
            checks: Checks::new(checks),
            times: Times::new(source.seconds, times),
            memory: None,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// In words, that the preset stopped before the minimum, and what is left, unless it is one that
    /// converges. Together the vertices would move farther than each one alone.
    pub(crate) fn shortfall(&self) -> Option<String> {
        let preset = self.settings.preset.filter(|&preset| preset != Preset::Exact.name())?;
        Some(format!(
            "--preset {preset} stopped after {}, before convergence: each vertex alone would still move {:.1e} voxels RMS",
            plural(self.solver.iterations, "iteration"),
            self.solver.projected_step.rms,
        ))
    }
}

impl Input {
    pub(crate) fn new(source: &Source) -> Self {
        Self {
            file: name(&source.path),
            selection: source.selection.clone(),
            lattice: Lattice::new(&source.lattice, &source.frame.name, &source.frame.unit),
            inside: source.occupancy.count(),
        }
    }
}

impl Lattice {
    pub(crate) fn new(grid: &Grid, frame: &str, unit: &str) -> Self {
        Self {
            dims: grid.dims(),
            spacing: grid.spacing(),
            affine: grid.affine(),
            frame: frame.into(),
            unit: unit.into(),
        }
    }
}

impl Topology {
    fn new(checks: &CheckReport) -> Self {
        let structure = &checks.structure;
        let components = &structure.components;
        Self {
            vertices: structure.vertices + structure.unused_vertices,
            triangles: structure.triangles,
            components: components.len(),
            euler: components.iter().map(|component| component.euler).collect(),
        }
    }
}

impl SolverReport {
    pub(crate) fn new(report: &optimize::Report) -> Self {
        let [first, last] = report.energy;
        Self {
            status: report.status.name(),
            iterations: report.iterations,
            energy: FirstLast { first, last },
            projected_gradient: report.projected_gradient,
            projected_step: RmsMax {
                rms: report.projected_step_rms,
                max: report.projected_step_max,
            },
            largest_gain: report.largest_gain,
            energy_gap: report.energy_gap,
            at_bound: report.at_bound,
            rounds: report.rounds.iter().map(RoundReport::new).collect(),
            volumes: report.volumes.iter().map(VolumeReport::new).collect(),
        }
    }

    /// In words, how well volumes were kept, if they were to be.
    pub(crate) fn kept(&self) -> Option<String> {
        let components = plural(self.volumes.len(), "component");
        let held = self.volumes.iter().filter(|volume| volume.held).count();
        let free = self.volumes.iter().filter(|volume| !volume.held);
        let error = free.map(|volume| volume.relative_error).fold(0.0, f64::max);
        match (self.volumes.len(), held) {
            (0, _) => None,
            (_, 0) => Some(format!("volume of {components} kept to {error:.0e}")),
            _ => Some(format!(
                "volume of {components} kept to {error:.0e}, but for {held} held by the bounds"
            )),
        }
    }
}

impl VolumeReport {
    fn new(volume: &ComponentVolume) -> Self {
        Self {
            target: volume.target,
            reached: volume.reached,
            relative_error: volume.relative_error(),
            multiplier: volume.multiplier,
            held: volume.is_held,
        }
    }
}

impl RoundReport {
    fn new(round: &Round) -> Self {
        Self { status: round.status.name(), energy: round.energies.clone() }
    }
}

impl Geometry {
    fn new(source: &Source, checks: &CheckReport) -> Self {
        let volume = &source.occupancy;
        Self {
            volume: checks.structure.volume,
            area: checks.structure.area,
            voxel_volume: volume.count() as f64 * volume.grid().voxel_volume(),
            true_volume: source.truth[0],
            true_area: source.truth[1],
        }
    }
}

impl Checks {
    pub(crate) fn new(report: &CheckReport) -> Self {
        let (structure, separation) = (&report.structure, &report.separation);
        Self {
            ok: report.is_clean(),
            problems: report.problems(),
            wrong_side: separation.wrong_side.count,
            odd_winding: separation.odd_winding.count,
            touching: separation.touching.count,
            inverted: separation.inverted,
            non_manifold_edges: structure.non_manifold_edges.count,
            non_manifold_vertices: structure.non_manifold_vertices.count,
            inconsistent_edges: structure.inconsistent_edges.count,
            boundary_edges: report.stray_boundary_edges.count,
            degenerate_triangles: structure.degenerate_triangles.count,
            self_intersections: report.self_intersections.as_ref().map(|found| found.count),
            components: FoundExpected {
                found: structure.components.len() as u64,
                expected: report.expected.surface_components,
            },
            euler: FoundExpected {
                found: structure.euler(),
                expected: Some(report.expected.euler),
            },
        }
    }
}

impl Times {
    fn new(read: f64, times: shrouds::Times) -> Self {
        let shrouds::Times { surface, optimize, mesh } = times;
        Self { read, surface, optimize, mesh, check: 0.0, write: 0.0, total: 0.0 }
    }
}

/// A path as text.
pub(crate) fn name(path: &Path) -> String {
    path.display().to_string()
}

/// The largest memory this process has had, in bytes; only Linux tells.
pub(crate) fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}
