//! The solid angle of triangles seen from places in a box.

use std::f64::consts::PI;

use crate::tree::{Part, Tree};
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// A part is far where the cube of its distance exceeds this many times its area and size, its own or
/// that of the box it is seen from; where its triangles cover a disc, from 7 times the radius on. The
/// sums are then wrong by some thousandths of the full sphere, and at most a hundredth.
const FAR: f64 = 110.0;
/// But never nearer than this many times either size.
const NEVER_FAR: f64 = 3.0;

/// A box, and what far parts add up to as seen from it, each a dipole.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    centre: Vector,
    /// Half the diagonal of the box.
    size: f64,
    /// Full spheres at the centre, and how they grow along each axis.
    value: f64,
    gradient: Vector,
}

impl Tree {
    /// Divides the parts `near[from..]`, which are all that the view does not hold yet: what is far from
    /// the box goes into the view, the rest to the end of `near`. Returns a bound of what all triangles
    /// add up to, of either sign, as seen from any place of the box.
    pub(super) fn look(&self, view: &mut View, near: &mut Vec<usize>, from: usize) -> f64 {
        let mut bound = 0.0;
        for n in from..near.len() {
            let mut at = near[n];
            let end = self.parts[at].next;
            while at < end {
                let part = &self.parts[at];
                let to = subtract(part.centre, view.centre);
                let distance = length(to);
                let size = part.radius.max(view.size);
                if distance > NEVER_FAR * size && distance.powi(3) > FAR * part.area * size {
                    view.add(part, to, distance);
                } else if part.count > 1 && part.radius > view.size {
                    at += 1;
                    continue;
                } else {
                    near.push(at);
                    bound += part.bound(distance - view.size - part.radius);
                }
                at = part.next;
            }
        }
        bound + view.value.abs() + length(view.gradient) * view.size
    }

    /// What all triangles add up to at the centre of a view, in full spheres, when these parts are all
    /// that it does not hold. A triangle counts positive where the place lies behind it.
    pub(super) fn solid_angle(&self, view: &View, near: &[usize]) -> f64 {
        let own = near.iter().map(|&at| &self.parts[at]);
        let triangles = own.flat_map(|part| &self.triangles[part.first..part.first + part.count]);
        let half: f64 = triangles.map(|triangle| half_angle(triangle, view.centre)).sum();
        view.value + half / (2.0 * PI)
    }
}

impl Part {
    /// No more full spheres than this are filled at places so far from all triangles, or farther.
    fn bound(&self, distance: f64) -> f64 {
        // A triangle fills no more than half the sphere. No area seen from no distance is no number, and
        // then `min` takes the half.
        let seen = self.area / (4.0 * PI * distance.max(0.0).powi(2));
        seen.min(0.5 * self.count as f64)
    }
}

impl View {
    /// What is seen from the box between two corners, as far as known from a larger one.
    pub(super) fn within(&self, low: Vector, high: Vector) -> Self {
        let mut view = Self::new(low, high);
        view.value = self.value + dot(self.gradient, subtract(view.centre, self.centre));
        view.gradient = self.gradient;
        view
    }

    /// The box between two corners before anything is seen.
    pub(super) fn new(low: Vector, high: Vector) -> Self {
        let (centre, size) = (scale(add(low, high), 0.5), 0.5 * length(subtract(high, low)));
        Self { centre, size, value: 0.0, gradient: [0.0; 3] }
    }

    fn add(&mut self, part: &Part, to: Vector, distance: f64) {
        let cube = 4.0 * PI * distance.powi(3);
        let along = dot(part.dipole, to);
        let rise = 3.0 * along / (distance * distance);
        self.value += along / cube;
        let grown = subtract(scale(to, rise), part.dipole);
        self.gradient = add(self.gradient, scale(grown, 1.0 / cube));
    }
}

/// Half the solid angle of a triangle in radians (van Oosterom and Strackee, *The solid angle of a plane
/// triangle*, 1983).
fn half_angle(triangle: &[Vector; 3], point: Vector) -> f64 {
    let [a, b, c] = triangle.map(|corner| subtract(corner, point));
    let [la, lb, lc] = [a, b, c].map(length);
    let volume = dot(a, cross(b, c));
    volume.atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::uniform;

    fn random_vector(seed: u64, n: u64) -> Vector {
        std::array::from_fn(|d| 2.0 * uniform(seed, 3 * n + d as u64) - 1.0)
    }

    #[test]
    fn an_octant_is_an_eighth() {
        let far = [[1e9, 0.0, 0.0], [0.0, 1e9, 0.0], [0.0, 0.0, 1e9]];
        assert!((half_angle(&far, [0.0; 3]) / (2.0 * PI) - 0.125).abs() < 1e-9);
        // From its plane, and from a corner.
        let flat = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(half_angle(&flat, [0.0; 3]), 0.0);
        assert_eq!(half_angle(&flat, [1.0, 0.0, 0.0]), 0.0);
    }

    /// A wavy sheet with a rim: many triangles whose solid angles add up.
    fn sheet(n: usize) -> Vec<[Vector; 3]> {
        let at = |i: usize, j: usize| {
            let [x, y] = [i, j].map(|i| 2.0 * i as f64 / n as f64 - 1.0);
            [x, y, 0.2 * (4.0 * x).sin() * (3.0 * y).cos()]
        };
        let cells = (0..n * n).map(|m| (m % n, m / n));
        cells
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    /// All of a sheet, or every so many of its triangles.
    fn sheets() -> [Vec<[Vector; 3]>; 2] {
        [sheet(30), sheet(60).into_iter().step_by(17).collect()]
    }

    fn sum(triangles: &[[Vector; 3]], point: Vector) -> f64 {
        triangles.iter().map(|triangle| half_angle(triangle, point) / (2.0 * PI)).sum()
    }

    #[test]
    fn ever_smaller_boxes_end_at_the_sum_of_the_triangles() {
        for triangles in sheets() {
            let tree = Tree::new(triangles.clone());
            for n in 0..500 {
                let point = scale(random_vector(1, n), 2.0);
                let mut near = tree.root();
                let mut view = View::new([-4.0; 3], [4.0; 3]);
                let mut from = 0;
                // Boxes of which the last is the point.
                for level in 0..9 {
                    let half = if level == 8 { 0.0 } else { 4.0 / f64::from(1 << level) };
                    let middle = add(point, scale(random_vector(2, 9 * n + level), 0.5 * half));
                    let [low, high] = [-half, half].map(|half| middle.map(|x| x + half));
                    view = view.within(low, high);
                    let end = near.len();
                    tree.look(&mut view, &mut near, from);
                    from = end;
                }
                let (found, sum) = (tree.solid_angle(&view, &near[from..]), sum(&triangles, point));
                assert!((found - sum).abs() < 4e-3, "{found} {sum} at {point:?}");
            }
        }
    }

    #[test]
    fn the_bound_holds_in_its_box_and_is_small_far_away() {
        for triangles in sheets() {
            let tree = Tree::new(triangles.clone());
            let bound = |low, high| tree.look(&mut View::new(low, high), &mut tree.root(), 0);
            let mut useful = 0;
            for n in 0..200 {
                let low = scale(random_vector(2, n), 2.0);
                let high = add(low, scale(add(random_vector(3, n), [1.0; 3]), 0.3));
                let bound = bound(low, high);
                useful += usize::from(bound < 0.5);
                for m in 0..30 {
                    let point = std::array::from_fn(|d| {
                        low[d] + (high[d] - low[d]) * uniform(4, 90 * n + 3 * m + d as u64)
                    });
                    let sum = sum(&triangles, point).abs();
                    assert!(sum < bound + 5e-3, "{sum} {bound}");
                }
            }
            assert!(useful > 50, "{useful} of 200");
            assert!(bound([9.0; 3], [10.0; 3]) < 0.01);
        }
        let none = Tree::new(Vec::new());
        assert_eq!(none.look(&mut View::new([0.0; 3], [1.0; 3]), &mut none.root(), 0), 0.0);
    }
}
