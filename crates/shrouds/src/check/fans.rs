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
use crate::check::union::join;
use crate::check::windows::Windows;
use crate::mesh::TriMesh;
use crate::parallel;

/// Vertices that are followed side by side.
const LANES: usize = 8;
/// The most triangles around a vertex; few have more than half of them.
const SPOKES: usize = 2 * HALF;
const HALF: usize = 8;
/// Stretches that share their memory.
const GROUP: usize = 4;
/// Triangles per block of parallel work.
const BLOCK: usize = 1 << 14;
/// The end of no spoke.
const NONE: u32 = u32::MAX;

/// The parts of a closed manifold in the order of their first triangle; nothing when the mesh is no
/// closed manifold, or one with very many triangles around a vertex.
pub(super) fn closed_parts(windows: &Windows) -> Option<Vec<Component>> {
    let count = windows.mesh().vertices.len();
    let mut parents = vec![0; count];
    let ends = (0..windows.count())
        .step_by(GROUP)
        .map(|window| windows.vertices((window + GROUP).min(windows.count()) - 1).end);
    let closed = parallel::pieces(&mut parents, ends, |group, parents| {
        let mut fans = Fans::new(windows.size());
        let group = group * GROUP..((group + 1) * GROUP).min(windows.count());
        let first = windows.vertices(group.start).start;
        group.into_iter().all(|window| {
            let range = windows.vertices(window);
            let parents = &mut parents[range.start - first..range.end - first];
            fans.read(range.clone(), windows.triangles(window))
                && fans.are_closed(range.start as u32, parents)
        })
    });
    closed.into_iter().all(|closed| closed).then(|| parts(windows.mesh(), parents))
}

/// A spoke of each of eight vertices.
#[derive(Clone, Copy)]
struct Spokes {
    starts: [u32; LANES],
    ends: [u32; LANES],
}

/// The spokes of a stretch of vertices, eight vertices after the other.
struct Fans {
    /// Entry `g` holds the first half of the spokes of the vertices of group `g`.
    first: Vec<[Spokes; HALF]>,
    second: Vec<[Spokes; HALF]>,
    /// Number of spokes of every vertex.
    degrees: Vec<[u32; LANES]>,
}

impl Fans {
    fn new(size: usize) -> Self {
        let groups = size.div_ceil(LANES);
        let none = [Spokes { starts: [0; LANES], ends: [0; LANES] }; HALF];
        Self {
            first: vec![none; groups],
            second: vec![none; groups],
            degrees: vec![[0; LANES]; groups],
        }
    }

    /// Takes the spokes of the vertices in `range`. Returns whether there is room for all, and every
    /// triangle has three corners.
    fn read<'t>(
        &mut self,
        range: Range<usize>,
        triangles: impl Iterator<Item = &'t [[u32; 3]]>,
    ) -> bool {
        self.degrees.fill([0; LANES]);
        let degrees = self.degrees.as_flattened_mut();
        let (first, count) = (range.start as u32, range.len());
        let degrees = &mut degrees[..count];
        let (mut most, mut proper) = (0, true);
        for &[a, b, c] in triangles.flatten() {
            proper &= (a != b) & (b != c) & (c != a);
            for [v, start, end] in [[a, b, c], [b, c, a], [c, a, b]] {
                let v = v.wrapping_sub(first) as usize;
                if let Some(degree) = degrees.get_mut(v) {
                    let spoke = *degree as usize;
                    *degree += 1;
                    most = most.max(*degree);
                    let half = if spoke < HALF { &mut self.first } else { &mut self.second };
                    let entry = &mut half[v / LANES][spoke % HALF];
                    entry.starts[v % LANES] = start;
                    entry.ends[v % LANES] = end;
                }
            }
        }
        proper && most as usize <= SPOKES
    }

    /// Whether the spokes of every vertex from `first` on that has any form one closed fan. Gives
    /// every vertex the smallest one near it, or itself.
    fn are_closed(&self, first: u32, nearest: &mut [u32]) -> bool {
        let mut all = true;
        for (n, nearest) in nearest.chunks_mut(LANES).enumerate() {
            let degrees = &self.degrees[n];
            let most = degrees.iter().fold(0, |most, &degree| most.max(degree));
            let spokes = [&self.first[n], &self.second[n]];
            let (closed, least) = match most {
                0..=6 => follow::<6>(spokes, degrees),
                7..=8 => follow::<8>(spokes, degrees),
                9..=10 => follow::<10>(spokes, degrees),
                11..=12 => follow::<12>(spokes, degrees),
                _ => follow::<SPOKES>(spokes, degrees),
            };
            all &= closed;
            let own = first + (n * LANES) as u32;
            for (lane, nearest) in nearest.iter_mut().enumerate() {
                *nearest = least[lane].min(own + lane as u32);
            }
        }
        all
    }
}

/// Whether eight fans of up to `MOST` spokes are closed, and the smallest vertex of each.
#[inline(never)]
fn follow<const MOST: usize>(
    spokes: [&[Spokes; HALF]; 2],
    degrees: &[u32; LANES],
) -> (bool, [u32; LANES]) {
    // Spokes that a fan does not have begin nowhere.
    let (mut starts, mut ends) = ([[NONE; LANES]; MOST], [[NONE; LANES]; MOST]);
    let mut least = [NONE; LANES];
    for n in 0..MOST {
        let spokes = &spokes[n / HALF][n % HALF];
        for lane in 0..LANES {
            starts[n][lane] = spokes.starts[lane] | !mask((n as u32) < degrees[lane]);
            ends[n][lane] = spokes.ends[lane];
            least[lane] = least[lane].min(starts[n][lane]);
        }
    }
    let mut here = ends[0];
    let mut wrong = [0; LANES];
    for passed in 1..=MOST as u32 {
        let (mut next, mut found) = ([0; LANES], [0; LANES]);
        for n in 0..MOST {
            for lane in 0..LANES {
                let same = mask(starts[n][lane] == here[lane]);
                next[lane] |= same & ends[n][lane];
                found[lane] |= same;
            }
        }
        for lane in 0..LANES {
            let back = mask(here[lane] == starts[0][lane]) ^ mask(passed == degrees[lane]);
            wrong[lane] |= back & mask(passed <= degrees[lane]);
            here[lane] = next[lane] | !found[lane];
        }
    }
    (wrong == [0; LANES], least)
}

fn mask(set: bool) -> u32 {
    u32::from(set).wrapping_neg()
}

/// The parts of a closed manifold that hang together, by a vertex near every vertex, none larger
/// than itself.
fn parts(mesh: &TriMesh, mut parents: Vec<u32>) -> Vec<Component> {
    let roots = flatten(&mut parents);
    if roots > 1 {
        let blocks = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
            let mut apart: Vec<[u32; 2]> = Vec::new();
            for corners in &mesh.triangles[range] {
                let [a, b, c] = corners.map(|v| parents[v as usize]);
                if a != b || a != c {
                    apart.extend([[a, b], [a, c]]);
                }
            }
            apart.dedup();
            apart
        });
        for [a, b] in blocks.into_iter().flatten() {
            join(&mut parents, a, b);
        }
        flatten(&mut parents);
    }
    count_parts(mesh, &parents)
}

/// Makes every vertex name the first of its set; returns the number of sets.
fn flatten(parents: &mut [u32]) -> usize {
    let mut roots = 0;
    // Parents come first, so that theirs are the roots already.
    for v in 0..parents.len() {
        let parent = parents[v] as usize;
        roots += usize::from(parent == v);
        parents[v] = parents[parent];
    }
    roots
}

/// Counts the triangles and vertices under each root.
fn count_parts(mesh: &TriMesh, roots: &[u32]) -> Vec<Component> {
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
    for &root in roots {
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

#[cfg(test)]
pub(in crate::check) mod tests {
    use super::*;
    use crate::check::structure::{Structure, examine, walk};
    use crate::grid::Grid;
    use crate::mesh::{MeshKind, Triangles};
    use crate::network::Network;
    use crate::random::uniform;
    use crate::surface::Surface;
    use crate::volume::{Border, FaceRule, Occupancy, phantom};

    pub(in crate::check) const OBLIQUE: [[f64; 4]; 3] =
        [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];

    pub(in crate::check) fn mesh_of(
        volume: &Occupancy,
        faces: FaceRule,
        kind: MeshKind,
    ) -> TriMesh {
        let surface = Surface::extract(volume, faces, Border::Closed).unwrap();
        let network = Network::trace(&surface);
        let delta: Vec<f64> = (0..surface.vertex_count())
            .map(|v| 0.1 + 0.8 * ((v * 37 % 101) as f64) / 101.0)
            .collect();
        TriMesh::place(&surface, &network, &delta, kind, Triangles::Fitted)
    }

    pub(in crate::check) fn noise(dims: [usize; 3], density: f64) -> Occupancy {
        phantom::noise(&Grid::with_affine(dims, OBLIQUE).unwrap(), density, 5).unwrap()
    }

    fn is_manifold(structure: &Structure) -> bool {
        structure.is_closed() && structure.non_manifold_vertices.is_empty()
    }

    /// The same mesh with one or two things changed.
    pub(in crate::check) fn damaged(
        mesh: &TriMesh,
        below: &mut impl FnMut(usize) -> usize,
    ) -> TriMesh {
        let mut mesh = mesh.clone();
        let (t, v) = (below(mesh.triangles.len()), below(mesh.vertices.len()));
        match below(8) {
            0 => mesh.triangles[t].swap(0, 1),
            1 => drop(mesh.triangles.remove(t)),
            2 => mesh.triangles.push(mesh.triangles[t]),
            3 => mesh.triangles[t][below(3)] = v as u32,
            4 => mesh.vertices[v] = mesh.vertices[below(mesh.vertices.len())],
            5 => mesh.vertices[v][below(3)] += 0.3,
            6 => mesh.vertices[v][below(3)] += 1e-3,
            _ => {
                let near = (v as u32 + 1).min(mesh.vertices.len() as u32 - 1);
                // Two vertices become one, or change their places.
                let both = [v as u32, near];
                for corner in mesh.triangles.as_flattened_mut() {
                    if *corner == near {
                        *corner = v as u32;
                    } else if *corner == v as u32 && below(2) == 0 {
                        *corner = both[below(2)];
                    }
                }
            }
        }
        mesh
    }

    /// Random whole numbers below what is asked for.
    pub(in crate::check) fn random(seed: u64) -> impl FnMut(usize) -> usize {
        let mut index = 0;
        move |count| {
            index += 1;
            (uniform(seed, index) * count as f64) as usize
        }
    }

    #[test]
    fn the_short_way_to_the_structure_finds_what_the_long_one_does() {
        for (density, kind) in [
            (0.08, MeshKind::Primal),
            (0.3, MeshKind::Primal),
            (0.5, MeshKind::Primal),
            (0.3, MeshKind::Dual),
        ] {
            let mesh = mesh_of(&noise([20, 18, 150], density), FaceRule::Separate, kind);
            let windows = Windows::new(&mesh).unwrap();
            assert!(
                density < 0.1 || kind == MeshKind::Dual || windows.count() > 2,
                "{} windows",
                windows.count()
            );
            let parts = closed_parts(&windows).unwrap();
            let (long, boundary) = walk(&mesh);
            assert!(boundary.is_empty() && is_manifold(&long));
            assert!(parts.len() > 20 && parts == long.components, "{} parts", parts.len());
            let short = examine(&mesh).unwrap().0;
            assert_eq!((short.vertices, short.edges), (long.vertices, long.edges));
        }
    }

    #[test]
    fn nothing_but_a_closed_manifold_goes_the_short_way() {
        let mesh = mesh_of(&noise([9, 8, 7], 0.4), FaceRule::Join, MeshKind::Primal);
        let mut below = random(3);
        let mut refused = 0;
        for _ in 0..400 {
            let mesh = damaged(&mesh, &mut below);
            let short = Windows::new(&mesh).and_then(|windows| closed_parts(&windows));
            let long = walk(&mesh).0;
            assert!(short.is_none() || is_manifold(&long));
            if let Some(parts) = short {
                assert_eq!(parts, long.components);
            } else {
                refused += 1;
            }
        }
        assert!(refused > 100, "{refused} of 400");
    }
}
