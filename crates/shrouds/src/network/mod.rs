//! Stage 3 of 7, network: in a surface, out the four neighbours of every vertex on its planar curves.
//!
//! The 4\*-network of the paper (Theorem 1): every lattice plane cuts a separating surface in planar
//! polygons, and every vertex lies on exactly two of them, one in each of the two lattice planes that
//! contain its grid edge. So a vertex has four neighbours, fewer only where an open border ends a
//! curve.
//!
//! Uses: `volume` (its conventions), `surface`.

mod theorem;
mod walk;

pub use theorem::TheoremReport;
pub use walk::Curve;

use crate::surface::{Crossing, Surface};

/// Marks an absent neighbour.
const NONE: u32 = u32::MAX;

/// How a neighbour's grid edge lies to one's own, within their common lattice plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// It runs parallel, one step to the side.
    Parallel,
    /// It runs across, at the low end of one's own.
    AcrossLow,
    /// It runs across, at the high end of one's own.
    AcrossHigh,
}

impl Link {
    /// The slot of a vertex as seen from the neighbour in its slot `slot`: in the same plane the
    /// neighbour's own slots are named the other way round.
    pub fn back_slot(self, slot: usize) -> usize {
        match self {
            Self::Parallel => slot ^ 1,
            Self::AcrossLow => 2 * (1 - slot / 2) + 1,
            Self::AcrossHigh => 2 * (1 - slot / 2),
        }
    }
}

/// The four neighbours of every vertex.
///
/// A vertex whose grid edge runs along axis `d` has two curves, `c = 0` and `c = 1`. Curve `c` lies
/// in the lattice plane normal to axis `d + 1 + c`; in that plane the other axis is `e = d + 2 − c`
/// (all modulo 3). Slot `2·c` holds the neighbour on the `−e` side of the grid edge, slot `2·c + 1`
/// the one on the `+e` side.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    neighbours: Vec<[u32; 4]>,
    /// Two bits a slot: the link's number, 3 for none.
    links: Vec<u8>,
    axes: Vec<u8>,
}

impl Network {
    /// Reads the network off the segments of the planar curves on the lattice faces.
    pub fn trace(surface: &Surface) -> Self {
        let crossings: Vec<Crossing> = surface.crossings().collect();
        let mut network = Self {
            neighbours: vec![[NONE; 4]; crossings.len()],
            links: vec![u8::MAX; crossings.len()],
            axes: crossings.iter().map(|c| c.axis() as u8).collect(),
        };
        for (normal, k) in (0..3).flat_map(|n| (0..surface.slice_count()).map(move |k| (n, k))) {
            surface.for_each_segment(normal, k, |a, b| {
                network.connect(&crossings, a, b);
                network.connect(&crossings, b, a);
            });
        }
        network
    }

    fn connect(&mut self, crossings: &[Crossing], from: u32, to: u32) {
        let (slot, link) = slot_and_link(crossings[from as usize], crossings[to as usize]);
        self.neighbours[from as usize][slot] = to;
        let links = &mut self.links[from as usize];
        *links = *links & !(3 << (2 * slot)) | (link as u8) << (2 * slot);
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.neighbours.len()
    }

    /// The axis that the grid edge of vertex `v` runs along.
    pub fn axis(&self, v: u32) -> usize {
        usize::from(self.axes[v as usize])
    }

    /// The axes normal to the plane of curve `c` (0 or 1) of vertex `v`, and across its grid edge
    /// within that plane.
    pub fn curve_axes(&self, v: u32, c: usize) -> (usize, usize) {
        const AXES: [[(usize, usize); 2]; 3] =
            [[(1, 2), (2, 1)], [(2, 0), (0, 2)], [(0, 1), (1, 0)]];
        AXES[self.axis(v)][c]
    }

    /// The neighbour of vertex `v` in a slot, with the way its grid edge lies to that of `v`.
    pub fn neighbour(&self, v: u32, slot: usize) -> Option<(u32, Link)> {
        let link = match self.links[v as usize] >> (2 * slot) & 3 {
            0 => Link::Parallel,
            1 => Link::AcrossLow,
            2 => Link::AcrossHigh,
            _ => return None,
        };
        Some((self.neighbours[v as usize][slot], link))
    }

    /// The curve (0 or 1) of vertex `v` that lies in a plane normal to `axis`, if any.
    pub fn curve_normal_to(&self, v: u32, axis: usize) -> Option<usize> {
        (0..2).find(|&c| self.curve_axes(v, c).0 == axis)
    }

    /// The neighbours of vertex `v` on its curve normal to `axis`, `−` side first.
    pub fn on_plane(&self, v: u32, axis: usize) -> [Option<u32>; 2] {
        let Some(c) = self.curve_normal_to(v, axis) else { return [None; 2] };
        [0, 1].map(|side| self.neighbour(v, 2 * c + side).map(|(u, _)| u))
    }

    /// The vertex two steps from `v` along the curve of a slot.
    pub fn second_neighbour(&self, v: u32, slot: usize) -> Option<u32> {
        let (u, link) = self.neighbour(v, slot)?;
        self.neighbour(u, link.back_slot(slot) ^ 1).map(|(far, _)| far)
    }
}

/// The slot of `from` that leads to `to`, two crossings on a common cell face.
fn slot_and_link(from: Crossing, to: Crossing) -> (usize, Link) {
    let (d, f) = (from.axis(), to.axis());
    let (p, q) = (from.low(), to.low());
    let (e, high_side, link) = if d == f {
        let e = if p[(d + 1) % 3] != q[(d + 1) % 3] { (d + 1) % 3 } else { (d + 2) % 3 };
        (e, q[e] > p[e], Link::Parallel)
    } else {
        // The neighbour starts at our line or ends there.
        let link = if q[d] == p[d] { Link::AcrossLow } else { Link::AcrossHigh };
        (f, q[f] == p[f], link)
    };
    let c = usize::from(e == (d + 1) % 3);
    (2 * c + usize::from(high_side), link)
}
