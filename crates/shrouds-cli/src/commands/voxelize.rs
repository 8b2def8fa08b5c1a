//! `shrouds voxelize`: a triangle mesh in, the voxels inside it out.

use serde::Serialize;
use shrouds::check::Found;
use shrouds::voxelize::{Fit, Method, Rule, VoxelizeReport, grid_for, voxelize};
use shrouds::{Grid, TriMesh};
use shrouds_io::{Frame, VolumeOptions, read_contents, read_mesh, volume_format, write_volume};
use shrouds_io::{mesh_format, written_format};

use crate::args::{VoxelizeArgs, Winding};
use crate::console::{Console, grouped, number, print_json};
use crate::failure::Failure;
use crate::measure::bounds;
use crate::output::check_targets;
use crate::progress::Progress;
use crate::report::name;

/// What was done, and what is wrong with the mesh.
#[derive(Serialize)]
struct Report {
    mesh: String,
    output: String,
    /// Lattice points along x, y, z.
    dims: [usize; 3],
    spacing: [f64; 3],
    affine: [[f64; 4]; 3],
    /// Voxels inside.
    inside: u64,
    /// Their volume in cubic world units, and that which the mesh encloses.
    voxel_volume: f64,
    enclosed_volume: f64,
    /// `exact` where the mesh has no holes, else `generalized winding number`.
    method: &'static str,
    closed: bool,
    boundary_edges: u64,
    non_manifold_edges: u64,
    inconsistent_edges: u64,
    joined_vertices: u64,
    /// Edges with one triangle that joining vertices closed.
    joined_edges: u64,
    repeated_triangles: u64,
    turned_triangles: u64,
    inside_out: bool,
    /// Voxels that could be on either side.
    doubtful: u64,
    /// The same in sentences.
    notes: Vec<String>,
}

pub(crate) fn run(args: &VoxelizeArgs, console: Console) -> Result<(), Failure> {
    mesh_format(&args.mesh)?;
    written_format(&args.output)?;
    args.like.as_ref().map_or(Ok(()), |like| volume_format(like).map(drop))?;
    let inputs: Vec<_> = std::iter::once(&*args.mesh).chain(args.like.as_deref()).collect();
    check_targets(&[&args.output], &inputs)?;
    let progress = Progress::new(console.quiet);
    progress.stage("reading the mesh");
    let mut mesh = read_mesh(&args.mesh)?;
    let here = |error: shrouds::Error| match Failure::from(error) {
        Failure::Undone(text) => Failure::Undone(format!("{}: {text}", args.mesh.display())),
        other => other,
    };
    let margin = args.margin as usize;
    let unknown = || Frame { name: "unnamed".into(), unit: "unknown".into(), source: "mesh" };
    let (grid, frame) = match (&args.like, args.spacing, args.size) {
        (Some(like), _, _) => {
            let (grid, frame, _) = read_contents(like, &VolumeOptions::default())?;
            if args.fit {
                fit(&mut mesh, &grid, margin).map_err(|problem| {
                    Failure::Undone(format!("{}: {problem}", args.mesh.display()))
                })?;
            }
            (grid, frame)
        }
        (None, Some(spacing), _) => {
            (grid_for(&mesh, Fit::Spacing(spacing), margin).map_err(here)?, unknown())
        }
        (None, None, size) => {
            let size = size.unwrap_or_default() as usize;
            (grid_for(&mesh, Fit::Size(size), margin).map_err(here)?, unknown())
        }
    };
    progress.stage("voxelising");
    let rule = match args.winding {
        Winding::NonZero => Rule::NonZero,
        Winding::Positive => Rule::Positive,
        Winding::Odd => Rule::Odd,
    };
    let voxelized = voxelize(&mesh, &grid, rule).map_err(here)?;
    progress.stage("writing");
    write_volume(&args.output, &voxelized.volume, &frame)?;
    drop(progress);
    let report = Report::new(args, &voxelized.volume, &voxelized.report);
    for note in &report.notes {
        console.warn(&format!("{}: {note}", args.mesh.display()));
    }
    if report.inside == 0 {
        console.warn(&format!("{}: nothing is inside", args.output.display()));
    }
    if args.json {
        return print_json(&report);
    }
    console.message(&report.in_words(args));
    Ok(())
}

/// Scales and moves a mesh so that its box fills that of a lattice, less `margin` voxels on every
/// side, and has its middle there.
fn fit(mesh: &mut TriMesh, grid: &Grid, margin: usize) -> Result<(), String> {
    let [low, high] = bounds(mesh.vertices.iter().copied()).ok_or("the mesh has no vertices")?;
    let dims = grid.dims();
    if dims.iter().any(|&n| n <= 2 * margin + 1) {
        return Err(format!("a lattice of {dims:?} voxels has no room within --margin {margin}"));
    }
    // Of a lattice turned against the world the box of its corners would be too large.
    let affine = grid.affine();
    let is_along_world = (0..3).all(|c| affine.iter().filter(|row| row[c] != 0.0).count() == 1);
    if !is_along_world {
        return Err("--fit needs a lattice along the axes of the world".into());
    }
    let corners = [dims.map(|_| margin as f64), dims.map(|n| (n - 1 - margin) as f64)];
    let [a, b] = corners.map(|corner| grid.point(corner));
    let scale = (0..3).map(|d| (b[d] - a[d]).abs() / (high[d] - low[d])).fold(f64::MAX, f64::min);
    if !scale.is_finite() || scale <= 0.0 {
        return Err("the mesh has no extent to scale".into());
    }
    for vertex in &mut mesh.vertices {
        *vertex = std::array::from_fn(|d| {
            0.5 * (a[d] + b[d]) + scale * (vertex[d] - 0.5 * (low[d] + high[d]))
        });
    }
    Ok(())
}

impl Report {
    fn new(args: &VoxelizeArgs, volume: &shrouds::Occupancy, found: &VoxelizeReport) -> Self {
        let grid = volume.grid();
        let inside = volume.count();
        fn count<T>(found: &Found<T>) -> u64 {
            found.count
        }
        Self {
            mesh: name(&args.mesh),
            output: name(&args.output),
            dims: grid.dims(),
            spacing: grid.spacing(),
            affine: grid.affine(),
            inside,
            voxel_volume: inside as f64 * grid.voxel_volume(),
            enclosed_volume: found.enclosed_volume,
            method: match found.method {
                Method::Exact => "exact",
                Method::Generalized => "generalized winding number",
            },
            closed: found.is_closed(),
            boundary_edges: count(&found.boundary_edges),
            non_manifold_edges: count(&found.non_manifold_edges),
            inconsistent_edges: count(&found.inconsistent_edges),
            joined_vertices: found.joined_vertices,
            joined_edges: found.joined_edges,
            repeated_triangles: found.repeated_triangles,
            turned_triangles: found.turned_triangles,
            inside_out: found.inside_out,
            doubtful: count(&found.doubtful),
            notes: found.notes(),
        }
    }

    fn in_words(&self, args: &VoxelizeArgs) -> String {
        let [nx, ny, nz] = self.dims;
        format!(
            "{}: {nx} × {ny} × {nz} voxels, {} inside, volume {} (the mesh encloses {})",
            args.output.display(),
            grouped(self.inside),
            number(self.voxel_volume),
            number(self.enclosed_volume.abs()),
        )
    }
}
