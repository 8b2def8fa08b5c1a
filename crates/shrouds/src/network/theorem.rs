//! Theorem 1 of the paper as a check.

use crate::network::Network;
use crate::surface::Surface;
use crate::volume::Border;

/// What a count over the network found; see [`Network::check`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TheoremReport {
    /// Number of vertices.
    pub vertices: usize,
    /// Vertices on curves of both families that contain their grid edge.
    pub on_two_curves: usize,
    /// Vertices with four neighbours.
    pub valence_four: usize,
    /// Vertices with a neighbour missing although the lattice face that would hold the segment
    /// exists. Always 0.
    pub missing: usize,
    /// Neighbours that do not name the vertex in return, on the same curve. Always 0.
    pub asymmetric: usize,
    /// Neighbours whose grid edge does not lie in the plane of the curve. Always 0.
    pub off_plane: usize,
}

impl TheoremReport {
    /// Whether Theorem 1 holds: every vertex is on exactly two curves, has valence four except where
    /// the volume ends, and the curves are planar and consistent.
    pub fn holds(&self) -> bool {
        self.on_two_curves == self.vertices && self.missing + self.asymmetric + self.off_plane == 0
    }
}

impl Network {
    /// Counts how the network keeps Theorem 1 on the surface it was traced from.
    ///
    /// Every vertex lies on one curve of each of two families. A grid edge along axis `d` has curves
    /// normal to the other two axes only, so any two of the three families together hold every
    /// vertex: the three unions of equation 8.
    pub fn check(&self, surface: &Surface) -> TheoremReport {
        let mut report = TheoremReport { vertices: surface.vertex_count(), ..Default::default() };
        let crossings: Vec<_> = surface.crossings().collect();
        for (v, crossing) in crossings.iter().enumerate() {
            let mut found = [0; 2];
            for slot in 0..4 {
                let (normal, across) = self.curve_axes(v as u32, slot / 2);
                let Some((u, link)) = self.neighbour(v as u32, slot) else {
                    let dims = surface.grid().dims();
                    let low = crossing.low()[across];
                    let at_border = if slot % 2 == 0 { low == 0 } else { low + 1 == dims[across] };
                    let allowed = surface.border() == Border::Open && at_border;
                    report.missing += usize::from(!allowed);
                    continue;
                };
                found[slot / 2] += 1;
                let other = crossings[u as usize];
                let in_plane =
                    other.axis() != normal && other.low()[normal] == crossing.low()[normal];
                report.off_plane += usize::from(!in_plane);
                let back = self.neighbour(u, link.back_slot(slot)).map(|(back, _)| back);
                report.asymmetric += usize::from(back != Some(v as u32));
            }
            report.on_two_curves += usize::from(found[0] > 0 && found[1] > 0);
            report.valence_four += usize::from(found == [2, 2]);
        }
        report
    }
}
