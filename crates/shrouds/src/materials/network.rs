//! The planar curves of all interfaces, which begin and end at junctions.

use crate::materials::interfaces::Interfaces;
use crate::network::{Links, Network, Step};
use crate::parallel;

/// The curves through all crossings, as those of a binary volume, and what is at their ends.
///
/// The unknowns are those of the crossings, then two for each junction.
#[derive(Debug)]
pub(super) struct Curves {
    /// The curves through crossings alone. The unknowns of junctions lie on none.
    pub(super) network: Network,
    /// The first and the last end of every curve that has ends, curve by curve.
    pub(super) ends: Vec<[End; 2]>,
    pub(super) crossings: usize,
    pub(super) junctions: usize,
}

/// An end of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct End {
    /// The first or last place of the curve.
    pub(super) place: u32,
    /// Whether it is the last, from where the curve leads to the junction.
    is_last: bool,
    pub(super) junction: u32,
    /// From where the grid edge of the place starts to the lowest corner of the junction's face, in the
    /// plane.
    pub(super) shift: [i32; 2],
}

/// Where the edges of a face start, from its lowest corner. Those with odd numbers run along the second
/// axis.
const STARTS: [[i32; 2]; 4] = [[0, 0], [1, 0], [0, 1], [0, 0]];

impl Curves {
    pub(super) fn trace(interfaces: &Interfaces) -> Self {
        let crossings = interfaces.crossings().len();
        let junctions = interfaces.junctions().len();
        let families = parallel::blocks(3, 1, |family| Family::trace(interfaces, family.start));
        let (links, ends): (Vec<_>, Vec<_>) =
            families.into_iter().map(|family| (family.links, family.ends)).unzip();
        let network = Network::of_links(links, 2 * junctions);
        let mut found = Vec::new();
        for (normal, ends) in ends.into_iter().enumerate() {
            found.extend(ends.into_iter().map(|end| {
                let axis = interfaces.crossings()[end.place as usize].axis();
                let place = network.place(end.place, (normal + 2 - axis) % 3) as u32;
                End { place, ..end }
            }));
        }
        found.sort_unstable();
        let ends = found.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        Self { network, ends, crossings, junctions }
    }

    /// The first unknown of a junction.
    #[inline]
    pub(super) fn unknown(&self, junction: u32) -> usize {
        self.crossings + 2 * junction as usize
    }

    pub(super) fn unknown_count(&self) -> usize {
        self.crossings + 2 * self.junctions
    }

    /// Puts each junction to the mean of the crossings around it.
    pub(super) fn place_junctions(&self, bounds: [f64; 2], x: &mut [f32]) {
        let mut sums = vec![[0.0; 3]; self.junctions];
        for end in self.ends.as_flattened() {
            let place = end.place as usize;
            let own = usize::from(self.network.steps()[place].runs_second());
            let sum = &mut sums[end.junction as usize];
            for (axis, shift) in end.shift.into_iter().enumerate() {
                sum[axis] -= shift as f32;
            }
            sum[own] += x[self.network.vertices()[place] as usize];
            sum[2] += 1.0;
        }
        let [low, high] = bounds.map(|bound| bound as f32);
        for (place, [u, v, count]) in x[self.crossings..].chunks_exact_mut(2).zip(sums) {
            place.copy_from_slice(&[u, v].map(|sum| (sum / count).clamp(low, high)));
        }
    }
}

/// What follows what in the planes normal to one axis.
struct Family {
    links: Links,
    /// With the numbers of crossings in place of places.
    ends: Vec<End>,
}

impl Family {
    /// Curves run with the first label of their pair on the right, seen from the high side.
    fn trace(interfaces: &Interfaces, normal: usize) -> Self {
        let crossings = interfaces.crossings();
        let mut family = Self { links: Links::none(crossings, normal), ends: Vec::new() };
        interfaces.for_each_face(normal, |low, crossed| {
            let crossing = |edge| interfaces.face_crossing(normal, low, edge);
            // Corner `edge + 1` is on the right of what enters the face by the edge; of edges 0 and 1 it
            // is the high end.
            let enters =
                |edge: usize| crossings[crossing(edge) as usize].inside_low() == (edge >= 2);
            let of_face = (0..4).filter(|edge| crossed >> edge & 1 == 1);
            if crossed.count_ones() == 2 {
                let [a, b] = [crossed.trailing_zeros(), 7 - crossed.leading_zeros()];
                let [a, b] = [a as usize, b as usize];
                let [from, to] = if enters(a) { [a, b] } else { [b, a] };
                family.join(normal, [from, to], [from, to].map(crossing));
            } else if let Some(junction) = interfaces.junction_on(normal, low) {
                family.ends.extend(of_face.map(|edge| End {
                    place: crossing(edge),
                    is_last: enters(edge),
                    junction,
                    shift: STARTS[edge].map(|shift| -shift),
                }));
            } else {
                for segment in interfaces.segments_on(normal, low) {
                    family.join(normal, segment.ends, segment.ends.map(crossing));
                }
            }
        });
        family
    }

    fn join(&mut self, normal: usize, [from, to]: [usize; 2], crossings: [u32; 2]) {
        let shift = [0, 1].map(|axis| STARTS[to][axis] - STARTS[from][axis]);
        self.links.join(crossings, Step::new(normal, from % 2 == 1, shift));
    }
}
