//! Stage 3 of 7, network: in a surface, out all planar curves in order.
//!
//! The 4\*-network of the paper (Theorem 1): every lattice plane cuts a separating surface in planar
//! polygons, and every vertex lies on exactly two of them, one in each of the two lattice planes that
//! contain its grid edge. So a vertex has four neighbours, fewer only where an open border ends a
//! curve. In an image, a volume of one slice, the curve across the slice is the vertex alone.
//!
//! The curves are stored one after another, vertex by vertex: energies are sums along curves, and
//! neighbours on a curve are neighbours in memory.
//!
//! Uses: `volume` (its conventions), `surface`.

mod step;
mod theorem;
mod trace;

pub(crate) use step::Step;
pub use theorem::TheoremReport;
pub(crate) use trace::Links;

use std::ops::Range;

use crate::gather::Indices;
use step::Side;

/// How many places before and after every curve repeat its other end.
pub(crate) const REPEATED: usize = 3;

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

/// One planar polygon of the 4\*-network.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The axis normal to the lattice plane of the curve.
    pub axis: usize,
    /// Its vertices in order.
    pub vertices: Vec<u32>,
    /// Whether the last vertex is joined to the first; only an open border leaves a curve open.
    pub closed: bool,
}

/// All planar curves, and so the four neighbours of every vertex.
///
/// A vertex whose grid edge runs along axis `d` has two curves, `c = 0` and `c = 1`. Curve `c` lies
/// in the lattice plane normal to axis `d + 1 + c`; in that plane the other axis is `e = d + 2 − c`
/// (all modulo 3). Slot `2·c` holds the neighbour on the `−e` side of the grid edge, slot `2·c + 1`
/// the one on the `+e` side.
///
/// A vertex on one of its curves is a *place*. The places of a curve are numbered one after another;
/// before and after them its other end is repeated, so that loops along curves run straight through.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// The vertex at every place.
    vertices: Indices<1>,
    /// How its curve goes on from every place.
    steps: Vec<Step>,
    /// The places of every vertex on its curves 0 and 1.
    places: Indices<2>,
    /// First place of every curve, and of one more after the last.
    starts: Vec<u32>,
}

impl Network {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.places.groups().len()
    }

    /// The axis that the grid edge of vertex `v` runs along.
    pub fn axis(&self, v: u32) -> usize {
        self.steps[self.place(v, 0)].axis()
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
        let place = self.place(v, slot / 2);
        let side = if slot % 2 == 1 { Side::High } else { Side::Low };
        let (here, before) = (self.steps[place], self.steps[place - 1]);
        let next = || here.look(self.steps[place + 1].runs_second());
        let previous = || before.look_back(here.runs_second());
        match (next(), previous()) {
            (Some((s, link)), _) if s == side => Some((self.vertices()[place + 1], link)),
            (_, Some((s, link))) if s == side => Some((self.vertices()[place - 1], link)),
            _ => None,
        }
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

    /// All planar curves: those normal to x first, then y, then z, each family in the order of the
    /// curves' smallest vertices; open curves, which start at an end, before closed ones.
    pub fn curves(&self) -> impl Iterator<Item = Curve> {
        (0..self.starts.len().saturating_sub(1)).map(|n| {
            let places = self.curve_places(n);
            Curve {
                axis: self.steps[places.start].normal(),
                closed: self.steps[places.end - 1].is_linked(),
                vertices: self.vertices()[places].to_vec(),
            }
        })
    }

    /// The places of curve `n`.
    fn curve_places(&self, n: usize) -> Range<usize> {
        self.starts[n] as usize..self.starts[n + 1] as usize - 2 * REPEATED
    }

    /// The parts of a range of places that belong to curves and do not repeat others.
    pub(crate) fn curve_parts(&self, range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let first = self.starts.partition_point(|&start| start as usize <= range.start);
        (first.saturating_sub(1)..self.starts.len().saturating_sub(1))
            .map(|n| self.curve_places(n))
            .take_while(move |places| places.start < range.end)
            .map(move |places| places.start.max(range.start)..places.end.min(range.end))
            .filter(|part| !part.is_empty())
    }

    /// The place of vertex `v` on its curve `c`.
    #[inline]
    pub(crate) fn place(&self, v: u32, c: usize) -> usize {
        self.places()[v as usize][c] as usize
    }

    /// The places of all vertices on their curves 0 and 1.
    pub(crate) fn places(&self) -> &[[u32; 2]] {
        self.places.groups()
    }

    /// The vertices at all places.
    pub(crate) fn vertices(&self) -> &[u32] {
        self.vertices.groups().as_flattened()
    }

    /// Of some numbers, one per vertex, those at a range of places.
    #[inline(always)]
    pub(crate) fn at_places<T: Copy>(
        &self,
        places: Range<usize>,
        numbers: &[T],
    ) -> impl ExactSizeIterator<Item = T> {
        self.vertices.read(places, numbers).map(|[number]| number)
    }

    /// Of some numbers, one per place, those at both places of a range of vertices.
    #[inline(always)]
    pub(crate) fn at_vertices<T: Copy>(
        &self,
        vertices: Range<usize>,
        numbers: &[T],
    ) -> impl ExactSizeIterator<Item = [T; 2]> {
        self.places.read(vertices, numbers)
    }

    /// How the curves go on from all places.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.steps
    }
}
