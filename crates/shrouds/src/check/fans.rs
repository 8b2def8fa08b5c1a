//! Whether the triangles around every vertex form one closed fan: the short way to the structure of a
//! closed manifold.
//!
//! Seen from a vertex each of its triangles is a spoke, from the corner after the vertex to the one
//! before it. Follow the spokes from the first: when that leads back to its start after all of them,
//! and not before, then each of the other corners begins one spoke and ends one. So there is one fan,
//! and every edge has two triangles that run through it in opposite directions.
//!
//! Eight vertices are followed side by side. Meshes that are no closed manifolds are left to
//! `structure`, which says where they are not.

use std::ops::Range;

use crate::check::structure::Component;
use crate::check::union::{find, join};
use crate::check::windows::Windows;
use crate::mesh::TriMesh;
use crate::parallel;

/// Vertices that are followed side by side.
const LANES: usize = 8;
/// The most triangles around a vertex.
const SPOKES: usize = 16;
/// Stretches that share their memory.
const GROUP: usize = 4;
/// The end of no spoke.
const NONE: u32 = u32::MAX;

/// The parts of a closed manifold in the order of their first triangle; nothing when the mesh is no
/// closed manifold, or one with very many triangles around a vertex.
pub(super) fn closed_parts(windows: &Windows) -> Option<Vec<Component>> {
    let closed = parallel::blocks(windows.count(), GROUP, |group| {
        let mut fans = Fans::new(windows.size());
        group.into_iter().all(|window| {
            fans.read(windows.vertices(window), windows.triangles(window)) && fans.are_closed()
        })
    });
    closed.into_iter().all(|closed| closed).then(|| parts(windows))
}

/// A spoke of each of eight vertices.
#[derive(Clone, Copy)]
struct Spokes {
    starts: [u32; LANES],
    ends: [u32; LANES],
}

/// The spokes of a stretch of vertices, eight vertices after the other.
struct Fans {
    /// Entry `SPOKES · g + n` holds spoke `n` of the vertices of group `g`.
    spokes: Vec<Spokes>,
    /// Number of spokes of every vertex.
    degrees: Vec<[u32; LANES]>,
}

impl Fans {
    fn new(size: usize) -> Self {
        let groups = size.div_ceil(LANES);
        let none = Spokes { starts: [0; LANES], ends: [0; LANES] };
        Self { spokes: vec![none; SPOKES * groups], degrees: vec![[0; LANES]; groups] }
    }

    /// Takes the spokes of the vertices in `range`. Returns whether there is room for all.
    fn read<'t>(
        &mut self,
        range: Range<usize>,
        triangles: impl Iterator<Item = &'t [[u32; 3]]>,
    ) -> bool {
        self.degrees.fill([0; LANES]);
        let (first, count) = (range.start as u32, range.len());
        let mut room = true;
        for &[a, b, c] in triangles.flatten() {
            for [v, start, end] in [[a, b, c], [b, c, a], [c, a, b]] {
                let v = v.wrapping_sub(first) as usize;
                if v >= count {
                    continue;
                }
                let (group, lane) = (v / LANES, v % LANES);
                let degree = self.degrees[group][lane] as usize;
                self.degrees[group][lane] += 1;
                room &= degree < SPOKES;
                let spokes = &mut self.spokes[SPOKES * group + degree % SPOKES];
                spokes.starts[lane] = start;
                spokes.ends[lane] = end;
            }
        }
        room
    }

    /// Whether the spokes of every vertex that has any form one closed fan.
    fn are_closed(&mut self) -> bool {
        let groups = self.spokes.as_chunks_mut::<SPOKES>().0.iter_mut();
        groups.zip(&self.degrees).all(|(spokes, degrees)| {
            let most = degrees.iter().fold(0, |most, &degree| most.max(degree));
            for (lane, &degree) in degrees.iter().enumerate() {
                for spoke in &mut spokes[degree as usize..most as usize] {
                    spoke.starts[lane] = NONE;
                }
            }
            are_closed(&spokes[..most as usize], degrees)
        })
    }
}

/// Whether eight fans are closed, of this many spokes each.
fn are_closed(spokes: &[Spokes], degrees: &[u32; LANES]) -> bool {
    let Some(&Spokes { starts: first, ends: mut here }) = spokes.first() else { return true };
    let mut wrong = [0; LANES];
    for passed in 1..=spokes.len() as u32 {
        let mut next = [0; LANES];
        let mut found = [0; LANES];
        for spoke in spokes {
            for lane in 0..LANES {
                let same = mask(spoke.starts[lane] == here[lane]);
                next[lane] |= same & spoke.ends[lane];
                found[lane] |= same;
            }
        }
        for lane in 0..LANES {
            let back = mask(here[lane] == first[lane]) ^ mask(passed == degrees[lane]);
            wrong[lane] |= back & mask(passed <= degrees[lane]);
            here[lane] = next[lane] | !found[lane];
        }
    }
    wrong == [0; LANES]
}

fn mask(set: bool) -> u32 {
    u32::from(set).wrapping_neg()
}

/// The parts of a closed manifold that hang together.
fn parts(windows: &Windows) -> Vec<Component> {
    let mesh = windows.mesh();
    let mut parents: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    let ends = (0..windows.count()).map(|window| windows.vertices(window).end);
    let across = parallel::pieces(&mut parents, ends, |window, parents| {
        join_within(windows, window, parents)
    });
    for [a, b] in across.into_iter().flatten() {
        join(&mut parents, a, b);
    }
    // Parents come first, so that theirs are the roots already.
    for v in 0..parents.len() {
        parents[v] = parents[parents[v] as usize];
    }
    count_parts(mesh, &mut parents)
}

/// Joins the vertices of a window; returns the edges that lead out of it, as far as they matter.
fn join_within(windows: &Windows, window: usize, parents: &mut [u32]) -> Vec<[u32; 2]> {
    let (first, count) = (windows.vertices(window).start as u32, parents.len() as u32);
    parents.iter_mut().for_each(|parent| *parent -= first);
    let mut across: Vec<[u32; 2]> = Vec::new();
    for corners in windows.triangles(window).flatten() {
        let [a, b, c] = corners.map(|v| v.wrapping_sub(first));
        if a >= count {
            continue;
        }
        for other in [b, c] {
            if other < count {
                if parents[a as usize] != parents[other as usize] {
                    join(parents, a, other);
                }
            } else {
                let edge = [find(parents, a), other].map(|v| v.wrapping_add(first));
                if across.last() != Some(&edge) {
                    across.push(edge);
                }
            }
        }
    }
    parents.iter_mut().for_each(|parent| *parent += first);
    across
}

/// Counts the triangles and vertices under each root.
fn count_parts(mesh: &TriMesh, roots: &mut [u32]) -> Vec<Component> {
    let mut components: Vec<Component> = Vec::new();
    // The place of each root among them, found at its first triangle.
    let mut places = std::collections::BTreeMap::new();
    let mut last = (NONE, 0);
    for (t, &[a, _, _]) in mesh.triangles.iter().enumerate() {
        let root = roots[a as usize];
        if root != last.0 {
            let place = *places.entry(root).or_insert_with(|| {
                components.push(Component { first_triangle: t as u32, triangles: 0, euler: 0 });
                components.len() - 1
            });
            last = (root, place);
        }
        components[last.1].triangles += 1;
    }
    for &root in roots.iter() {
        if root != last.0 {
            match places.get(&root) {
                Some(&place) => last = (root, place),
                None => continue, // a vertex without triangles
            }
        }
        components[last.1].euler += 1;
    }
    // A closed manifold has three edges for two triangles.
    components.iter_mut().for_each(|part| part.euler -= part.triangles as i64 / 2);
    components
}
