//! The patches in order, and their fixed triangles.

use crate::parallel;
use crate::surface::Surface;
use crate::surface::cell::{self, LoopShape};
use crate::surface::triangulation::MAX_CORNERS;

impl Surface {
    /// Calls `f` with every patch of a layer in order: its vertices, counter-clockwise seen from
    /// outside, and its shape in its cell.
    ///
    /// # Panics
    /// When there is no such layer.
    pub fn for_each_patch(&self, layer: usize, mut f: impl FnMut(&[u32], &'static LoopShape)) {
        assert!(layer < self.layer_count(), "layer {layer} of {}", self.layer_count());
        let table = cell::table(self.face_rule);
        let mut patch = [0; MAX_CORNERS];
        self.for_each_cell(layer, |corners, vertices| {
            for shape in table.loops(corners) {
                let edges = shape.edges();
                for (vertex, &edge) in patch.iter_mut().zip(edges) {
                    *vertex = vertices[usize::from(edge & 15)];
                }
                f(&patch[..edges.len()], shape);
            }
        });
    }

    /// The fixed triangulation of all patches in order: the same triangles for every δ.
    pub fn fixed_triangles(&self) -> Vec<[u32; 3]> {
        let table = cell::table(self.face_rule);
        let mut triangles = vec![[0; 3]; self.triangle_count()];
        let ends = (0..self.layer_count()).map(|layer| self.layer_triangles(layer).end);
        parallel::pieces(&mut triangles, ends, |layer, piece| {
            let mut slots = piece.iter_mut();
            self.for_each_cell(layer, |corners, vertices| {
                for (edges, slot) in table.triangles(corners).iter().zip(slots.by_ref()) {
                    *slot = edges.map(|edge| vertices[usize::from(edge & 15)]);
                }
            });
        });
        triangles
    }
}
