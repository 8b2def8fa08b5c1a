//! `shrouds voxelize`: a triangle mesh in, the voxels inside it out.

use serde::Serialize;
use shrouds::check::Found;
use shrouds::voxelize::{Method, VoxelizeReport};
use shrouds_io::{mesh_format, write_volume, written_format};

use crate::args::VoxelizeArgs;
use crate::body::Body;
use crate::console::{Console, grouped, number, print_json};
use crate::failure::Failure;
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
    let inputs: Vec<_> = std::iter::once(&*args.mesh).chain(args.lattice.like.as_deref()).collect();
    check_targets(&[&args.output], &inputs)?;
    let progress = Progress::new(console.quiet);
    let body = Body::read(&args.mesh, &args.lattice, args.spacing, &progress)?;
    let (voxelized, frame) = (body.voxelized, body.frame);
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
