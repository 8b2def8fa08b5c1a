//! Pairs of triangles that meet elsewhere than in the vertices they share.
//!
//! Triangles sorted along a space-filling curve, eight to a leaf and eight nodes to a parent, with a
//! box each, give a tree without pointers; every leaf asks it for the leaves behind it that come
//! near. Pairs whose boxes overlap are then decided exactly.

use std::ops::Range;

use crate::check::curve;
use crate::check::found::Found;
use crate::check::measure::bounds;
use crate::check::predicates::{Corners, Point, coplanar_corners_meet, coplanar_triangles_meet};
use crate::check::predicates::{folded, is_degenerate, segment_meets_triangle, side_of_plane};
use crate::check::structure::corners;
use crate::mesh::TriMesh;
use crate::parallel;

/// Children of a node, and triangles of a leaf.
const WIDTH: usize = 8;
/// Leaves per block of parallel work.
const BLOCK: usize = 256;

/// Pairs of triangles, the smaller index first, that have a point in common besides shared vertices
/// and the edge between two of them. Degenerate triangles are left out.
pub(super) fn self_intersections(mesh: &TriMesh) -> Found<[u32; 2]> {
    let tree = Tree::new(mesh);
    let leaves = tree.order.len().div_ceil(WIDTH);
    Found::gather(parallel::blocks(leaves, BLOCK, |range| {
        let mut found = Found::default();
        range.for_each(|leaf| tree.search(mesh, leaf, &mut found));
        found
    }))
}

/// A triangle taken out of its mesh.
struct Face {
    index: u32,
    vertices: [u32; 3],
    corners: Corners,
}

impl Face {
    fn new(mesh: &TriMesh, index: u32) -> Self {
        let t = index as usize;
        Self { index, vertices: mesh.triangles[t], corners: corners(mesh, t) }
    }
}

/// Whether two triangles that are not degenerate have a point in common besides what they share.
fn intersect(first: &Face, second: &Face) -> bool {
    let (a, b) = (&first.corners, &second.corners);
    let shared = first.vertices.map(|v| second.vertices.contains(&v));
    let shared_too = second.vertices.map(|v| first.vertices.contains(&v));
    // The first corner that is shared, or that is not.
    let corner = |shared: [bool; 3], which| shared.iter().position(|&s| s == which).unwrap_or(0);
    match shared.iter().filter(|&&shared| shared).count() {
        0 => triangles_meet(a, b),
        1 => {
            // What they have in common is convex and holds the shared corner; the ray from there
            // through another common point leaves one of them through its opposite edge.
            let (edge_a, edge_b) =
                (edge(a, corner(shared, true)), edge(b, corner(shared_too, true)));
            let sides_b = edge_b.map(|point| side_of_plane(a, point));
            if one_sided(&sides_b) {
                return false;
            }
            if sides_b == [0; 2] {
                let with_corner = |triangle: &Corners, n: usize| {
                    [triangle[n], triangle[(n + 1) % 3], triangle[(n + 2) % 3]]
                };
                let (na, nb) = (corner(shared, true), corner(shared_too, true));
                return coplanar_corners_meet(with_corner(a, na), with_corner(b, nb));
            }
            let sides_a = edge_a.map(|point| side_of_plane(b, point));
            segment_meets_triangle(edge_b, sides_b, a) || segment_meets_triangle(edge_a, sides_a, b)
        }
        // With an edge in common they meet again only when folded flat onto each other.
        2 => folded(a, corner(shared, false), b[corner(shared_too, false)]),
        _ => true,
    }
}

fn triangles_meet(a: &Corners, b: &Corners) -> bool {
    let sides_b = b.map(|point| side_of_plane(a, point));
    if one_sided(&sides_b) {
        return false;
    }
    if sides_b == [0; 3] {
        return coplanar_triangles_meet(a, b);
    }
    let sides_a = a.map(|point| side_of_plane(b, point));
    let ends = |sides: [i8; 3], n: usize| [sides[(n + 1) % 3], sides[(n + 2) % 3]];
    !one_sided(&sides_a)
        && (0..3).any(|n| {
            segment_meets_triangle(edge(a, n), ends(sides_a, n), b)
                || segment_meets_triangle(edge(b, n), ends(sides_b, n), a)
        })
}

/// Whether all points lie strictly on the same side.
fn one_sided(sides: &[i8]) -> bool {
    sides[0] != 0 && sides.iter().all(|&side| side == sides[0])
}

/// The edge opposite to corner `n`.
fn edge(triangle: &Corners, n: usize) -> [Point; 2] {
    [triangle[(n + 1) % 3], triangle[(n + 2) % 3]]
}

/// Triangles and boxes in the order of a space-filling curve.
struct Tree {
    order: Vec<u32>,
    boxes: Vec<Cuboid>,
    /// Boxes of the nodes, leaves first, up to the level with one node.
    levels: Vec<Vec<Cuboid>>,
}

/// Lowest and highest place along each axis, in steps of 2⁻³⁰ of the mesh. The steps are counted by
/// a function that never decreases, so boxes that overlap in space overlap here.
#[derive(Clone, Copy)]
struct Cuboid([u32; 3], [u32; 3]);

impl Cuboid {
    const EMPTY: Self = Self([u32::MAX; 3], [0; 3]);

    fn overlaps(&self, other: &Self) -> bool {
        // Without branches: the answer is hard to foresee.
        (0..3).fold(true, |all, d| all & (self.0[d] <= other.1[d]) & (other.0[d] <= self.1[d]))
    }

    fn union(boxes: &[Self]) -> Self {
        boxes.iter().fold(Self::EMPTY, |all, cuboid| {
            Self(
                [0, 1, 2].map(|d| all.0[d].min(cuboid.0[d])),
                [0, 1, 2].map(|d| all.1[d].max(cuboid.1[d])),
            )
        })
    }

    /// Place of the centre along a space-filling curve, in 30 bits.
    fn code(&self) -> u64 {
        let centre = |d: usize| self.0[d] / 2 + self.1[d] / 2;
        curve::position([0, 1, 2].map(|d| (centre(d) >> 20).min(1023)), 10)
    }
}

impl Tree {
    fn new(mesh: &TriMesh) -> Self {
        let (low, high) = bounds(&mesh.vertices);
        let extent = (0..3).map(|d| high[d] - low[d]).fold(f64::MIN_POSITIVE, f64::max);
        let scale = f64::from(1 << 30) / extent;
        let cuboid = |t: usize| {
            let steps = corners(mesh, t)
                .map(|p| [0, 1, 2].map(|d| (((p[d] - low[d]) * scale) as u32).min(1 << 30)));
            Cuboid::union(&steps.map(|step| Cuboid(step, step)))
        };
        // The code in the upper half and the triangle in the lower one: one sort, no ties.
        let blocks = parallel::blocks(mesh.triangles.len(), BLOCK * WIDTH, |range| {
            let proper = range.filter(|&t| !is_degenerate(&corners(mesh, t)));
            proper.map(|t| cuboid(t).code() << 32 | t as u64).collect::<Vec<_>>()
        });
        let mut keys = blocks.concat();
        keys.sort_unstable();
        let order: Vec<u32> = keys.into_iter().map(|key| key as u32).collect();
        let mut boxes = vec![Cuboid::EMPTY; order.len()];
        parallel::fill(&mut boxes, |n| cuboid(order[n] as usize));
        let parents = |boxes: &[Cuboid]| boxes.chunks(WIDTH).map(Cuboid::union).collect();
        let mut levels: Vec<Vec<Cuboid>> = vec![parents(&boxes)];
        while let Some(top) = levels.last().filter(|top| top.len() > 1) {
            levels.push(parents(top));
        }
        Self { order, boxes, levels }
    }

    /// Finds the intersections of the triangles of `leaf` with each other and those behind.
    fn search(&self, mesh: &TriMesh, leaf: usize, found: &mut Found<[u32; 2]>) {
        let own = self.levels[0][leaf];
        let faces: Vec<Face> = self.members(leaf).map(|n| Face::new(mesh, self.order[n])).collect();
        let mut stack = vec![(self.levels.len() - 1, 0)];
        while let Some((level, node)) = stack.pop() {
            if level == 0 {
                self.compare(mesh, (leaf, &faces), node, found);
                continue;
            }
            let below = &self.levels[level - 1];
            // The last leaf below a child must not lie before this one.
            let leaves = WIDTH.pow(level as u32 - 1);
            let children = (node * WIDTH).max(leaf / leaves)..below.len().min((node + 1) * WIDTH);
            stack.extend(
                children
                    .filter(|&child| below[child].overlaps(&own))
                    .map(|child| (level - 1, child)),
            );
        }
    }

    fn compare(
        &self,
        mesh: &TriMesh,
        (leaf, faces): (usize, &[Face]),
        other: usize,
        found: &mut Found<[u32; 2]>,
    ) {
        let own = &self.levels[0][leaf];
        for m in self.members(other).filter(|&m| self.boxes[m].overlaps(own)) {
            let second = Face::new(mesh, self.order[m]);
            for (n, first) in self.members(leaf).zip(faces).take_while(|&(n, _)| n < m) {
                if self.boxes[n].overlaps(&self.boxes[m]) && intersect(first, &second) {
                    let (t, u) = (first.index, second.index);
                    found.push([t.min(u), t.max(u)]);
                }
            }
        }
    }

    fn members(&self, leaf: usize) -> Range<usize> {
        leaf * WIDTH..self.order.len().min((leaf + 1) * WIDTH)
    }
}
