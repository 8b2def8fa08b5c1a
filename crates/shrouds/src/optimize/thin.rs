//! Parts one voxel thin, as the voxels tell them.

use crate::parallel;
use crate::surface::{Part, Surface};
use crate::volume::Occupancy;

/// The planes across an axis in which a thin point may have at most one like it nearby, as steps from its own:
/// with the next planes it is on a rod, in a chain or by itself; without them also on top of a round body.
const ON_RODS: &[isize] = &[0, -1, 1];
const ANYWHERE: &[isize] = &[0];

/// The lattice points of a surface, and those around it if it is a piece.
#[derive(Clone, Copy)]
pub(crate) struct Voxels<'a> {
    pub(crate) volume: &'a Occupancy,
    /// Where in the volume the surface begins.
    pub(crate) first: [usize; 3],
}

impl<'a> Voxels<'a> {
    pub(super) fn of(surface: &'a Surface) -> Self {
        Self { volume: surface.volume(), first: [0; 3] }
    }

    /// [`of_rods`] at the vertices of a part of the surface.
    pub(super) fn thinness(&self, part: &Part) -> Vec<f32> {
        let first = [0, 1, 2].map(|d| self.first[d] + part.first[d]);
        Voxels { first, ..*self }.thinness_of(&part.piece, ON_RODS)
    }

    fn thinness_of(&self, surface: &Surface, planes: &[isize]) -> Vec<f32> {
        let mut thinness = vec![0.0; surface.vertex_count()];
        let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
        parallel::pieces(&mut thinness, ends, |k, thinness| {
            for (thinness, crossing) in thinness.iter_mut().zip(surface.slice_crossings(k)) {
                let low = [0, 1, 2].map(|d| self.first[d] + crossing.low()[d]);
                let (dims, side) = (self.volume.grid().dims(), |point| self.volume.get(point));
                *thinness = f32::from(is_thin(dims, low, crossing.axis(), planes, side));
            }
        });
        thinness
    }
}

/// 1 at the vertices on rods and chains one voxel thick, inside or outside, and 0 elsewhere.
pub(super) fn of_rods(surface: &Surface) -> Vec<f32> {
    Voxels::of(surface).thinness_of(surface, ON_RODS)
}

/// 1 at all vertices on curves around a single lattice point, inside or outside, and 0 elsewhere.
pub(super) fn of_single_points(surface: &Surface) -> Vec<f32> {
    Voxels::of(surface).thinness_of(surface, ANYWHERE)
}

/// Whether the grid edge from `low` along `axis` leaves a rod or a chain one voxel thick; `side` is the side or the label
/// of a point.
pub(crate) fn is_on_a_rod<T: PartialEq>(
    dims: [usize; 3],
    low: [usize; 3],
    axis: usize,
    side: impl Fn([usize; 3]) -> T,
) -> bool {
    is_thin(dims, low, axis, ON_RODS, side)
}

fn is_thin<T: PartialEq>(
    dims: [usize; 3],
    low: [usize; 3],
    axis: usize,
    planes: &[isize],
    side: impl Fn([usize; 3]) -> T,
) -> bool {
    let mut high = low;
    high[axis] += 1;
    // All planes have this axis, and few parts end after one point.
    let mut below = low;
    below[axis] = low[axis].saturating_sub(1);
    let mut above = high;
    above[axis] = (high[axis] + 1).min(dims[axis] - 1);
    [(low, below), (high, above)].into_iter().any(|(end, behind)| {
        let own = side(end);
        let is_other = |point| side(point) != own;
        is_other(behind)
            && [1, 2]
                .into_iter()
                .any(|shift| is_alone(dims, end, (axis + shift) % 3, planes, is_other))
    })
}

/// Whether at most one point is like this one among the nine around it in each of some planes across an axis,
/// so many steps away. What lies beyond the border goes on there.
fn is_alone(
    dims: [usize; 3],
    point: [usize; 3],
    along: usize,
    planes: &[isize],
    is_other: impl Fn([usize; 3]) -> bool,
) -> bool {
    let [u, v] = [1, 2].map(|shift| (along + shift) % 3);
    let near = |d: usize, step| point[d].saturating_add_signed(step).min(dims[d] - 1);
    planes.iter().all(|&step| {
        let steps = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [a, b]));
        let alike = steps.filter(|&[a, b]| {
            let mut there = [0; 3];
            (there[along], there[u], there[v]) = (near(along, step), near(u, a), near(v, b));
            !is_other(there)
        });
        alike.take(2).count() <= 1
    })
}
