//! The edges of any triangle mesh with the triangles at each.

use crate::mesh::TriMesh;

/// An edge as one of its triangles sees it; in a sorted list the triangles of an edge stand together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Edge {
    /// Its two vertices, the smaller first.
    pub(super) ends: [u32; 2],
    /// The triangle.
    pub(super) triangle: u32,
    /// Whether the triangle runs through it from the smaller vertex to the larger.
    pub(super) rises: bool,
}

/// The edges of the triangles with three different corners, sorted.
pub(super) fn edges(mesh: &TriMesh) -> Vec<Edge> {
    let mut edges = Vec::with_capacity(3 * mesh.triangles.len());
    for (triangle, &[a, b, c]) in (0..).zip(&mesh.triangles) {
        if a != b && b != c && c != a {
            edges.extend([[a, b], [b, c], [c, a]].map(|[from, to]| Edge {
                ends: [from.min(to), from.max(to)],
                triangle,
                rises: from < to,
            }));
        }
    }
    edges.sort_unstable();
    edges
}

/// The triangles of each edge together.
pub(super) fn by_edge(edges: &[Edge]) -> impl Iterator<Item = &[Edge]> {
    edges.chunk_by(|a, b| a.ends == b.ends)
}
