//! Stage 2 of 7, surface: in an occupancy, out crossings and patches. Integers only.
//!
//! The topology of the hole-free marching cubes surface of the volume, and so of every separating
//! surface S(δ) of the paper (section 2). A *crossing* is a grid edge with one end inside and one
//! outside; it carries exactly one vertex. In each cell the crossings are joined over the cell's
//! faces into closed loops, the *patches*. Neither depends on where on its grid edge a vertex sits.
//!
//! Uses: `grid`, `volume`.

mod cell;
mod crossing;
mod extract;
mod face_rule;
mod rows;
pub(crate) mod triangulation;

pub use cell::LoopShape;
pub use crossing::Crossing;

use crate::grid::Grid;
use crate::volume::{Border, FaceRule};

/// Crossings and patches of a volume: the topology shared by all its separating surfaces.
///
/// Vertices are numbered in scan order of their grid edge's lower end: by z, then y, then axis,
/// then x. The numbering depends on nothing else, so it is the same on any number of threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    grid: Grid,
    face_rule: FaceRule,
    border: Border,
    crossings: Vec<Crossing>,
    /// Corners of patch `p` are `corners[starts[p]..starts[p + 1]]`.
    starts: Vec<u32>,
    corners: Vec<u32>,
    shapes: Vec<u16>,
}

impl Surface {
    /// Largest number of vertices a surface can have: four patch corners a vertex are indexed by 32
    /// bits.
    pub const MAX_VERTICES: u64 = (1 << 30) - 1;

    /// The lattice the crossings refer to: that of the volume, with one more layer on all sides when
    /// the border is closed.
    pub fn grid(&self) -> &Grid {
        &self.grid
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
        self.crossings.len()
    }

    /// The crossings in vertex order.
    pub fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// Number of patches.
    pub fn patch_count(&self) -> usize {
        self.shapes.len()
    }

    /// Vertices of patch `index` in order, counter-clockwise seen from outside.
    ///
    /// # Panics
    /// When there is no such patch.
    pub fn patch(&self, index: usize) -> &[u32] {
        &self.corners[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    /// The shape of patch `index` in its cell: which diagonals are legal, and a fixed triangulation.
    ///
    /// # Panics
    /// When there is no such patch.
    pub fn patch_shape(&self, index: usize) -> &'static LoopShape {
        cell::table(self.face_rule).shape(self.shapes[index])
    }

    /// All patches in order, each with its shape.
    pub fn patches(&self) -> impl Iterator<Item = (&[u32], &'static LoopShape)> {
        let table = cell::table(self.face_rule);
        (0..self.patch_count()).map(move |p| (self.patch(p), table.shape(self.shapes[p])))
    }

    /// The fixed triangulation of all patches: the same triangles for every δ.
    pub fn fixed_triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.corners.len() - 2 * self.patch_count());
        for (patch, shape) in self.patches() {
            triangles.extend(shape.fixed_triangles(patch));
        }
        triangles
    }
}
