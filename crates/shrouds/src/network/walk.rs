//! The planar curves as polygons.

use crate::network::Network;

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

impl Network {
    /// All planar curves: those normal to x first, then y, then z, each family in the order of the
    /// curves' smallest vertices (of their smaller ends, for open curves, which come first).
    pub fn curves(&self) -> Vec<Curve> {
        let mut curves = Vec::new();
        for axis in 0..3 {
            let mut seen = vec![false; self.vertex_count()];
            let starts = |open: bool| {
                (0..self.vertex_count() as u32).filter(move |&v| {
                    self.curve_normal_to(v, axis).is_some()
                        && (!open || self.on_plane(v, axis).contains(&None))
                })
            };
            for start in starts(true).chain(starts(false)) {
                if !seen[start as usize] {
                    curves.push(self.walk(start, axis, &mut seen));
                }
            }
        }
        curves
    }

    fn walk(&self, start: u32, axis: usize, seen: &mut [bool]) -> Curve {
        let mut vertices = vec![start];
        seen[start as usize] = true;
        // From an end the only way is its one neighbour; elsewhere start on the − side.
        let c = self.curve_normal_to(start, axis).unwrap_or(0);
        let mut slot = if self.neighbour(start, 2 * c).is_some() { 2 * c } else { 2 * c + 1 };
        let mut here = start;
        while let Some((next, link)) = self.neighbour(here, slot) {
            if next == start {
                return Curve { axis, vertices, closed: true };
            }
            seen[next as usize] = true;
            vertices.push(next);
            slot = link.back_slot(slot) ^ 1;
            here = next;
        }
        Curve { axis, vertices, closed: false }
    }
}
