//! Where a mesh crosses the grid edges of the surface of its own voxels.

use crate::check;
use crate::check::crossing::{EdgeCrossing, edge_crossings, in_index_coordinates};
use crate::error::Error;
use crate::mesh::TriMesh;
use crate::surface::{Crossing, Surface};
use crate::volume::Border;

/// δ of a mesh that was voxelised.
#[derive(Debug, Clone, PartialEq)]
pub struct Deltas {
    /// δ of every vertex of the surface; 1 is the inside end.
    pub delta: Vec<f64>,
    /// How many grid edges the mesh does not cross, as near holes. Their vertices are in the middle.
    pub missing: u64,
}

/// The places where a mesh, in world coordinates, crosses the grid edges of a surface, which is that of
/// the voxels inside the mesh.
///
/// On a grid edge that is crossed once the vertex lies at the crossing. Where there are several, as where
/// thin parts are missed by the lattice, it divides the edge into the length inside the mesh and the
/// length outside: nothing jumps when two crossings meet and vanish.
///
/// ```
/// use shrouds::surface::Surface;
/// use shrouds::volume::{Border, FaceRule};
/// use shrouds::voxelize::{Fit, Rule, deltas, grid_for, voxelize};
/// # let mesh = shrouds::TriMesh {
/// #     vertices: vec![[0.0; 3], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 6.0]],
/// #     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
/// #     normals: vec![],
/// # };
/// let grid = grid_for(&mesh, Fit::Size(20), 1)?;
/// let volume = voxelize(&mesh, &grid, Rule::NonZero)?.volume;
/// let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed)?;
/// let deltas = deltas(&mesh, &surface)?;
/// assert_eq!((deltas.delta.len(), deltas.missing), (surface.vertex_count(), 0));
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] as for [`voxelize`](crate::voxelize()).
pub fn deltas(mesh: &TriMesh, surface: &Surface) -> Result<Deltas, Error> {
    check::structure(mesh)?;
    let body = in_index_coordinates(mesh, surface.grid(), Border::Closed)?;
    let dims = surface.grid().dims();
    let found = [0, 1, 2].map(|axis| edge_crossings(&body, axis, dims));
    let mut missing = 0;
    let delta = surface
        .crossings()
        .map(|crossing| {
            let found = on_edge(&found[crossing.axis()], crossing, dims);
            missing += u64::from(found.is_empty());
            outside_share(found, crossing.inside_low())
        })
        .collect();
    Ok(Deltas { delta, missing })
}

/// The crossings that lie on the grid edge of one of the surface.
fn on_edge(found: &[EdgeCrossing], edge: Crossing, dims: [usize; 3]) -> &[EdgeCrossing] {
    let [i, j, k] = edge.low().map(|x| x as u64);
    let low = (k * dims[1] as u64 + j) * dims[0] as u64 + i;
    let from = found.partition_point(|crossing| crossing.low < low);
    let count = found[from..].iter().take_while(|crossing| crossing.low == low).count();
    &found[from..from + count]
}

/// The share of an edge's length that lies outside.
fn outside_share(found: &[EdgeCrossing], inside_low: bool) -> f64 {
    let total: i64 = found.iter().map(|crossing| i64::from(crossing.side)).sum();
    let Some(first) = found.first() else { return 0.5 };
    if total == 0 {
        return if inside_low { 1.0 - first.along } else { first.along };
    }
    // From the low end on, as many shells are passed as lie between the ends: where all of them are,
    // one is on the side of the high end.
    let (mut passed, mut from, mut high) = (0, 0.0, 0.0);
    for crossing in found {
        high += if passed * total.signum() >= total.abs() { crossing.along - from } else { 0.0 };
        from = crossing.along;
        passed += i64::from(crossing.side);
    }
    high += 1.0 - from;
    if inside_low { high } else { 1.0 - high }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(crossings: &[(f64, i8)], inside_low: bool) -> f64 {
        let found: Vec<_> =
            crossings.iter().map(|&(along, side)| EdgeCrossing { low: 0, along, side }).collect();
        outside_share(&found, inside_low)
    }

    #[test]
    fn several_crossings_share_the_edge() {
        assert_eq!(share(&[], true), 0.5);
        assert_eq!(share(&[(0.25, 1)], true), 0.75);
        assert_eq!(share(&[(0.25, -1)], false), 0.25);
        // A gap from 0.5 to 0.75.
        assert_eq!(share(&[(0.25, 1), (0.5, -1), (0.75, 1)], true), 0.5);
        // Two shells that overlap: inside until both are left.
        assert_eq!(share(&[(0.25, 1), (0.5, 1)], true), 0.5);
        // Inside out.
        assert_eq!(share(&[(0.25, -1)], true), 0.75);
    }
}
