//! Triangles in a tree, for whatever asks for those near a place.

use crate::vector::{Vector, add, cross, length, scale, subtract};

/// Triangles in a tree whose parts lie close together, in the order of a walk from the root on.
pub(crate) struct Tree {
    pub(crate) parts: Vec<Part>,
    pub(crate) triangles: Vec<[Vector; 3]>,
}

/// Some triangles.
pub(crate) struct Part {
    pub(crate) centre: Vector,
    /// No corner is farther from the centre.
    pub(crate) radius: f64,
    /// Sum of the areas times the normals.
    pub(crate) dipole: Vector,
    pub(crate) area: f64,
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// The part that follows when those within this one are left out.
    pub(crate) next: usize,
}

impl Tree {
    pub(crate) fn new(triangles: Vec<[Vector; 3]>) -> Self {
        let mut tree = Self { parts: Vec::new(), triangles };
        if !tree.triangles.is_empty() {
            tree.divide(0, tree.triangles.len());
        }
        tree
    }

    fn divide(&mut self, first: usize, count: usize) {
        let triangles = &mut self.triangles[first..first + count];
        let place = self.parts.len();
        self.parts.push(Part::new(triangles, first));
        if count > 1 {
            let axis = longest_axis(triangles);
            let middle = |[a, b, c]: &[Vector; 3]| a[axis] + b[axis] + c[axis];
            triangles.select_nth_unstable_by(count / 2, |a, b| middle(a).total_cmp(&middle(b)));
            self.divide(first, count / 2);
            self.divide(first + count / 2, count - count / 2);
        }
        self.parts[place].next = self.parts.len();
    }

    /// The part of all triangles, if there are any.
    pub(crate) fn root(&self) -> Vec<usize> {
        if self.parts.is_empty() { Vec::new() } else { vec![0] }
    }
}

impl Part {
    fn new(triangles: &[[Vector; 3]], first: usize) -> Self {
        let (mut area, mut dipole, mut moment) = (0.0, [0.0; 3], [0.0; 3]);
        let mut middle = [0.0; 3];
        for &[a, b, c] in triangles {
            let normal = scale(cross(subtract(b, a), subtract(c, a)), 0.5);
            let third = scale(add(add(a, b), c), 1.0 / 3.0);
            area += length(normal);
            dipole = add(dipole, normal);
            moment = add(moment, scale(third, length(normal)));
            middle = add(middle, third);
        }
        let centre = if area > 0.0 {
            scale(moment, 1.0 / area)
        } else {
            scale(middle, 1.0 / triangles.len() as f64)
        };
        let distances = triangles.iter().flatten().map(|&p| length(subtract(p, centre)));
        let radius = distances.fold(0.0, f64::max);
        Self { centre, radius, dipole, area, first, count: triangles.len(), next: 0 }
    }
}

fn longest_axis(triangles: &[[Vector; 3]]) -> usize {
    let extent = |d: usize| {
        let corners = triangles.iter().flatten().map(|p| p[d]);
        corners.clone().fold(f64::MIN, f64::max) - corners.fold(f64::MAX, f64::min)
    };
    [1, 2].into_iter().fold(0, |best, d| if extent(d) > extent(best) { d } else { best })
}
