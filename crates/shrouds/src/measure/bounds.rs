//! What separating surfaces of a volume could measure.
//!
//! Every vertex may lie anywhere on its grid edge. The triangles are the fixed ones, the same for
//! every δ.
//!
//! *Volume.* It is linear in each δ, and falls as a vertex moves towards the inside end wherever the
//! triangles around it, seen along its grid edge, surround it. So the bounds are the volumes with all
//! vertices at the inside and at the outside ends. In crowded cells of noise a triangle can lie the other
//! way round and one vertex alone do the opposite; no surface beyond these bounds is known, and random
//! surfaces and walks from vertex to vertex (`tests/measure_bounds.rs`) find none, but it is no proof.
//!
//! *Area.* The vector area of a triangle is linear in each of its three δ, so each of its components has
//! its extremes where all three are 0 or 1, and so has its length the largest. The sums over triangles of the
//! least and the largest are bounds, but no surface need reach them: neighbours share vertices. Of all bodies
//! of a volume the ball has the least area, which is often the better lower bound of a closed surface.

use std::f64::consts::PI;

use crate::grid::Grid;
use crate::parallel;
use crate::surface::Surface;
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};
use crate::volume::Border;

/// Triangles that one block sums up.
const BLOCK: usize = 1 << 12;

/// Of volume and of area, each the least and the largest, in cubic and squared world units. Those of volume
/// mean something for a closed border only.
pub(super) fn bounds(surface: &Surface) -> [[f64; 2]; 2] {
    let ends = ends(surface);
    let triangles = surface.fixed_triangles();
    let sums = parallel::blocks(triangles.len(), BLOCK, |range| {
        let each = triangles[range].iter().map(|t| Extremes::of(t.map(|v| ends[v as usize])));
        each.fold(Extremes::default(), Extremes::add)
    });
    let all = sums.into_iter().fold(Extremes::default(), Extremes::add);
    let volume = all.volume.map(|sum| sum / 6.0);
    let ball = match surface.border() {
        Border::Closed => (36.0 * PI).cbrt() * volume[0].max(0.0).powi(2).cbrt(),
        Border::Open => 0.0,
    };
    [volume, [ball.max(0.5 * all.area[0]), 0.5 * all.area[1]]]
}

/// Sums over triangles: six times the volume with all vertices at the inside and at the outside ends,
/// twice the least and the largest area.
#[derive(Clone, Copy, Default)]
struct Extremes {
    volume: [f64; 2],
    area: [f64; 2],
}

impl Extremes {
    /// Of one triangle, by both ends of the grid edge of each corner, the inside ones first.
    fn of(ends: [[Vector; 2]; 3]) -> Self {
        let volume = [0, 1].map(|end| {
            let [a, b, c] = ends.map(|corner| corner[end]);
            dot(a, cross(b, c))
        });
        let mut components = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        let mut largest = 0.0f64;
        for choice in 0..8 {
            let [a, b, c] = [0, 1, 2].map(|n| ends[n][choice >> n & 1]);
            let doubled = cross(subtract(b, a), subtract(c, a));
            largest = largest.max(length(doubled));
            for (range, x) in components.iter_mut().zip(doubled) {
                *range = [range[0].min(x), range[1].max(x)];
            }
        }
        let least = components.map(|[low, high]| low.max(-high).max(0.0));
        Self { volume, area: [length(least), largest] }
    }

    fn add(self, other: Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self { volume: sum(self.volume, other.volume), area: sum(self.area, other.area) }
    }
}

/// Both ends of every vertex's grid edge, the inside one first, in world lengths about the middle of the
/// lattice and along axes of which the first is that of the lattice: that keeps the bounds of area from
/// depending on how the lattice lies in the world.
fn ends(surface: &Surface) -> Vec<[Vector; 2]> {
    let frame = Frame::of(surface.grid());
    let crossings = surface.crossings();
    crossings.map(|c| [c.inside(), c.outside()].map(|end| frame.place(end))).collect()
}

struct Frame {
    /// World vectors of steps along the axes of the lattice, in axes of the frame.
    steps: [Vector; 3],
    middle: Vector,
}

impl Frame {
    /// Gram and Schmidt's.
    fn of(grid: &Grid) -> Self {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|a| grid.vector(a));
        let unit = |v: Vector| scale(v, length(v).recip());
        let first = unit(axes[0]);
        let second = unit(subtract(axes[1], scale(first, dot(first, axes[1]))));
        let third = cross(first, second);
        let steps = axes.map(|step| [first, second, third].map(|axis| dot(axis, step)));
        // Triangles turn over with the lattice.
        let steps = if grid.is_mirrored() { steps.map(|[x, y, z]| [x, y, -z]) } else { steps };
        Self { steps, middle: grid.dims().map(|count| 0.5 * (count - 1) as f64) }
    }

    fn place(&self, index: [usize; 3]) -> Vector {
        let terms = [0, 1, 2].map(|k| scale(self.steps[k], index[k] as f64 - self.middle[k]));
        terms.into_iter().fold([0.0; 3], add)
    }
}
