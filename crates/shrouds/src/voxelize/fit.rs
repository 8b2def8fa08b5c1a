//! A lattice for a mesh.

use crate::error::Error;
use crate::grid::Grid;
use crate::mesh::TriMesh;

/// How fine a lattice is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fit {
    /// So many lattice points along the longest side of the mesh's box, margins included, and the same
    /// spacing along all axes.
    Size(usize),
    /// This spacing along x, y, z, in world units.
    Spacing([f64; 3]),
}

/// A lattice along the world's axes that holds a mesh, with `margin` more lattice points on each side;
/// 1 or 2 are enough for all that follows.
///
/// The voxels, each a spacing wide, cover the box of the mesh and have their middle where it has
/// its own; the lattice points are the centres of the voxels, so that a box has none of them on its
/// surface. Vertices that no triangle uses do not count.
///
/// # Errors
/// [`Error::NoExtent`] when the mesh has no triangles, or a size is given and all triangles lie in one
/// point; [`Error::Setting`] when the size leaves no point between the margins or a spacing is not
/// positive and finite; [`Error::Dimensions`] when the lattice has too many points; [`Error::Mesh`]
/// when a triangle names a vertex that does not exist or a coordinate is not finite.
pub fn grid_for(mesh: &TriMesh, fit: Fit, margin: usize) -> Result<Grid, Error> {
    let [low, high] = bounds(mesh)?;
    let extent: [f64; 3] = std::array::from_fn(|d| high[d] - low[d]);
    let longest = extent.into_iter().fold(0.0, f64::max);
    let spacing = match fit {
        Fit::Size(size) => match size.checked_sub(margin.saturating_mul(2)) {
            None | Some(0) => {
                let range = "more than twice the margin";
                return Err(Error::Setting { name: "size", value: size.to_string(), range });
            }
            Some(_) if longest == 0.0 => {
                return Err(Error::NoExtent("all its triangles lie in one point"));
            }
            Some(cells) => [longest / cells as f64; 3],
        },
        Fit::Spacing(spacing) => spacing,
    };
    if !spacing.iter().all(|step| *step > 0.0 && step.is_finite()) {
        let value = format!("{spacing:?}");
        return Err(Error::Setting { name: "spacing", value, range: "positive and finite" });
    }
    // What is whole but for rounding stays so; casts saturate, so that too many points are refused.
    let cells =
        [0, 1, 2].map(|d| ((extent[d] / spacing[d] * (1.0 - 1e-12)).ceil() as usize).max(1));
    let dims = cells.map(|cells| cells.saturating_add(margin.saturating_mul(2)));
    let affine = std::array::from_fn(|r| {
        let half = 0.5 * (dims[r].min(Grid::MAX_DIM) - 1) as f64;
        let mut row = [0.0; 4];
        row[r] = spacing[r];
        row[3] = low[r] + 0.5 * extent[r] - half * spacing[r];
        row
    });
    Grid::with_affine(dims, affine)
}

/// The smallest and largest coordinates of the triangles.
fn bounds(mesh: &TriMesh) -> Result<[[f64; 3]; 2], Error> {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &v in triangle {
            let point = mesh.vertices.get(v as usize).ok_or_else(|| {
                let count = mesh.vertices.len();
                Error::Mesh(format!("triangle {t} names vertex {v}, but there are only {count}"))
            })?;
            if !point.iter().all(|x| x.is_finite()) {
                return Err(Error::Mesh(format!("vertex {v} lies at {point:?}")));
            }
            for d in 0..3 {
                bounds[0][d] = bounds[0][d].min(point[d]);
                bounds[1][d] = bounds[1][d].max(point[d]);
            }
        }
    }
    if mesh.triangles.is_empty() {
        return Err(Error::NoExtent("it has no triangles"));
    }
    Ok(bounds)
}
