//! What a mesh that is not closed needs first: one vertex per place, each triangle once, and
//! neighbours that face the same side.

use crate::mesh::TriMesh;
use crate::vector::{cross, length, subtract};
use crate::voxelize::edges::{Edge, by_edge};

/// Lets triangles name the first of several vertices at the same place; how many others there are.
pub(super) fn weld(mesh: &mut TriMesh) -> u64 {
    let vertices = &mesh.vertices;
    // Zeros of both signs are one place.
    let key = |v: u32| vertices[v as usize].map(|x| (x + 0.0).to_bits());
    let mut order = mesh.triangles.concat();
    order.sort_unstable();
    order.dedup();
    order.sort_unstable_by_key(|&v| (key(v), v));
    let mut first = vec![0; vertices.len()];
    let mut others = 0;
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        same.iter().for_each(|&v| first[v as usize] = same[0]);
        others += same.len() as u64 - 1;
    }
    if others > 0 {
        mesh.triangles.iter_mut().flatten().for_each(|corner| *corner = first[*corner as usize]);
    }
    others
}

/// Drops all but the first of triangles with the same corners and orientation; how many.
pub(super) fn drop_repeated(mesh: &mut TriMesh) -> u64 {
    let canonical = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let mut order: Vec<_> = mesh.triangles.iter().map(canonical).zip(0u32..).collect();
    order.sort_unstable();
    let mut repeated: Vec<u32> =
        order.windows(2).filter(|two| two[0].0 == two[1].0).map(|two| two[1].1).collect();
    repeated.sort_unstable();
    let mut number = 0..;
    mesh.triangles.retain(|_| repeated.binary_search(&number.next().unwrap_or(0)).is_err());
    repeated.len() as u64
}

/// Makes triangles that hang together by edges of two face the same side: the smaller part by area is
/// turned, in the mesh and in its edges. What has one side only stays as it is. Returns how many
/// triangles were turned.
pub(super) fn turn(mesh: &mut TriMesh, edges: &mut [Edge]) -> u64 {
    let mut facing = Facing::new(mesh.triangles.len());
    for edge in by_edge(edges) {
        if let [a, b] = edge {
            facing.join(a.triangle, b.triangle, a.rises == b.rises);
        }
    }
    // The areas of what faces as the root does and of the rest, at each root.
    let mut areas = vec![[0.0; 2]; mesh.triangles.len()];
    for (t, &triangle) in (0..).zip(&mesh.triangles) {
        let [a, b, c] = mesh.corners(triangle);
        let (root, opposite) = facing.find(t);
        areas[root as usize][usize::from(opposite)] +=
            length(cross(subtract(b, a), subtract(c, a)));
    }
    let mut turned = vec![false; mesh.triangles.len()];
    for (t, triangle) in (0..).zip(&mut mesh.triangles) {
        let (root, opposite) = facing.find(t);
        let [same, other] = areas[root as usize];
        if !facing.one_sided[root as usize] && opposite != (other > same) {
            turned[t as usize] = true;
            triangle.swap(1, 2);
        }
    }
    for edge in edges {
        edge.rises ^= turned[edge.triangle as usize];
    }
    turned.iter().map(|&turned| u64::from(turned)).sum()
}

/// Which triangles hang together, and which of them face opposite sides: a union-find with parity.
struct Facing {
    parent: Vec<u32>,
    /// Whether a triangle faces the other side than its parent.
    opposite: Vec<bool>,
    /// Whether what hangs together has one side only; holds at roots.
    one_sided: Vec<bool>,
}

impl Facing {
    fn new(count: usize) -> Self {
        let parent = (0..count as u32).collect();
        Self { parent, opposite: vec![false; count], one_sided: vec![false; count] }
    }

    /// The root, and whether it faces the other side.
    fn find(&mut self, mut t: u32) -> (u32, bool) {
        let mut opposite = false;
        loop {
            let parent = self.parent[t as usize];
            if parent == t {
                return (t, opposite);
            }
            let above = self.parent[parent as usize];
            if above != parent {
                self.opposite[t as usize] ^= self.opposite[parent as usize];
                self.parent[t as usize] = above;
            }
            opposite ^= self.opposite[t as usize];
            t = above;
        }
    }

    fn join(&mut self, a: u32, b: u32, opposite: bool) {
        let ((a, from_a), (b, from_b)) = (self.find(a), self.find(b));
        let opposite = opposite ^ from_a ^ from_b;
        if a == b {
            self.one_sided[a as usize] |= opposite;
            return;
        }
        let (root, child) = (a.min(b), a.max(b));
        self.parent[child as usize] = root;
        self.opposite[child as usize] = opposite;
        self.one_sided[root as usize] |= self.one_sided[child as usize];
    }
}
