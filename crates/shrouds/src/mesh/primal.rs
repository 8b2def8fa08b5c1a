//! Patches cut into triangles.

use crate::mesh::fit::Corners;
use crate::parallel;
use crate::surface::Surface;
use crate::vector::{Vector, subtract};

/// Of the triangulations of every patch the one whose triangles fit the mean normals of their corners
/// best. Patches that could fold or cross, those that touch a cell face twice and those of cells with
/// several, keep the fixed one. Oriented as the surface's patches are in index space.
pub(super) fn fitted(surface: &Surface, vertices: &[Vector], normals: &[[f32; 3]]) -> Vec<[u32; 3]> {
    // Mirrored axes turn the patches' corners clockwise in the world.
    let sign = if surface.grid().is_mirrored() { -1.0 } else { 1.0 };
    let unit = surface.grid().min_spacing().recip();
    let mut triangles = vec![[0; 3]; surface.triangle_count()];
    let ends = (0..surface.layer_count()).map(|layer| surface.layer_triangles(layer).end);
    parallel::pieces(&mut triangles, ends, |layer, piece| {
        let mut corners = Corners::default();
        let mut slots = piece.iter_mut();
        let mut push = |triangle: [u32; 3]| {
            if let Some(slot) = slots.next() {
                *slot = triangle;
            }
        };
        surface.for_each_patch(layer, |patch, shape| match *patch {
            [a, b, c] => push([a, b, c]),
            [first, ..] if shape.is_free() => {
                let origin = vertices[first as usize];
                corners.read(patch.iter().map(|&v| {
                    let position = subtract(vertices[v as usize], origin);
                    (position.map(|x| (unit * x) as f32), normals[v as usize].map(|x| sign * x))
                }));
                corners.triangulate(|a, b, c| push([patch[a], patch[b], patch[c]]));
            }
            _ => shape.fixed_triangles(patch).for_each(&mut push),
        });
    });
    triangles
}
