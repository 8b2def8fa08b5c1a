//! Flat faces along the grid.
//!
//! All vertices of a face along the grid lie on parallel grid edges between the same two slices, and
//! nothing in the voxels says where between them. Curves that want to be round around its borders
//! would lift the whole face by up to half a voxel; so it is held in the middle.
//!
//! On a smooth surface such a terrace may be large too, where the surface runs along a slice. But
//! there the next terrace on every side is not much smaller: on a parabola, which is at most one
//! voxel high within the terrace, by a factor of at most 4.9. The terraces of a face end at a deep
//! step, or at one with a narrow terrace behind it.

use crate::parallel;
use crate::surface::{Crossing, Surface};

/// A terrace this many times as long as the next one begins to count as a face, and does in full.
const SMOOTH: f32 = 6.0;
const FLAT: f32 = 10.0;
/// What stands for the length of the next terrace behind a deep step.
const DEEP: f32 = 1.0;
/// The shortest terrace that can be a face. A longest one need not be told apart from longer ones.
const SHORTEST: usize = 7;
const LONGEST: usize = 64;

/// How surely every vertex lies on a flat face along the grid, from 0 to 1.
pub(super) fn flatness(surface: &Surface) -> Vec<f32> {
    let mut flatness = vec![0.0; surface.vertex_count()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut flatness, ends, |k, flatness| {
        for (flatness, crossing) in flatness.iter_mut().zip(surface.slice_crossings(k)) {
            *flatness = of_crossing(surface, crossing);
        }
    });
    flatness
}

fn of_crossing(surface: &Surface, crossing: Crossing) -> f32 {
    let terrace = Terrace::of(surface, crossing);
    let [first, second] = [1, 2].map(|step| (crossing.axis() + step) % 3);
    // Two ridges may cross in one lattice point; a face is as flat around it.
    let around = [(0, 0), (-2, 0), (2, 0), (0, -2), (0, 2)];
    let mut flatness = 1.0f32;
    for (a, b) in around {
        let there = terrace.moved([(first, a), (second, b)]);
        if flatness > 0.0 && there.is_on_top(there.inside) {
            flatness = flatness.min(there.flatness(first)).min(there.flatness(second));
        }
    }
    flatness
}

/// The lattice points around an inside one with an outside neighbour.
struct Terrace<'a> {
    surface: &'a Surface,
    inside: [isize; 3],
    /// Towards the outside neighbour.
    axis: usize,
    up: isize,
}

impl<'a> Terrace<'a> {
    fn of(surface: &'a Surface, crossing: Crossing) -> Self {
        let (low, axis) = (crossing.low().map(|x| x as isize), crossing.axis());
        let is_low_inside = crossing.inside_low();
        let mut inside = low;
        inside[axis] += isize::from(!is_low_inside);
        Self { surface, inside, axis, up: if is_low_inside { 1 } else { -1 } }
    }

    /// The same some steps along two axes.
    fn moved(&self, steps: [(usize, isize); 2]) -> Self {
        let mut inside = self.inside;
        steps.iter().for_each(|&(axis, count)| inside[axis] += count);
        Self { inside, ..*self }
    }

    /// How flat it is along an axis: how many times as long as the next terraces on both sides.
    fn flatness(&self, along: usize) -> f32 {
        let ends = [-1, 1].map(|sign| self.run(0, 0, along, sign));
        let length = (ends[0] + ends[1]).saturating_sub(1);
        if length < SHORTEST {
            return 0.0;
        }
        // The next terrace is one lower, one higher, or none behind a deep step.
        let next = [(-1, ends[0]), (1, ends[1])]
            .map(|(sign, end)| [-1, 1].map(|height| self.run(end, height, along, sign)));
        let longest_next =
            next.as_flattened().iter().fold(DEEP, |longest, &n| longest.max(n as f32));
        ((length as f32 / longest_next - SMOOTH) / (FLAT - SMOOTH)).clamp(0.0, 1.0)
    }

    /// How many lattice points from some steps beyond the start on lie on the terrace that is
    /// `height` above.
    fn run(&self, steps: usize, height: isize, along: usize, sign: isize) -> usize {
        let mut point = self.inside;
        point[self.axis] += height * self.up;
        point[along] += sign * steps as isize;
        let mut count = 0;
        while count < LONGEST && self.is_on_top(point) {
            point[along] += sign;
            count += 1;
        }
        count
    }

    /// Whether a lattice point is inside and the one above it outside.
    fn is_on_top(&self, point: [isize; 3]) -> bool {
        let mut above = point;
        above[self.axis] += self.up;
        self.is_inside(point) == Some(true) && self.is_inside(above) == Some(false)
    }

    fn is_inside(&self, point: [isize; 3]) -> Option<bool> {
        let dims = self.surface.grid().dims();
        let is_within = (0..3).all(|k| (0..dims[k] as isize).contains(&point[k]));
        is_within.then(|| self.surface.volume().get(point.map(|x| x as usize)))
    }
}
