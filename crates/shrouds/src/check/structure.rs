//! What a triangle mesh is by itself: edges, fans, components, area and volume.
//!
//! One pass over the vertices sees everything: the triangles around a vertex, sorted by their other
//! corners, give the edges that leave it, and joining them across those edges gives its fans. Memory
//! is a list of the triangles around each vertex and a few words per triangle. Closed manifolds, which
//! most meshes are, go a shorter way: see `fans`.

use crate::check::fans;
use crate::check::found::Found;
use crate::check::measure::measure;
use crate::check::predicates::{COORDINATE_LIMIT, Corners};
use crate::check::union::{find, join};
use crate::check::windows::Windows;
use crate::error::Error;
use crate::mesh::TriMesh;
use crate::parallel;

/// Triangles per block of parallel work.
const BLOCK: usize = 1 << 14;

/// Edges as pairs of vertices.
pub(super) type Edges = Vec<[u32; 2]>;

/// What a mesh is by itself. Edges and fans are those of the triangles with three different corners;
/// a triangle that names a vertex twice is degenerate and no more than an edge.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Structure {
    /// Vertices that at least one triangle with three different corners uses.
    pub vertices: u64,
    /// All other vertices.
    pub unused_vertices: u64,
    /// Edges: pairs of vertices that at least one triangle joins.
    pub edges: u64,
    /// Triangles, degenerate ones included.
    pub triangles: u64,
    /// Edges of one triangle, as pairs of vertices, the smaller first.
    pub boundary_edges: Found<[u32; 2]>,
    /// Edges of more than two triangles.
    pub non_manifold_edges: Found<[u32; 2]>,
    /// Edges that their two triangles run through in the same direction.
    pub inconsistent_edges: Found<[u32; 2]>,
    /// Vertices whose triangles form more than one fan: not all of them hang together by edges at
    /// the vertex.
    pub non_manifold_vertices: Found<u32>,
    /// Triangles whose area is exactly zero, or that name a vertex twice.
    pub degenerate_triangles: Found<u32>,
    /// Triangles with an area above zero but below 1e-9 of the mean area.
    pub sliver_triangles: Found<u32>,
    /// The parts that hang together by edges, in the order of their first triangle.
    pub components: Vec<Component>,
    /// Enclosed volume in cubic world units, positive when the normals point out. It means something
    /// for a closed mesh only.
    pub volume: f64,
    /// Sum of the areas of all triangles in square world units.
    pub area: f64,
}

/// A part of a mesh that hangs together by edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Component {
    /// Its first triangle.
    pub first_triangle: u32,
    /// Its number of triangles.
    pub triangles: u64,
    /// Vertices − edges + triangles, each fan with a vertex of its own: 2 for a sphere, 0 for a
    /// torus, 1 for a disc.
    pub euler: i64,
}

impl Structure {
    /// The Euler characteristic of all components together.
    pub fn euler(&self) -> i64 {
        self.components.iter().map(|component| component.euler).sum()
    }

    /// Whether every edge has two triangles that run through it in opposite directions.
    pub fn is_closed(&self) -> bool {
        self.boundary_edges.is_empty()
            && self.non_manifold_edges.is_empty()
            && self.inconsistent_edges.is_empty()
    }
}

/// Counts what the mesh is made of and finds what keeps it from being an oriented manifold.
///
/// ```
/// use shrouds::{TriMesh, check::structure};
///
/// let mesh = TriMesh {
///     vertices: vec![[0.0; 3], [6.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
///     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
///     normals: vec![],
/// };
/// let structure = structure(&mesh)?;
/// assert!(structure.is_closed());
/// assert_eq!(structure.euler(), 2);
/// assert!((structure.volume - 1.0).abs() < 1e-12);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when a triangle names a vertex that does not exist, a coordinate is not finite or
/// beyond 1e90, or there are more than 2³²/3 triangles.
pub fn structure(mesh: &TriMesh) -> Result<Structure, Error> {
    Ok(examine(mesh)?.0)
}

/// [`structure`], all boundary edges, and the windows of a closed manifold where it has any.
pub(super) fn examine(mesh: &TriMesh) -> Result<(Structure, Edges, Option<Windows<'_>>), Error> {
    refuse_damage(mesh)?;
    let windows = Windows::new(mesh);
    let parts = windows.and_then(|windows| Some((fans::closed_parts(&windows)?, windows)));
    let (mut structure, boundary, windows) = match parts {
        Some((components, windows)) => (closed(mesh, components), Vec::new(), Some(windows)),
        None => {
            let (structure, boundary) = walk(mesh);
            (structure, boundary, None)
        }
    };
    structure.unused_vertices = mesh.vertices.len() as u64 - structure.vertices;
    structure.triangles = mesh.triangles.len() as u64;
    measure(mesh, &mut structure);
    Ok((structure, boundary, windows))
}

/// Edges, fans and components of any mesh, and all boundary edges.
pub(super) fn walk(mesh: &TriMesh) -> (Structure, Edges) {
    let mut walk = Walk::new(mesh);
    walk.run(mesh);
    walk.finish(mesh)
}

/// The structure of a closed manifold with these components.
fn closed(mesh: &TriMesh, components: Vec<Component>) -> Structure {
    let edges = mesh.triangles.len() as u64 / 2 * 3;
    let euler: i64 = components.iter().map(|component| component.euler).sum();
    let vertices = (euler + mesh.triangles.len() as i64 / 2) as u64;
    Structure { vertices, edges, components, ..Structure::default() }
}

/// The corners of triangle `index`.
#[inline]
pub(super) fn corners(mesh: &TriMesh, index: usize) -> Corners {
    let [a, b, c] = mesh.triangles[index];
    [mesh.vertices[a as usize], mesh.vertices[b as usize], mesh.vertices[c as usize]]
}

pub(super) fn refuse_damage(mesh: &TriMesh) -> Result<(), Error> {
    let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
    if triangles > u32::MAX as usize / 3 {
        return Err(Error::Mesh(format!("it has {triangles} triangles; check it in parts")));
    }
    let unusable = |point: &[f64; 3]| {
        let usable = point.map(|x| x.abs() <= COORDINATE_LIMIT);
        !(usable[0] & usable[1] & usable[2])
    };
    if let Some(v) = first(&mesh.vertices, unusable) {
        let point = mesh.vertices[v];
        return Err(Error::Mesh(format!("vertex {v} lies at {point:?}; all must be below 1e90")));
    }
    let dangling = |&[a, b, c]: &[u32; 3]| a.max(b).max(c) as usize >= vertices;
    match first(&mesh.triangles, dangling) {
        Some(t) => Err(Error::Mesh(format!(
            "triangle {t} joins vertices {:?}, but there are only {vertices}",
            mesh.triangles[t]
        ))),
        None => Ok(()),
    }
}

/// The first item that is wrong.
fn first<T: Sync>(items: &[T], is_wrong: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let blocks = parallel::blocks(items.len(), BLOCK, |range| {
        items[range].iter().fold(false, |any, item| any | is_wrong(item))
    });
    let block = blocks.into_iter().position(|any| any)?;
    items[block * BLOCK..].iter().position(is_wrong).map(|n| block * BLOCK + n)
}

/// A triangle seen from one of its vertices along one of its edges.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spoke {
    /// The other end of the edge.
    other: u32,
    /// Which of the triangles around the vertex.
    place: u32,
    /// Whether the triangle runs through the edge away from the vertex.
    leaves: bool,
}

/// The pass over all vertices.
struct Walk {
    /// The triangles around vertex `v` are `around[start[v]..start[v + 1]]`.
    start: Vec<u32>,
    around: Vec<u32>,
    /// Union-find over triangles; a root is the first triangle of its component.
    joined: Vec<u32>,
    /// Each triangle's share of the Euler characteristic of its component.
    euler: Vec<i32>,
    boundary: Edges,
    structure: Structure,
}

impl Walk {
    fn new(mesh: &TriMesh) -> Self {
        let mut start = vec![0u32; mesh.vertices.len() + 1];
        for &v in proper_triangles(mesh).flat_map(|(_, corners)| corners) {
            start[v as usize + 1] += 1;
        }
        let mut total = 0;
        for count in &mut start {
            total += *count;
            *count = total;
        }
        // Filled from the back, each start moves from the end of its list to the beginning.
        let mut around = vec![0; total as usize];
        for (t, corners) in proper_triangles(mesh).rev() {
            for &v in corners {
                let slot = &mut start[v as usize + 1];
                *slot -= 1;
                around[*slot as usize] = t as u32;
            }
        }
        start.remove(0);
        start.push(total);
        let count = mesh.triangles.len();
        Self {
            start,
            around,
            joined: (0..count as u32).collect(),
            euler: vec![1; count],
            boundary: Vec::new(),
            structure: Structure::default(),
        }
    }

    fn run(&mut self, mesh: &TriMesh) {
        let (mut spokes, mut fans) = (Vec::new(), Vec::new());
        for v in 0..mesh.vertices.len() as u32 {
            let range = self.start[v as usize] as usize..self.start[v as usize + 1] as usize;
            spokes.clear();
            for (place, &t) in self.around[range.clone()].iter().enumerate() {
                let [next, previous] = others(mesh.triangles[t as usize], v);
                let place = place as u32;
                spokes.push(Spoke { other: next, place, leaves: true });
                spokes.push(Spoke { other: previous, place, leaves: false });
            }
            spokes.sort_unstable();
            fans.clear();
            fans.extend(0..range.len() as u32);
            for edge in spokes.chunk_by(|a, b| a.other == b.other) {
                edge.iter().for_each(|spoke| join(&mut fans, edge[0].place, spoke.place));
                if v < edge[0].other {
                    self.count_edge(v, edge, range.start);
                }
            }
            self.count_fans(v, &fans, range.start);
        }
    }

    /// Each edge is counted at its smaller vertex.
    fn count_edge(&mut self, v: u32, edge: &[Spoke], around: usize) {
        let triangle = |spoke: &Spoke| self.around[around + spoke.place as usize];
        let ends = [v, edge[0].other];
        let first = triangle(&edge[0]);
        self.structure.edges += 1;
        self.euler[first as usize] -= 1;
        match edge {
            [_] => {
                self.structure.boundary_edges.push(ends);
                self.boundary.push(ends);
            }
            [a, b] if a.leaves == b.leaves => self.structure.inconsistent_edges.push(ends),
            [_, _] => {}
            _ => self.structure.non_manifold_edges.push(ends),
        }
        for spoke in &edge[1..] {
            let other = self.around[around + spoke.place as usize];
            join(&mut self.joined, first, other);
        }
    }

    fn count_fans(&mut self, v: u32, fans: &[u32], around: usize) {
        let roots = fans.iter().enumerate().filter(|&(place, &root)| place == root as usize);
        let mut count = 0;
        for (place, _) in roots {
            count += 1;
            self.euler[self.around[around + place] as usize] += 1;
        }
        self.structure.vertices += u64::from(count > 0);
        if count > 1 {
            self.structure.non_manifold_vertices.push(v);
        }
    }

    fn finish(mut self, mesh: &TriMesh) -> (Structure, Edges) {
        let components = &mut self.structure.components;
        // Euler shares go to the roots; a root is the smallest of its component, so it comes first.
        let mut place = vec![0u32; self.joined.len()];
        for (t, _) in proper_triangles(mesh) {
            let t = t as u32;
            let root = find(&mut self.joined, t);
            if root == t {
                place[t as usize] = components.len() as u32;
                components.push(Component { first_triangle: t, triangles: 0, euler: 0 });
            }
            let component = &mut components[place[root as usize] as usize];
            component.triangles += 1;
            component.euler += i64::from(self.euler[t as usize]);
        }
        (self.structure, self.boundary)
    }
}

/// The triangles with three different corners.
fn proper_triangles(mesh: &TriMesh) -> impl DoubleEndedIterator<Item = (usize, &[u32; 3])> {
    mesh.triangles.iter().enumerate().filter(|(_, [a, b, c])| a != b && b != c && c != a)
}

/// The corners after and before `v`.
fn others([a, b, c]: [u32; 3], v: u32) -> [u32; 2] {
    if v == a {
        [b, c]
    } else if v == b {
        [c, a]
    } else {
        [a, b]
    }
}
