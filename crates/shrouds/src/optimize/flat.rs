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
use crate::volume::Occupancy;

/// A terrace this many times as long as the next one begins to count as a face, and does in full.
const SMOOTH: f32 = 6.0;
const FLAT: f32 = 10.0;
/// What stands for the length of the next terrace behind a deep step.
const DEEP: f32 = 1.0;
/// The shortest terrace that can be a face. A longest one need not be told apart from longer ones.
const SHORTEST: usize = 7;
const LONGEST: usize = 64;

/// How far the lattice points lie that decide on the flatness of a vertex: to the end of a longest
/// terrace and of the one behind it, seen from two steps away.
pub(crate) const REACH: usize = 2 * LONGEST + 2;

/// How surely every vertex lies on a flat face along the grid, from 0 to 1.
pub(super) fn flatness(surface: &Surface) -> Vec<f32> {
    flatness_within(surface.volume(), [0; 3], surface)
}

/// The same of a surface that is a piece of that of `volume`, from lattice point `first` on.
pub(super) fn flatness_within(
    volume: &Occupancy,
    first: [usize; 3],
    surface: &Surface,
) -> Vec<f32> {
    let lattice = Lattice::of(volume);
    let mut flatness = vec![0.0; surface.vertex_count()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut flatness, ends, |k, flatness| {
        for (flatness, crossing) in flatness.iter_mut().zip(surface.slice_crossings(k)) {
            *flatness = Terrace::of(&lattice, first, crossing).flatness();
        }
    });
    flatness
}

/// The lattice points as one string of bits.
struct Lattice<'a> {
    words: &'a [u64],
    dims: [usize; 3],
    /// From a bit to the next one along each axis.
    strides: [isize; 3],
}

impl<'a> Lattice<'a> {
    fn of(volume: &'a Occupancy) -> Self {
        let (words, per_row) = volume.words();
        let dims = volume.grid().dims();
        let row = 64 * per_row as isize;
        Self { words, dims, strides: [1, row, row * dims[1] as isize] }
    }

    #[inline(always)]
    fn is_inside(&self, bit: isize) -> bool {
        self.words[bit as usize / 64] >> (bit % 64) & 1 == 1
    }
}

/// The lattice points around an inside one with an outside neighbour.
#[derive(Clone, Copy)]
struct Terrace<'a> {
    lattice: &'a Lattice<'a>,
    point: [usize; 3],
    bit: isize,
    /// Along which axis the outside neighbour lies, and whether towards growing indices.
    axis: usize,
    is_up: bool,
}

impl<'a> Terrace<'a> {
    fn of(lattice: &'a Lattice<'a>, first: [usize; 3], crossing: Crossing) -> Self {
        let inside = crossing.inside();
        let point = [0, 1, 2].map(|k| inside[k] + first[k]);
        let bit = (0..3).map(|k| point[k] as isize * lattice.strides[k]).sum();
        Self { lattice, point, bit, axis: crossing.axis(), is_up: crossing.inside_low() }
    }

    fn flatness(&self) -> f32 {
        let [first, second] = [1, 2].map(|step| (self.axis + step) % 3);
        // Two ridges may cross in one lattice point; a face is as flat around it.
        let around = [(first, 0), (first, -2), (first, 2), (second, -2), (second, 2)];
        let mut flatness = 1.0f32;
        for there in around.into_iter().filter_map(|(axis, steps)| self.moved(axis, steps)) {
            for along in [first, second] {
                flatness = flatness.min(there.flatness_along(along));
                if flatness == 0.0 {
                    return 0.0;
                }
            }
        }
        flatness
    }

    /// The same some steps along an axis, if that is on the terrace.
    fn moved(&self, axis: usize, steps: isize) -> Option<Self> {
        let mut moved = *self;
        moved.point[axis] = self.point[axis].checked_add_signed(steps)?;
        moved.bit += steps * self.lattice.strides[axis];
        let is_there = moved.point[axis] < self.lattice.dims[axis] && moved.is_on_top(moved.bit);
        is_there.then_some(moved)
    }

    /// How flat it is along an axis: how many times as long as the next terraces on both sides. In an
    /// image of one slice nothing is: one direction alone tells a side from an arc too badly.
    fn flatness_along(&self, along: usize) -> f32 {
        let ends = [false, true].map(|forward| self.run(0, 0, along, forward));
        let length = ends[0] + ends[1] - 1;
        if length < SHORTEST {
            return 0.0;
        }
        // The next terrace is one lower, one higher, or none behind a deep step.
        let next = [(false, ends[0]), (true, ends[1])]
            .map(|(forward, end)| [-1, 1].map(|height| self.run(end, height, along, forward)));
        let longest_next =
            next.as_flattened().iter().fold(DEEP, |longest, &n| longest.max(n as f32));
        ((length as f32 / longest_next - SMOOTH) / (FLAT - SMOOTH)).clamp(0.0, 1.0)
    }

    /// How many lattice points from some steps beyond the start on lie on the terrace that is
    /// `height` above.
    fn run(&self, steps: usize, height: isize, along: usize, forward: bool) -> usize {
        let Lattice { dims, strides, .. } = self.lattice;
        let on_the_way =
            if forward { dims[along] - self.point[along] } else { self.point[along] + 1 };
        let up = if self.is_up { height } else { -height };
        // Both the lattice point and the one above it must be there.
        let above = if self.is_up { up + 1 } else { up - 1 };
        let is_there = |shift| {
            let place = self.point[self.axis].checked_add_signed(shift);
            place.is_some_and(|place| place < dims[self.axis])
        };
        if !is_there(up) || !is_there(above) {
            return 0;
        }
        let stride = if forward { strides[along] } else { -strides[along] };
        let start = self.bit + up * strides[self.axis];
        let bits = (steps..on_the_way.min(steps + LONGEST)).map(|n| start + n as isize * stride);
        bits.take_while(|&bit| self.is_on_top(bit)).count()
    }

    /// Whether a lattice point is inside and the one above it outside.
    #[inline(always)]
    fn is_on_top(&self, bit: isize) -> bool {
        let stride = self.lattice.strides[self.axis];
        let above = if self.is_up { bit + stride } else { bit - stride };
        self.lattice.is_inside(bit) && !self.lattice.is_inside(above)
    }
}
