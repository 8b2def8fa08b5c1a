//! What each vertex has around it: two neighbours on both sides on both of its planar curves.

use shrouds::network::Network;
use shrouds::surface::{Crossing, Surface};

/// One edge length.
pub(super) const ONE: i64 = 1 << 16;

/// A neighbour, with its grid edge as seen from the vertex: `along` is the axis of the vertex' own grid
/// edge and `aside` the other axis in the plane of their curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    pub(super) vertex: u32,
    /// From the low end of the vertex' grid edge to that of the neighbour's.
    along: i8,
    aside: i8,
    /// Whether its grid edge runs along the same axis.
    pub(super) parallel: bool,
    pub(super) exists: bool,
}

const NONE: Link = Link { vertex: 0, along: 0, aside: 0, parallel: false, exists: false };

impl Link {
    /// Where it is from the low end of the vertex' grid edge, along and aside.
    #[inline(always)]
    pub(super) fn place(self, places: &[i32]) -> (i64, i64) {
        let x = i64::from(places[self.vertex as usize]);
        let (along, aside) = (i64::from(self.along) * ONE, i64::from(self.aside) * ONE);
        if self.parallel { (along + x, aside) } else { (along, aside + x) }
    }

    /// Whether its grid edge is beside that of the vertex, between the same two lattice planes.
    pub(super) fn is_level(self) -> bool {
        self.exists && self.parallel && self.along == 0
    }

    /// Where its grid edge lies to that of the vertex: 1 beside it, 0 at its low end, 2 at its high one.
    pub(super) fn kind(self) -> usize {
        if self.parallel { 1 } else { 2 * usize::from(self.along > 0) }
    }
}

/// The neighbours of a vertex: on both curves the second and the first on the low side, then the first
/// and the second on the high side.
pub(super) type Stencil = [[Link; 4]; 2];

/// The stencils of all vertices.
pub(super) fn stencils(surface: &Surface) -> (Vec<Crossing>, Vec<Stencil>) {
    let crossings: Vec<_> = surface.crossings().collect();
    let network = Network::trace(surface);
    let mut stencils = vec![[[NONE; 4]; 2]; crossings.len()];
    for curve in network.curves() {
        let count = curve.vertices.len();
        let at = |n: isize| {
            let inside = (0..count as isize).contains(&n);
            // A curve of fewer than four vertices does not exist; a place alone has no others.
            (inside || curve.closed).then(|| curve.vertices[n.rem_euclid(count as isize) as usize])
        };
        for n in 0..count as isize {
            let v = curve.vertices[n as usize];
            let crossing = crossings[v as usize];
            let c = usize::from((crossing.axis() + 1) % 3 != curve.axis);
            let link = |n: isize| {
                at(n).map_or(NONE, |u| link(crossing, crossings[u as usize], curve.axis, u))
            };
            let mut links = [link(n - 2), link(n - 1), link(n + 1), link(n + 2)];
            // The low side first, whichever way the curve runs.
            if is_high(links[1]) || links[2].exists && !is_high(links[2]) {
                links.reverse();
            }
            stencils[v as usize][c] = links;
        }
    }
    (crossings, stencils)
}

fn is_high(first: Link) -> bool {
    first.exists && if first.parallel { first.aside > 0 } else { first.aside == 0 }
}

fn link(from: Crossing, to: Crossing, normal: usize, vertex: u32) -> Link {
    let along = from.axis();
    let aside = 3 - along - normal;
    let step = |d: usize| (to.low()[d] as i64 - from.low()[d] as i64) as i8;
    let parallel = to.axis() == along;
    Link { vertex, along: step(along), aside: step(aside), parallel, exists: true }
}
