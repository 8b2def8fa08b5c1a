//! Lattice points near a mesh, in units of the index.

use crate::check::crossing::{TOUCH, for_points_near, in_index_coordinates, position};
use crate::check::predicates::{Corners, area_vector, distance_squared, is_degenerate};
use crate::check::separation::index_of;
use crate::check::structure::{corners, refuse_damage};
use crate::error::Error;
use crate::grid::Grid;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::volume::Border;

/// Triangles per block of parallel work.
const BLOCK: usize = 1 << 13;
/// How far from a mesh the nearest lattice point is sought: a mesh that separates two neighbours is at
/// most half a grid edge away from one of them.
const REACH: f64 = 0.5;

/// The lattice point that is nearest to a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// Its distance from the mesh in units of the index, in which every grid edge has length 1.
    pub distance: f64,
    /// Its index along x, y, z; of several the one that is first in the volume's array.
    pub index: [usize; 3],
}

/// The lattice point that is nearest to the mesh, if one is within half a grid edge of it.
///
/// Its distance is the margin by which a separating mesh separates: in the lattice every vertex may
/// move by less than that, and no lattice point changes sides. Triangles without area are left out, as
/// their neighbours cover them.
///
/// ```
/// use shrouds::{Grid, TriMesh, check::nearest_point, volume::Border};
///
/// let grid = Grid::new([3; 3], [1.0, 1.0, 4.0])?;
/// let mesh = TriMesh { // in the plane z = 5, a quarter of a grid edge above k = 1
///     vertices: vec![[0.2, 0.2, 5.0], [1.8, 0.2, 5.0], [0.2, 1.9, 5.0]],
///     triangles: vec![[0, 1, 2]],
///     normals: vec![],
/// };
/// let nearest = nearest_point(&mesh, &grid, Border::Closed)?.expect("one below the mesh");
/// assert_eq!((nearest.index, nearest.distance), ([1, 1, 1], 0.25));
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] as for [`check`](crate::check::check).
pub fn nearest_point(
    mesh: &TriMesh,
    grid: &Grid,
    border: Border,
) -> Result<Option<NearestPoint>, Error> {
    refuse_damage(mesh)?;
    let dims = grid.dims();
    let mesh = in_index_coordinates(mesh, grid, border)?;
    let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut nearest: Option<(f64, u64)> = None;
        let mut reach = REACH;
        for t in range {
            points_near(&corners(&mesh, t), reach, dims, |index, squared| {
                let found = (squared, position(index, dims));
                if nearest.is_none_or(|nearest| found < nearest) {
                    nearest = Some(found);
                }
            });
            reach = nearest.map_or(REACH, |(squared, _)| squared.sqrt());
        }
        nearest
    });
    let nearest =
        blocks.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    Ok(nearest.map(|(squared, place)| NearestPoint {
        distance: squared.sqrt(),
        index: index_of(place as usize, dims),
    }))
}

/// Positions of the lattice points within [`TOUCH`] of a triangle, sorted.
pub(super) fn touching_points(mesh: &TriMesh, dims: [usize; 3]) -> Vec<u64> {
    let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut found = Vec::new();
        range.for_each(|t| {
            points_near(&corners(mesh, t), TOUCH, dims, |index, _| {
                found.push(position(index, dims))
            });
        });
        found
    });
    let mut touching = blocks.concat();
    touching.sort_unstable();
    touching.dedup();
    touching
}

/// Calls `visit` with the lattice points within `reach` of a triangle and their squared distances.
fn points_near(
    triangle: &Corners,
    reach: f64,
    dims: [usize; 3],
    mut visit: impl FnMut([usize; 3], f64),
) {
    // No whole number near the triangle along one axis: no lattice point is near it.
    let near = |d: usize| {
        let [a, b, c] = triangle.map(|p| p[d]);
        (a.min(b).min(c) - reach).ceil() <= (a.max(b).max(c) + reach).floor()
    };
    if !(near(0) && near(1) && near(2)) || is_degenerate(triangle) {
        return; // the neighbours across its longest edge cover a degenerate triangle
    }
    let normal = area_vector(triangle);
    let steepest = |a: usize, b: usize| if normal[b].abs() > normal[a].abs() { b } else { a };
    let axis = steepest(steepest(0, 1), 2);
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let flat = triangle.map(|p| [p[u], p[v]]);
    for_points_near(flat, reach, [dims[u], dims[v]], |[iu, iv]| {
        let (du, dv) = (iu as f64 - triangle[0][u], iv as f64 - triangle[0][v]);
        let height = triangle[0][axis] - (normal[u] * du + normal[v] * dv) / normal[axis];
        // A point that near the triangle is at most √3 times as far from its plane along this axis,
        // because the plane rises at most 1 per step along either of the others.
        let low = (height - 2.0 * reach).ceil().max(0.0);
        let high = (height + 2.0 * reach).floor().min(dims[axis] as f64 - 1.0);
        // Casts saturate, and a range that ends before it starts is empty.
        for along in low as usize..(high + 1.0).max(0.0) as usize {
            let mut index = [along; 3];
            (index[u], index[v]) = (iu, iv);
            let squared = distance_squared(index.map(|x| x as f64), triangle);
            if squared <= reach * reach {
                visit(index, squared);
            }
        }
    });
}
