//! How far a change reaches.

use crate::live::Ranges;
use crate::surface::Surface;

/// Lattice points around those that changed whose vertices are solved again: the most that have few enough
/// vertices for an update to be done before the next picture.
const MARGINS: [usize; 4] = [16, 12, 8, 6];
const FEW: usize = 1600;
/// The largest part of the vertices that is solved as a box of its own.
const LARGEST_PART: f64 = 0.5;
/// How near a vertex is to a face of the box to belong to the rim there: what the energy of the vertices beyond
/// depends on.
const RIM: usize = 3;

/// A box around a change that is solved anew.
pub(super) struct Reach {
    /// The lattice points where the grid edges of its vertices start.
    pub(super) own: Ranges,
}

impl Reach {
    /// The box around some lattice points; none where it would be most of the surface, or there is none yet.
    pub(super) fn around(surface: &Surface, points: &Ranges) -> Option<Self> {
        let boxes = MARGINS.map(|margin| surface.widened(points, [margin; 2]));
        let [.., smallest] = &boxes;
        let own = boxes.iter().find(|own| surface.vertices_within(own) <= FEW).unwrap_or(smallest);
        let most = LARGEST_PART * surface.vertex_count() as f64;
        ((surface.vertices_within(own) as f64) < most).then(|| Self { own: own.clone() })
    }

    /// The box around vertices whose flatness changed.
    pub(super) fn with_margin(surface: &Surface, points: &Ranges) -> Self {
        Self { own: surface.widened(points, [MARGINS[MARGINS.len() - 1]; 2]) }
    }

    /// The largest move near the faces of the box, of those that begin at these lattice points.
    pub(super) fn rim(&self, moves: impl Iterator<Item = ([usize; 3], f64)>) -> f64 {
        let is_near = |low: &[usize; 3]| {
            let near =
                |d: usize| low[d] < self.own[d].start + RIM || low[d] + RIM >= self.own[d].end;
            (0..3).any(near)
        };
        moves.filter(|(low, _)| is_near(low)).fold(0.0, |most, (_, moved)| moved.max(most))
    }

    /// The cells in which it changes places, normals or triangles.
    pub(super) fn cells(&self, surface: &Surface) -> Ranges {
        // A vertex has its normal from its neighbours, which are up to a cell away, and a patch from
        // its vertices.
        let points = surface.widened(&self.own, [3; 2]);
        let dims = surface.grid().dims();
        [0, 1, 2].map(|d| points[d].start..points[d].end.min(dims[d] - 1))
    }
}
