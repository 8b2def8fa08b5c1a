//! The part of a sheet that lies within a body.

use crate::error::Error;
use crate::measure::nearest::doubled_area;
use crate::measure::samples::refuse_damage;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::tree::Tree;
use crate::vector::{dot, length, subtract};

/// The area of the part of `sheet`, any mesh, that lies within the closed mesh `body`, in squared world
/// units.
///
/// Which side of the body a vertex of the sheet is on, and how far from it, is told by the nearest place
/// on the body; triangles with vertices on both sides are cut where these signed distances, taken to be
/// linear, pass zero. Meant for bodies that are smooth where the sheet passes through them.
///
/// # Errors
/// [`Error::Mesh`] when a mesh has no area, or a triangle names a vertex that does not exist or is not
/// finite.
pub fn area_within(sheet: &TriMesh, body: &TriMesh) -> Result<f64, Error> {
    refuse_damage(sheet, 1.0)?;
    refuse_damage(body, 1.0)?;
    let proper = body.triangles.iter().map(|&t| body.corners(t));
    let tree = Tree::new(proper.filter(|&t| length(doubled_area(t)) > 0.0).collect());
    let mut depth = vec![0.0; sheet.vertices.len()];
    parallel::fill(&mut depth, |v| {
        let point = sheet.vertices[v];
        tree.nearest(point).map_or(0.0, |nearest| {
            nearest.distance.copysign(-dot(subtract(point, nearest.place), nearest.normal))
        })
    });
    let parts = sheet.triangles.iter().map(|&t| {
        let area = 0.5 * length(doubled_area(sheet.corners(t)));
        area * share_within(t.map(|v| depth[v as usize]))
    });
    Ok(parts.sum())
}

/// The share of a triangle where a linear function with these values at its corners is positive.
fn share_within(values: [f64; 3]) -> f64 {
    // The part cut off at a corner, whose value has the other sign than those of the other two.
    let corner = |n: usize| {
        let [a, b, c] = [0, 1, 2].map(|m| values[(n + m) % 3]);
        a / (a - b) * (a / (a - c))
    };
    let positive: Vec<usize> = (0..3).filter(|&n| values[n] > 0.0).collect();
    match positive[..] {
        [] => 0.0,
        [n] => corner(n),
        [n, m] => 1.0 - corner(3 - n - m),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_a_triangle_are_those_of_its_cut() {
        assert_eq!(share_within([1.0, 2.0, 3.0]), 1.0);
        assert_eq!(share_within([-1.0, 0.0, -3.0]), 0.0);
        assert_eq!(share_within([1.0, -1.0, -1.0]), 0.25);
        assert_eq!(share_within([-1.0, 1.0, 1.0]), 0.75);
        assert_eq!(share_within([0.0, 2.0, 0.0]), 1.0);
        // A third of one side, half of the other.
        assert!((share_within([-2.0, 1.0, -1.0]) - 1.0 / 6.0).abs() < 1e-15);
    }
}
