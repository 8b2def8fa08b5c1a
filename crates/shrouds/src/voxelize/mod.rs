//! The back arrow, voxelize: in any triangle mesh and a lattice, out the volume of the lattice points
//! inside the mesh.
//!
//! Inside is decided by the winding number. Each triangle that a lattice line along x passes through
//! changes it by one, and the sides are exact: those of the real numbers that the vertices stand for
//! once they are brought to units of the index. A point exactly on the mesh is taken to lie an
//! infinitely small `(δ, ε, ε²)` further along x, y and z, `δ` far above `ε`; of two bodies that share
//! a face, so, each point of the face belongs to one (simulation of simplicity, Edelsbrunner and
//! Mücke, 1990). All closed meshes are decided this way, also those that cross themselves.
//!
//! A mesh with holes has the *generalized* winding number (Jacobson, Kavan and Sorkine-Hornung,
//! *Robust inside-outside segmentation using generalized winding numbers*, 2013): the solid angle of
//! all triangles over 4π, rounded. It need not be summed over the triangles, nor at most points. Caps
//! over the holes close the mesh, so that lines count whole numbers `n`, and `w = n − c`, where `c` is
//! the solid angle of the caps alone. Far from the holes `c` is small and `n` is the answer; where a
//! bound does not show that, `c` is summed, over a tree whose far parts count as dipoles (after
//! Barill, Dickson, Schmidt, Levin and Jacobson, *Fast winding numbers for soups and clouds*, 2018).
//! Any caps give the same `w`.
//!
//! Before that, a mesh that is not closed is put in order: vertices at one place become one, repeated
//! triangles are dropped, and of triangles that hang together by edges but face opposite sides the
//! smaller part by area is turned.
//!
//! Limits: vertices are rounded once, when brought to units of the index; where it matters give a grid
//! whose spacing is a power of two. Within a hole's own size of it the answer is a guess, and
//! [`VoxelizeReport::doubtful`] counts the points where it is a close one. Neighbouring parts that
//! hang together by no edge are never turned.
//!
//! [`deltas()`] gives the place on each crossed grid edge as well.
//!
//! Uses: `grid`, `volume`, `surface`, `mesh`, and of `check` what a mesh is by itself and where lines cross it.

mod caps;
mod deltas;
mod edges;
mod fit;
mod near;
mod order;
mod report;
mod rule;
mod solid_angle;
mod winding;

pub use deltas::{Deltas, deltas};
pub use fit::{Fit, grid_for};
pub use report::{Method, VoxelizeReport};
pub use rule::Rule;

use std::ops::Range;

use crate::check;
use crate::check::crossing::in_index_coordinates;
use crate::error::Error;
use crate::grid::Grid;
use crate::mesh::TriMesh;
use crate::volume::{Border, Occupancy};
use crate::voxelize::rule::Sides;
use crate::voxelize::winding::Lines;

/// A volume made of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Voxelized {
    /// The lattice points inside the mesh.
    pub volume: Occupancy,
    /// How they were found, and what is wrong with the mesh.
    pub report: VoxelizeReport,
}

/// The lattice points of a grid that lie inside a triangle mesh, which is given in world coordinates;
/// see [the module](self) for what inside means where the mesh has holes.
///
/// Work grows with the crossings of the mesh and the lattice lines along x, and memory with those and
/// the bits of the volume; with holes, also with the triangles and the points near the holes. An empty
/// mesh gives an empty volume.
///
/// ```
/// use shrouds::voxelize::{Fit, Method, Rule, grid_for};
/// use shrouds::{TriMesh, voxelize};
///
/// let mesh = TriMesh {
///     vertices: vec![[0.0; 3], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 6.0]],
///     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
///     normals: vec![],
/// };
/// let grid = grid_for(&mesh, Fit::Size(64), 1)?;
/// let voxelized = voxelize(&mesh, &grid, Rule::NonZero)?;
/// let volume = voxelized.volume.count() as f64 * grid.voxel_volume();
/// assert!((volume / 36.0 - 1.0).abs() < 0.01);
/// assert_eq!(voxelized.report.method, Method::Exact);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when a triangle names a vertex that does not exist, a coordinate is not finite or
/// too large, or there are more than 2³²/3 triangles; [`Error::Memory`] when the bits of the lattice
/// points cannot be had. Everything else is a finding.
pub fn voxelize(mesh: &TriMesh, grid: &Grid, rule: Rule) -> Result<Voxelized, Error> {
    Occupancy::check_memory(grid)?;
    let structure = check::structure(mesh)?;
    let mut body = in_index_coordinates(mesh, grid, Border::Closed)?;
    let mut report = VoxelizeReport::default();
    let caps = match structure.is_closed() {
        true => body.triangles.len()..body.triangles.len(),
        false => close(&mut body, structure, &mut report)?,
    };
    report.enclosed_volume = body.volume() * grid.voxel_volume();
    report.inside_out = report.enclosed_volume < 0.0;
    let sides = Sides { rule, inside_out: report.inside_out };
    let lines = Lines::new(&body, grid);
    let mut volume = lines.fill(grid, sides);
    if !caps.is_empty() {
        report.method = Method::Generalized;
        report.doubtful = near::decide(&body, caps, &lines, sides, &mut volume);
    }
    Ok(Voxelized { volume, report })
}

/// Puts a mesh in units of the index in order and closes it with caps, if it needs any; returns which
/// triangles they are.
fn close(
    body: &mut TriMesh,
    mut structure: check::Structure,
    report: &mut VoxelizeReport,
) -> Result<Range<usize>, Error> {
    report.joined_vertices = order::weld(body);
    if report.joined_vertices > 0 {
        let open = structure.boundary_edges.count;
        structure = check::structure(body)?;
        report.joined_edges = open.saturating_sub(structure.boundary_edges.count);
    }
    report.repeated_triangles = order::drop_repeated(body);
    let mut edges = edges::edges(body);
    if !structure.inconsistent_edges.is_empty() {
        report.turned_triangles = order::turn(body, &mut edges);
    }
    report.boundary_edges = structure.boundary_edges;
    report.non_manifold_edges = structure.non_manifold_edges;
    report.inconsistent_edges = structure.inconsistent_edges;
    let first = body.triangles.len();
    caps::close(body, &edges)?;
    Ok(first..body.triangles.len())
}
