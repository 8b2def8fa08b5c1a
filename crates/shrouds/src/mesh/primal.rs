//! Patches cut into triangles.

use crate::mesh::{TriMesh, Triangles, misfit};
use crate::parallel;
use crate::surface::Surface;
use crate::surface::triangulation::cheapest;
use crate::vector::{Vector, add};

pub(super) fn mesh(
    surface: &Surface,
    vertices: Vec<Vector>,
    normals: Vec<Vector>,
    triangles: Triangles,
) -> TriMesh {
    let triangles = match triangles {
        Triangles::Fixed => surface.fixed_triangles(),
        Triangles::Fitted => fitted(surface, &vertices, &normals),
    };
    TriMesh { vertices, triangles, normals }
}

/// Of the legal triangulations of every patch the one whose triangles fit the mean normals of their
/// corners best. Patches that could fold or cross, those that
/// touch a cell face twice and those of cells with several, keep the fixed one.
fn fitted(surface: &Surface, vertices: &[Vector], normals: &[Vector]) -> Vec<[u32; 3]> {
    // Mirrored axes turn the patches' corners clockwise in the world.
    let sign = if surface.grid().is_mirrored() { -1.0 } else { 1.0 };
    let blocks = parallel::blocks(surface.layer_count(), 1, |layer| {
        let (mut triangles, mut local) = (Vec::new(), Vec::new());
        surface.for_each_patch(layer.start, |patch, shape| {
            if !shape.is_alone() || !shape.twins().is_empty() {
                triangles.extend(shape.fixed_triangles(patch));
                return;
            }
            let at = |corner: usize| patch[corner] as usize;
            let cost = |i: usize, k: usize, j: usize| {
                let [a, b, c] = [at(i), at(k), at(j)];
                let direction = add(add(normals[a], normals[b]), normals[c]).map(|x| sign * x);
                misfit([vertices[a], vertices[b], vertices[c]], direction)
            };
            local.clear();
            cheapest(patch.len(), |i, j| shape.diagonal_is_legal(i, j), cost, &mut local);
            triangles.extend(local.iter().map(|t| t.map(|c| patch[usize::from(c)])));
        });
        triangles
    });
    blocks.concat()
}
