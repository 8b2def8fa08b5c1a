//! Stage 2 of 7, surface: in an occupancy, out crossings and patches. Integers only.
//!
//! The topology of the hole-free marching cubes surface of the volume, and so of every separating
//! surface S(δ) of the paper (section 2). A *crossing* is a grid edge with one end inside and one
//! outside; it carries exactly one vertex. In each cell the crossings are joined over the cell's
//! faces into closed loops, the *patches*. Neither depends on where on its grid edge a vertex sits.
//!
//! Nothing is stored per vertex or patch. The numbers of a row's first vertices are; all others
//! follow by counting bits, sixty-four grid edges at a time, while a walk passes.
//!
//! Uses: `grid`, `volume`.

mod bits;
mod cell;
mod cells;
mod components;
mod crossing;
mod crossings;
mod extract;
mod face_rule;
mod faces;
mod isosurface;
mod patches;
mod rows;
pub(crate) mod triangulation;

#[cfg(test)]
mod tests;

pub use cell::LoopShape;
pub use components::Components;
pub use crossing::Crossing;
pub(crate) use rows::Region;

use std::ops::Range;
use std::sync::OnceLock;

use crate::grid::Grid;
use crate::volume::{Border, FaceRule, Occupancy};

/// Crossings and patches of a volume: the topology shared by all its separating surfaces.
///
/// Vertices are numbered in scan order of their grid edge's lower end: by z, then y, then axis,
/// then x. Patches are numbered in scan order of their cells: by z, then y, then x. The numbers
/// depend on nothing else, so they are the same on any number of threads.
///
/// A *slice* is a lattice plane normal to z; a *layer* holds the cells between two slices.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The lattice points, with a layer of outside ones around them when the border is closed.
    volume: Occupancy,
    face_rule: FaceRule,
    border: Border,
    /// Number of the first vertex of every lattice row on grid edges along each axis, and the number
    /// of all vertices at the end.
    rows: Vec<[u32; 3]>,
    /// Numbers of the first patch and the first fixed triangle of every layer, and those of all at
    /// the end; counted when they are first asked for.
    layers: OnceLock<Vec<(u32, usize)>>,
}

impl Surface {
    /// Largest number of vertices a surface can have: four patch corners a vertex are indexed by 32
    /// bits.
    pub const MAX_VERTICES: u64 = (1 << 30) - 1;

    /// The lattice the crossings refer to: that of the volume, with one more layer on all sides when
    /// the border is closed.
    pub fn grid(&self) -> &Grid {
        self.volume.grid()
    }

    /// How ambiguous faces were settled.
    pub fn face_rule(&self) -> FaceRule {
        self.face_rule
    }

    /// What was taken to lie beyond the volume.
    pub fn border(&self) -> Border {
        self.border
    }

    /// Number of vertices: one per crossing.
    pub fn vertex_count(&self) -> usize {
        self.first_vertex(self.rows.len() - 1) as usize
    }

    /// Number of patches.
    pub fn patch_count(&self) -> usize {
        self.layers()[self.layer_count()].0 as usize
    }

    /// Number of slices.
    pub fn slice_count(&self) -> usize {
        self.grid().dims()[2]
    }

    /// Number of layers: layer `k` lies between slices `k` and `k + 1`.
    pub fn layer_count(&self) -> usize {
        self.slice_count() - 1
    }

    /// Vertices whose grid edges start in slice `k`.
    ///
    /// # Panics
    /// When there is no such slice.
    pub fn slice_vertices(&self, k: usize) -> Range<u32> {
        let rows = self.grid().dims()[1];
        self.first_vertex(k * rows)..self.first_vertex((k + 1) * rows)
    }

    /// Numbers of the patches of a layer.
    ///
    /// # Panics
    /// When there is no such layer.
    pub fn layer_patches(&self, layer: usize) -> Range<u32> {
        self.layers()[layer].0..self.layers()[layer + 1].0
    }

    fn layers(&self) -> &[(u32, usize)] {
        self.layers.get_or_init(|| extract::count_layers(&self.volume, self.face_rule))
    }

    /// The lattice points the surface separates, those of a closed border included.
    pub(crate) fn volume(&self) -> &Occupancy {
        &self.volume
    }

    /// Number of triangles that the patches are cut into, in whatever way.
    pub(crate) fn triangle_count(&self) -> usize {
        self.layers()[self.layer_count()].1
    }

    /// Numbers of the triangles that the patches of a layer are cut into.
    pub(crate) fn layer_triangles(&self, layer: usize) -> Range<usize> {
        self.layers()[layer].1..self.layers()[layer + 1].1
    }

    #[inline]
    fn first_vertex(&self, row: usize) -> u32 {
        self.rows[row][0]
    }
}
