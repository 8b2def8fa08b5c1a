//! The parts of the report on a shroud: what came out, and whether it holds.

use std::fs;

use serde::Serialize;
use shrouds::check::CheckReport;
use shrouds::optimize::{self, ComponentVolume, Round};
use shrouds::{Grid, Occupancy};

/// A lattice and where it lies.
#[derive(Debug, Clone, Serialize)]
pub struct Lattice {
    /// Lattice points along x, y, z.
    pub dims: [usize; 3],
    /// Distance of neighbouring points along x, y, z, in world units.
    pub spacing: [f64; 3],
    /// The map from index to world, three rows of four.
    pub affine: [[f64; 4]; 3],
    /// What the world is: `RAS`, `LPS`, or another name.
    pub frame: String,
    /// Of length.
    pub unit: String,
}

/// What hangs together.
#[derive(Debug, Clone, Serialize)]
pub struct Topology {
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Its triangles.
    pub triangles: u64,
    /// Its connected components.
    pub components: usize,
    /// Euler characteristic of each component.
    pub euler: Vec<i64>,
}

/// How the optimisation went.
#[derive(Debug, Clone, Serialize)]
pub struct SolverReport {
    /// How it ended, in words.
    pub status: &'static str,
    /// Steps or sweeps over all rounds.
    pub iterations: usize,
    /// What was minimised.
    pub energy: FirstLast,
    /// Norm of the projected gradient.
    pub projected_gradient: f64,
    /// In grid edge lengths.
    pub projected_step: RmsMax,
    /// What a vertex can gain at most by moving alone.
    pub largest_gain: f64,
    /// How far above the minimum the energy can be; null where that is not known.
    pub energy_gap: Option<f64>,
    /// Share of the vertices at a bound, 0 to 1.
    pub at_bound: f64,
    /// In their order.
    pub rounds: Vec<RoundReport>,
    /// Those of the surface's components, where they are kept.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub volumes: Vec<VolumeReport>,
}

/// The volume of a connected component in cubic world units, negative for a cavity.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct VolumeReport {
    /// Voxels times the volume of one.
    pub target: f64,
    /// What it came to.
    pub reached: f64,
    /// How far that is from the target, as part of it.
    pub relative_error: f64,
    /// How fast the least energy grows with the target.
    pub multiplier: f64,
    /// Whether the bounds keep it from its target.
    pub held: bool,
}

/// A number before and after.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FirstLast {
    /// Before.
    pub first: f64,
    /// After.
    pub last: f64,
}

/// How large many numbers are.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct RmsMax {
    /// Their root mean square.
    pub rms: f64,
    /// The largest.
    pub max: f64,
}

/// Iterations with the same weights and barrier.
#[derive(Debug, Clone, Serialize)]
pub struct RoundReport {
    /// How it ended, in words.
    pub status: &'static str,
    /// At the start and after every iteration.
    pub energy: Vec<f64>,
}

/// In world units, whatever the frame of the mesh.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Geometry {
    /// What the mesh encloses.
    pub volume: f64,
    /// Of its triangles.
    pub area: f64,
    /// Inside voxels times the volume of one.
    pub voxel_volume: f64,
    /// What the formula of a phantom says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub true_volume: Option<f64>,
    /// The same of the area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub true_area: Option<f64>,
}

/// The certificate in numbers; all counts but those of components should be 0.
#[derive(Debug, Clone, Serialize)]
pub struct Checks {
    /// Whether there are no problems.
    pub ok: bool,
    /// What is wrong, in sentences.
    pub problems: Vec<String>,
    /// Lattice points on the wrong side of the mesh.
    pub wrong_side: u64,
    /// Lattice points with a winding number other than 0 and 1.
    pub odd_winding: u64,
    /// Lattice points within 1e-4 voxels of the surface.
    pub touching: u64,
    /// Whether triangles face the inside points.
    pub inverted: bool,
    /// Edges with more than two triangles.
    pub non_manifold_edges: u64,
    /// Vertices with more than one fan of triangles.
    pub non_manifold_vertices: u64,
    /// Edges whose triangles face opposite sides.
    pub inconsistent_edges: u64,
    /// Edges of one triangle, away from the border of the volume if that is open.
    pub boundary_edges: u64,
    /// Triangles without area.
    pub degenerate_triangles: u64,
    /// Null where not looked for.
    pub self_intersections: Option<u64>,
    /// Connected components.
    pub components: FoundExpected<u64>,
    /// Euler characteristics, all together.
    pub euler: FoundExpected<i64>,
}

/// What the mesh has and what the voxels ask for, where that is known.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FoundExpected<T> {
    /// What there is.
    pub found: T,
    /// What there should be.
    pub expected: Option<T>,
}

/// Seconds.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Times {
    /// Reading the volume.
    pub read: f64,
    /// Finding crossings and patches.
    pub surface: f64,
    /// Finding the minimum.
    pub optimize: f64,
    /// Placing vertices and choosing triangles.
    pub mesh: f64,
    /// Checking the mesh.
    pub check: f64,
    /// Mesh and picture, drawing included.
    pub write: f64,
    /// All together.
    pub total: f64,
}

impl Lattice {
    /// The lattice in a world of this name and unit.
    pub fn new(grid: &Grid, frame: &str, unit: &str) -> Self {
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
    /// Of a mesh that was checked.
    pub fn new(checks: &CheckReport) -> Self {
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
    /// From the report of an optimisation.
    pub fn new(report: &optimize::Report) -> Self {
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
    /// Of a mesh that was checked against a volume whose formula says that volume and area are `truth`.
    pub fn new(volume: &Occupancy, truth: [Option<f64>; 2], checks: &CheckReport) -> Self {
        Self {
            volume: checks.structure.volume,
            area: checks.structure.area,
            voxel_volume: volume.count() as f64 * volume.grid().voxel_volume(),
            true_volume: truth[0],
            true_area: truth[1],
        }
    }
}

impl Checks {
    /// From a certificate.
    pub fn new(report: &CheckReport) -> Self {
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
    /// Those of a shroud after so many seconds of reading.
    pub fn new(read: f64, times: shrouds::Times) -> Self {
        let shrouds::Times { surface, optimize, mesh } = times;
        Self { read, surface, optimize, mesh, check: 0.0, write: 0.0, total: 0.0 }
    }
}

/// The largest memory this process has had, in bytes; only Linux tells.
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}
