//! How thick a body is.
//!
//! The thickness at a place on the surface is the length of the inward normal's line within the body:
//! from the place to where a ray against the normal first leaves. It is the ray method of the thickness
//! of walls, and the shape diameter function with a cone of one ray (Shapira, Shamir and Cohen-Or,
//! *Consistent mesh partitioning and skeletonisation using the shape diameter function*, 2008). A plate
//! has its thickness, a ball its diameter and a rod the diameter of its section; where the sides are not
//! parallel it is more than the diameter of the inscribed ball.

use crate::error::Error;
use crate::measure::nearest::doubled_area;
use crate::measure::samples::{Samples, pieces, refuse_damage};
use crate::mesh::TriMesh;
use crate::parallel;
use crate::tree::Tree;
use crate::vector::{add, length, scale};

/// Triangles per block of parallel work.
const BLOCK: usize = 256;

/// Thicknesses of a body over the area of its surface, in world units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Thickness {
    /// The mean.
    pub mean: f64,
    /// As much area has less as has more.
    pub median: f64,
    /// The largest one.
    pub maximum: f64,
    /// Share of the area, 0 to 1, whose rays leave the body: all of it if the mesh is closed. The others
    /// do not count.
    pub share: f64,
}

/// The thickness of a body, seen from the middles of the pieces of its triangles.
///
/// `step` is the largest length of the pieces, in world units; normals are those of the triangles.
///
/// ```
/// use shrouds::{Settings, measure::thickness, shroud, volume::phantom};
///
/// let ball = shroud(&phantom::sphere(32)?, &Settings::default())?.mesh; // of radius 12.8
/// let found = thickness(&ball, 2.0)?;
/// assert!((found.median / 25.6 - 1.0).abs() < 0.02);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when the mesh has no area, or a triangle names a vertex that does not exist or is not
/// finite; [`Error::Setting`] when the step is not positive.
pub fn thickness(mesh: &TriMesh, step: f64) -> Result<Thickness, Error> {
    refuse_damage(mesh, step)?;
    let tree = Tree::new(mesh.triangles.iter().map(|&t| mesh.corners(t)).collect());
    let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut samples = Samples::default();
        for &triangle in &mesh.triangles[range] {
            for piece in pieces(mesh.corners(triangle), step) {
                let [a, b, c] = piece;
                let normal = doubled_area(piece);
                let size = length(normal);
                let middle = scale(add(add(a, b), c), 1.0 / 3.0);
                // Without an area there is no direction.
                if let Some(far) = tree.exit(middle, scale(normal, -1.0 / size)) {
                    samples.push(far, 0.5 * size);
                }
            }
        }
        samples
    });
    let mut samples = Samples::default();
    blocks.into_iter().for_each(|block| samples.extend(block));
    samples.sort();
    let measured = samples.area();
    Ok(Thickness {
        mean: if measured > 0.0 { samples.integral(|x| x) / measured } else { 0.0 },
        median: samples.quantile(0.5),
        maximum: samples.largest(),
        share: measured / mesh.area(),
    })
}
