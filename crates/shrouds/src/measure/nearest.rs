//! What lies nearest to a point, and what a ray meets first.

use crate::tree::{Part, Tree};
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// A ray meets nothing before this part of the size of all triangles: what it starts on does not count.
const START: f64 = 1e-9;

/// The place on some triangles that is nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    pub(super) distance: f64,
    pub(super) place: Vector,
    /// Of its triangle, of any length.
    pub(super) normal: Vector,
}

impl Tree {
    /// The place nearest to a point; none on no triangles.
    pub(super) fn nearest(&self, point: Vector) -> Option<Nearest> {
        let mut best = None;
        if !self.parts.is_empty() {
            self.search_nearest(0, point, &mut best);
        }
        best
    }

    fn search_nearest(&self, at: usize, point: Vector, best: &mut Option<Nearest>) {
        let Some(children) = self.children(at) else {
            for &corners in self.triangles_of(at) {
                let place = nearest_place(corners, point);
                let distance = length(subtract(point, place));
                if best.is_none_or(|best| distance < best.distance) {
                    *best = Some(Nearest { distance, place, normal: doubled_area(corners) });
                }
            }
            return;
        };
        let bound = |n: usize| {
            let part: &Part = &self.parts[n];
            length(subtract(point, part.centre)) - part.radius
        };
        let mut order = children.map(|n| (bound(n), n));
        if order[1].0 < order[0].0 {
            order.swap(0, 1);
        }
        for (bound, child) in order {
            if best.is_none_or(|best| bound < best.distance) {
                self.search_nearest(child, point, best);
            }
        }
    }

    /// How far a ray goes until it passes through a triangle from behind, in units of its direction, the
    /// triangles it starts on left out.
    pub(super) fn exit(&self, from: Vector, direction: Vector) -> Option<f64> {
        let root = self.parts.first()?;
        let mut ray = Ray { from, direction, size: length(direction), after: 0.0, best: None };
        ray.after = START * root.radius / ray.size;
        self.search_exit(0, &mut ray);
        ray.best
    }

    fn search_exit(&self, at: usize, ray: &mut Ray) {
        let Some(children) = self.children(at) else {
            self.triangles_of(at).iter().for_each(|&corners| ray.pass(corners));
            return;
        };
        let mut order = children.map(|n| (ray.enters(&self.parts[n]), n));
        if order[1].0 < order[0].0 {
            order.swap(0, 1);
        }
        for (enters, child) in order {
            if enters < ray.best.unwrap_or(f64::INFINITY) {
                self.search_exit(child, ray);
            }
        }
    }

    /// The two parts that a part is divided into, unless it is a single triangle.
    fn children(&self, at: usize) -> Option<[usize; 2]> {
        (self.parts[at].count > 1).then(|| [at + 1, self.parts[at + 1].next])
    }

    fn triangles_of(&self, at: usize) -> &[[Vector; 3]] {
        let part = &self.parts[at];
        &self.triangles[part.first..part.first + part.count]
    }
}

/// A ray on its way, in units of its direction.
struct Ray {
    from: Vector,
    direction: Vector,
    /// Length of the direction.
    size: f64,
    after: f64,
    best: Option<f64>,
}

impl Ray {
    /// Where the ray comes near to a part; infinite if it does not.
    fn enters(&self, part: &Part) -> f64 {
        let to = subtract(part.centre, self.from);
        let along = dot(to, self.direction) / self.size;
        // A little more for rounding.
        let radius = part.radius * (1.0 + START);
        let beside = length(cross(to, self.direction)) / self.size;
        if beside > radius || along + radius < 0.0 {
            return f64::INFINITY;
        }
        (along - (radius * radius - beside * beside).sqrt()) / self.size
    }

    /// Möller and Trumbore, *Fast, minimum storage ray/triangle intersection* (1997).
    fn pass(&mut self, [a, b, c]: [Vector; 3]) {
        let (u, v) = (subtract(b, a), subtract(c, a));
        let across = cross(self.direction, v);
        let determinant = dot(u, across);
        // Positive where the ray meets the front.
        if determinant >= 0.0 {
            return;
        }
        let to = subtract(self.from, a);
        let first = dot(to, across) / determinant;
        let turned = cross(to, u);
        let second = dot(self.direction, turned) / determinant;
        let t = dot(v, turned) / determinant;
        let slack = -START;
        let meets = first >= slack && second >= slack && first + second <= 1.0 - slack;
        if meets && t > self.after && t < self.best.unwrap_or(f64::INFINITY) {
            self.best = Some(t);
        }
    }
}

/// Normal of a triangle with twice its area as length.
pub(super) fn doubled_area([a, b, c]: [Vector; 3]) -> Vector {
    cross(subtract(b, a), subtract(c, a))
}

/// The place of a triangle that is nearest to a point, by the regions of its plane (Ericson, *Real-Time
/// Collision Detection*, 2005, 5.1.5).
fn nearest_place([a, b, c]: [Vector; 3], p: Vector) -> Vector {
    let (ab, ac) = (subtract(b, a), subtract(c, a));
    let along = |from: Vector| [dot(ab, subtract(p, from)), dot(ac, subtract(p, from))];
    let ([a1, a2], [b1, b2], [c1, c2]) = (along(a), along(b), along(c));
    if a1 <= 0.0 && a2 <= 0.0 {
        return a;
    }
    if b1 >= 0.0 && b2 <= b1 {
        return b;
    }
    if c2 >= 0.0 && c1 <= c2 {
        return c;
    }
    let in_c = a1 * b2 - b1 * a2;
    if in_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        return add(a, scale(ab, a1 / (a1 - b1)));
    }
    let in_b = c1 * a2 - a1 * c2;
    if in_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        return add(a, scale(ac, a2 / (a2 - c2)));
    }
    let in_a = b1 * c2 - c1 * b2;
    if in_a <= 0.0 && b2 - b1 >= 0.0 && c1 - c2 >= 0.0 {
        let t = (b2 - b1) / ((b2 - b1) + (c1 - c2));
        return add(b, scale(subtract(c, b), t));
    }
    let sum = in_a + in_b + in_c;
    add(a, add(scale(ab, in_b / sum), scale(ac, in_c / sum)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles with corners in a cube of side 2, from Weyl's sequence.
    fn triangles(count: usize) -> Vec<[Vector; 3]> {
        (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2].map(point)).collect()
    }

    fn point(n: usize) -> Vector {
        [0.569_840_29, 0.754_877_67, 0.324_717_96].map(|x| 2.0 * (x * n as f64).fract() - 1.0)
    }

    #[test]
    fn the_tree_finds_what_all_triangles_give() {
        for count in [1, 2, 3, 50] {
            let all: Vec<[Vector; 3]> =
                triangles(count).iter().map(|t| t.map(|p| scale(p, 0.5))).collect();
            let tree = Tree::new(all.clone());
            for n in 0..300 {
                let p = scale(point(7 * n + 1000), 1.5);
                let to = |t: &[Vector; 3]| length(subtract(p, nearest_place(*t, p)));
                let expected = all.iter().map(to).fold(f64::INFINITY, f64::min);
                assert!((tree.nearest(p).unwrap().distance - expected).abs() < 1e-12);
                let direction = point(n + 5000);
                let mut ray = Ray { from: p, direction, size: 1.0, after: 0.0, best: None };
                all.iter().for_each(|t| ray.pass(*t));
                assert_eq!(tree.exit(p, direction).is_some(), ray.best.is_some());
                assert!(
                    tree.exit(p, direction)
                        .zip(ray.best)
                        .is_none_or(|(a, b)| (a - b).abs() < 1e-12)
                );
            }
        }
        assert_eq!(Tree::new(vec![]).nearest([0.0; 3]), None);
        assert_eq!(Tree::new(vec![]).exit([0.0; 3], [1.0; 3]), None);
    }

    #[test]
    fn no_place_of_a_triangle_is_nearer() {
        for n in 0..200 {
            let [a, b, c] = [n, n + 300, n + 700].map(point);
            let p = scale(point(n + 1111), 2.0);
            let found = length(subtract(p, nearest_place([a, b, c], p)));
            let steps = 60;
            let mut least = f64::INFINITY;
            for (i, j) in (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| (i, j))) {
                let [u, v] = [i, j].map(|x| f64::from(x) / f64::from(steps));
                let q = add(scale(a, 1.0 - u - v), add(scale(b, u), scale(c, v)));
                least = least.min(length(subtract(p, q)));
            }
            assert!(found <= least + 1e-12 && least < found + 0.08, "{found} {least}");
        }
    }
}
