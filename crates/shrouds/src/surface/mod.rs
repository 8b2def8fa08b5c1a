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

/// A piece of a planar curve on one lattice face, from one grid edge of the face to another.
pub(crate) struct Segment {
    /// The vertices on both.
    pub(crate) vertices: [u32; 2],
    /// Whether each of the two runs along the second axis of the plane: the second after its normal.
    pub(crate) runs_second: [bool; 2],
    /// From the start of the first to that of the second, along the first and second axis.
    pub(crate) shift: [i32; 2],
}

impl Surface {
    pub(crate) fn slice_count(&self) -> usize {
        self.grid.dims()[2]
    }
    pub(crate) fn for_each_segment(&self, normal: usize, k: usize, mut f: impl FnMut(Segment)) {
        if k > 0 { return; }
        let c = self.crossings();
        for (patch, _) in self.patches() {
            for (n, &x) in patch.iter().enumerate() {
                let y = patch[(n + 1) % patch.len()];
                for (a, b) in [(x, y), (y, x)] {
                    let (p, q) = (c[a as usize], c[b as usize]);
                    // the face normal: axis of neither with equal coordinate
                    let nn = (0..3).find(|&t| t != p.axis() && t != q.axis() && p.low()[t] == q.low()[t] && (p.axis() != q.axis() || { let o = 3 - t - p.axis(); p.low()[o] != q.low()[o] })).unwrap();
                    if nn != normal { continue; }
                    let (u, v) = ((nn + 1) % 3, (nn + 2) % 3);
                    let second = [p.axis() == v, q.axis() == v];
                    let shift = [u, v].map(|t| q.low()[t] as i32 - p.low()[t] as i32);
                    let e = if second[0] { 0 } else { 1 };
                    let across = shift[e];
                    let high = if second[0] == second[1] { across > 0 } else { across == 0 };
                    let forward_high = if second[0] { !p.inside_low() } else { p.inside_low() };
                    if high == forward_high { f(Segment { vertices: [a, b], runs_second: second, shift }); }
                }
            }
        }
    }
}
