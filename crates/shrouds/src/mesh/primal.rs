//! Patches cut into triangles.

use crate::mesh::fit::{Fit, Polygon};
use crate::parallel;
use crate::surface::Surface;
use crate::vector::{Vector, subtract};

/// Of the triangulations of every patch the one whose triangles fit the mean normals of their corners
/// best. Patches that could fold or cross, those that touch a cell face twice and those of cells with
/// several, keep the fixed one. Oriented as the surface's patches are in index space.
pub(super) fn fitted(
    surface: &Surface,
    vertices: &[Vector],
    normals: &[[f32; 3]],
) -> Vec<[u32; 3]> {
    // Mirrored axes turn the patches' corners clockwise in the world.
    let sign = if surface.grid().is_mirrored() { -1.0 } else { 1.0 };
    let unit = surface.grid().min_spacing().recip();
    let mut triangles = vec![[0; 3]; surface.triangle_count()];
    let ends = (0..surface.layer_count()).map(|layer| surface.layer_triangles(layer).end);
    parallel::pieces(&mut triangles, ends, |layer, piece| {
        let mut fit = Fit::default();
        let mut at = 0;
        surface.for_each_patch(layer, |patch, shape| {
            match *patch {
                [a, b, c] => piece[at] = [a, b, c],
                [first, ..] if shape.is_free() => {
                    let origin = vertices[first as usize];
                    let patch = Patch { patch, vertices, normals, origin, unit, sign };
                    fit.push(&patch, at, piece);
                }
                _ => {
                    for (slot, triangle) in piece[at..].iter_mut().zip(shape.fixed_triangles(patch))
                    {
                        *slot = triangle;
                    }
                }
            }
            at += patch.len() - 2;
        });
        fit.finish(piece);
    });
    triangles
}

/// A patch with its places relative to its first corner.
struct Patch<'a> {
    patch: &'a [u32],
    vertices: &'a [Vector],
    normals: &'a [[f32; 3]],
    origin: Vector,
    unit: f64,
    sign: f32,
}

impl Polygon for Patch<'_> {
    #[inline(always)]
    fn vertices(&self) -> &[u32] {
        self.patch
    }

    #[inline(always)]
    fn corner(&self, n: usize) -> ([f32; 3], [f32; 3]) {
        let v = self.patch[n] as usize;
        let place = subtract(self.vertices[v], self.origin).map(|x| (self.unit * x) as f32);
        (place, self.normals[v].map(|x| self.sign * x))
    }
}
