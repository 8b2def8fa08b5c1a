//! Meshes in: read, and voxelised on a lattice.

use std::path::Path;

use shrouds::voxelize::{Fit, Rule, Voxelized, grid_for, voxelize};
use shrouds::{Grid, TriMesh};
use shrouds_io::{Frame, VolumeOptions, read_contents, read_mesh, volume_format};

use crate::args::{LatticeArgs, Winding};
use crate::failure::Failure;
use crate::progress::Progress;
use shrouds_report::looks::bounds;

/// A mesh with the voxels inside it.
pub(crate) struct Body {
    /// Where it was voxelised: scaled and moved, if that was asked for.
    pub(crate) mesh: TriMesh,
    pub(crate) voxelized: Voxelized,
    pub(crate) frame: Frame,
}

impl Body {
    /// Reads a mesh and voxelises it on the lattice of the arguments, or one with this spacing.
    pub(crate) fn read(
        path: &Path,
        args: &LatticeArgs,
        spacing: Option<[f64; 3]>,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        args.like.as_ref().map_or(Ok(()), |like| volume_format(like).map(drop))?;
        progress.stage("reading the mesh");
        let mut mesh = read_mesh(path)?;
        let fail = |problem: String| Failure::Undone(format!("{}: {problem}", path.display()));
        let here = |error: shrouds::Error| match Failure::from(error) {
            Failure::Undone(text) => fail(text),
            other => other,
        };
        let margin = args.margin as usize;
        let (grid, frame) = match &args.like {
            Some(like) => {
                let (grid, frame, _) = read_contents(like, &VolumeOptions::default())?;
                if args.fit {
                    fit(&mut mesh, &grid, margin).map_err(fail)?;
                }
                (grid, frame)
            }
            None => {
                let size = Fit::Size(args.size.unwrap_or_default() as usize);
                let grid = grid_for(&mesh, spacing.map_or(size, Fit::Spacing), margin);
                let (name, unit) = ("unnamed".into(), "unknown".into());
                (grid.map_err(here)?, Frame { name, unit, source: "mesh" })
            }
        };
        progress.stage("voxelising");
        let rule = match args.winding {
            Winding::NonZero => Rule::NonZero,
            Winding::Positive => Rule::Positive,
            Winding::Odd => Rule::Odd,
        };
        let voxelized = voxelize(&mesh, &grid, rule).map_err(here)?;
        Ok(Self { mesh, voxelized, frame })
    }
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
