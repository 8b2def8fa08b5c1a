//! Pairs of triangles that meet elsewhere than in the vertices they share.
//!
//! Triangles sorted along a space-filling curve, eight to a leaf and eight nodes to a parent, with a
//! box each, give a tree without pointers; every leaf asks it for the leaves behind it that come
//! near. Pairs whose boxes overlap are then decided exactly.

use crate::check::found::Found;
use crate::check::predicates::{Corners, Point, folded};
use crate::check::predicates::{is_degenerate, segment_meets_triangle, side_of_plane};
use crate::check::structure::{bounds, corners};
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

/// Whether two triangles that are not degenerate have a point in common besides what they share.
fn intersect(mesh: &TriMesh, t: u32, u: u32) -> bool {
    let [first, second] = [t, u].map(|t| mesh.triangles[t as usize]);
    let (a, b) = (corners(mesh, t as usize), corners(mesh, u as usize));
    let shared = first.map(|v| second.contains(&v));
    let shared_too = second.map(|v| first.contains(&v));
    // The first corner that is shared, or that is not.
    let corner = |shared: [bool; 3], which| shared.iter().position(|&s| s == which).unwrap_or(0);
    match shared.iter().filter(|&&shared| shared).count() {
        0 => {
            !strictly_on_one_side(&a, &b)
                && !strictly_on_one_side(&b, &a)
                && (0..3).any(|n| {
                    segment_meets_triangle(edge(&a, n), &b)
                        || segment_meets_triangle(edge(&b, n), &a)
                })
        }
        1 => {
            // What they have in common is convex and holds the shared corner; the ray from there
            // through another common point leaves one of them through its opposite edge.
            let (edge_a, edge_b) =
                (edge(&a, corner(shared, true)), edge(&b, corner(shared_too, true)));
            !strictly_on_one_side(&a, &edge_b)
                && !strictly_on_one_side(&b, &edge_a)
                && (segment_meets_triangle(edge_a, &b) || segment_meets_triangle(edge_b, &a))
        }
        // With an edge in common they meet again only when folded flat onto each other.
        2 => folded(&a, corner(shared, false), b[corner(shared_too, false)]),
        _ => true,
    }
}

/// The edge opposite to corner `n`.
fn edge(triangle: &Corners, n: usize) -> [Point; 2] {
    [triangle[(n + 1) % 3], triangle[(n + 2) % 3]]
}

fn strictly_on_one_side(triangle: &Corners, points: &[Point]) -> bool {
    let side = side_of_plane(triangle, points[0]);
    side != 0 && points[1..].iter().all(|&point| side_of_plane(triangle, point) == side)
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
        (0..3).all(|d| self.0[d] <= other.1[d] && other.0[d] <= self.1[d])
    }

    fn union(boxes: &[Self]) -> Self {
        boxes.iter().fold(Self::EMPTY, |all, cuboid| {
            Self(
                [0, 1, 2].map(|d| all.0[d].min(cuboid.0[d])),
                [0, 1, 2].map(|d| all.1[d].max(cuboid.1[d])),
            )
        })
    }

    /// Place of the centre along the curve: ten bits per axis, interleaved.
    fn code(&self) -> u64 {
        let centre = [0, 1, 2].map(|d| (u64::from(self.0[d]) + u64::from(self.1[d])) >> 21);
        (0..10).fold(0, |code, bit| {
            (0..3).fold(code, |code, d| code | (centre[d] >> bit & 1) << (3 * bit + d))
        })
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
        let mut stack = vec![(self.levels.len() - 1, 0)];
        while let Some((level, node)) = stack.pop() {
            if !self.levels[level][node].overlaps(&own) {
                continue;
            }
            if level == 0 {
                self.compare(mesh, leaf, node, found);
                continue;
            }
            let children = node * WIDTH..self.levels[level - 1].len().min((node + 1) * WIDTH);
            // The last leaf below a child must not lie before this one.
            let leaves = WIDTH.pow(level as u32 - 1);
            stack.extend(
                children
                    .filter(|child| (child + 1) * leaves > leaf)
                    .map(|child| (level - 1, child)),
            );
        }
    }

    fn compare(&self, mesh: &TriMesh, leaf: usize, other: usize, found: &mut Found<[u32; 2]>) {
        let members = |leaf: usize| leaf * WIDTH..self.order.len().min((leaf + 1) * WIDTH);
        for m in members(other) {
            if !self.boxes[m].overlaps(&self.levels[0][leaf]) {
                continue;
            }
            for n in members(leaf).take_while(|&n| n < m) {
                let (t, u) = (self.order[n], self.order[m]);
                if self.boxes[n].overlaps(&self.boxes[m]) && intersect(mesh, t, u) {
                    found.push([t.min(u), t.max(u)]);
                }
            }
        }
    }
}
