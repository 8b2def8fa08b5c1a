//! Caps over the holes of a mesh: triangles that make its winding numbers whole.
//!
//! The edges that more triangles run through one way than the other form a chain without ends. It
//! falls into simple loops, and each is closed by triangles whose sides are ever longer chords of it,
//! so that most are small and lie near the hole. They may fold over and cross the mesh: what they add
//! to the winding number is known and taken away again.

use std::collections::BTreeMap;

use crate::error::Error;
use crate::mesh::TriMesh;
use crate::random::uniform;
use crate::vector::{Vector, length, subtract};
use crate::voxelize::edges::{Edge, by_edge};

/// How far a cap's inner vertices are moved away from the hole's own, relative to the edges there:
/// then no lattice point lies on a cap but by way of the mesh's own edges, and its side is clear.
const AWAY: f64 = 1e-3;
/// Any number.
const SEED: u64 = 0xcab5;

/// Adds caps for all holes to the mesh, whose sorted edges are `edges`.
pub(super) fn close(mesh: &mut TriMesh, edges: &[Edge]) -> Result<(), Error> {
    let missing = missing(edges);
    if mesh.vertices.len() + missing.len() > u32::MAX as usize {
        let count = missing.len();
        return Err(Error::Mesh(format!("{count} edges have one triangle; voxelise it in parts")));
    }
    for rim in loops(&missing) {
        add_cap(mesh, &rim);
    }
    Ok(())
}

/// The edges that a mesh lacks, from one vertex to another, sorted; several times where several
/// triangles are missing.
fn missing(edges: &[Edge]) -> Vec<[u32; 2]> {
    let mut missing = Vec::new();
    for edge in by_edge(edges) {
        let excess: i64 = edge.iter().map(|e| if e.rises { 1 } else { -1 }).sum();
        let [low, high] = edge[0].ends;
        let lacking = if excess > 0 { [high, low] } else { [low, high] };
        missing.extend((0..excess.unsigned_abs()).map(|_| lacking));
    }
    missing.sort_unstable();
    missing
}

/// Simple loops that together use every edge once. As many edges lead to each vertex as away from it.
fn loops(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    // The first edge not used yet that leaves a vertex.
    let mut next: BTreeMap<u32, usize> = BTreeMap::new();
    for (n, &[from, _]) in edges.iter().enumerate() {
        next.entry(from).or_insert(n);
    }
    let mut used = vec![false; edges.len()];
    let mut loops = Vec::new();
    let mut path: Vec<u32> = Vec::new();
    let mut place: BTreeMap<u32, usize> = BTreeMap::new();
    for (n, &[start, _]) in edges.iter().enumerate() {
        if used[n] {
            continue;
        }
        path.push(start);
        place.insert(start, 0);
        while let Some(edge) = path.last().and_then(|from| next.get_mut(from)) {
            let (n, to) = (*edge, edges[*edge][1]);
            used[n] = true;
            *edge += 1;
            match place.get(&to) {
                Some(&at) => {
                    let rim = path.split_off(at);
                    place.retain(|_, at_| *at_ < at);
                    loops.push(rim);
                    if at == 0 {
                        break;
                    }
                    place.insert(to, at);
                }
                None => {
                    place.insert(to, path.len());
                }
            }
            path.push(to);
        }
    }
    loops
}

/// A collar from the loop to a copy of it that is moved a little at random, and chords over the copy.
fn add_cap(mesh: &mut TriMesh, rim: &[u32]) {
    let count = rim.len();
    let first = mesh.vertices.len() as u32;
    for n in 0..count {
        let [before, here, after] =
            [n + count - 1, n, n + 1].map(|n| mesh.vertices[rim[n % count] as usize]);
        mesh.vertices.push(moved(before, here, after, u64::from(first) + n as u64));
    }
    for n in 0..count {
        let (m, inner) = ((n + 1) % count, |n: usize| first + n as u32);
        mesh.triangles.push([rim[n], rim[m], inner(m)]);
        mesh.triangles.push([rim[n], inner(m), inner(n)]);
    }
    let mut open = vec![(first, first + count as u32 - 1)];
    while let Some((low, high)) = open.pop() {
        if high - low >= 2 {
            let middle = low + (high - low) / 2;
            mesh.triangles.push([low, middle, high]);
            open.extend([(low, middle), (middle, high)]);
        }
    }
}

fn moved(before: Vector, here: Vector, after: Vector, number: u64) -> Vector {
    let near = length(subtract(here, before)).min(length(subtract(after, here)));
    std::array::from_fn(|d| {
        here[d] + AWAY * near * (2.0 * uniform(SEED, 3 * number + d as u64) - 1.0)
    })
}
