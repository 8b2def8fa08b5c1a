//! What was found while a mesh was voxelised.

use crate::check::Found;

/// How the sides of the lattice points were decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Method {
    /// By counting crossings of lattice lines exactly: the mesh has no holes.
    #[default]
    Exact,
    /// By the generalized winding number.
    Generalized,
}

/// How a mesh was voxelised, and what is wrong with it.
///
/// Edges are pairs of vertices of the mesh, the smaller first. Where a mesh is not closed, vertices at
/// the same place count as one, which goes by the smallest of their numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VoxelizeReport {
    /// How the sides were decided.
    pub method: Method,
    /// Edges with one triangle: the rims of the holes.
    pub boundary_edges: Found<[u32; 2]>,
    /// Edges with more than two triangles.
    pub non_manifold_edges: Found<[u32; 2]>,
    /// Edges whose two triangles face opposite sides.
    pub inconsistent_edges: Found<[u32; 2]>,
    /// Vertices that lie exactly where others do and were taken to be those.
    pub joined_vertices: u64,
    /// Edges with one triangle that are none any more since those vertices were joined.
    pub joined_edges: u64,
    /// Triangles that others repeat with the same corners and orientation; each was counted once.
    pub repeated_triangles: u64,
    /// Triangles that were turned because most of what they hang together with faces the other side.
    pub turned_triangles: u64,
    /// Whether the mesh faces inwards, so that the volume it encloses is negative.
    pub inside_out: bool,
    /// Volume the mesh encloses in cubic world units, with its holes closed by caps of triangles;
    /// parts enclosed twice count twice.
    pub enclosed_volume: f64,
    /// Lattice points whose generalized winding number lies within 0.1 of where the rule puts the
    /// surface, as indices along x, y, z: they lie close to where a hole was closed.
    pub doubtful: Found<[usize; 3]>,
}

impl VoxelizeReport {
    /// Whether the mesh is closed: every edge has two triangles that face the same side.
    pub fn is_closed(&self) -> bool {
        self.boundary_edges.is_empty()
            && self.non_manifold_edges.is_empty()
            && self.inconsistent_edges.is_empty()
    }

    /// What a user should know, a sentence each; nothing for a closed mesh that faces outwards.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let edges = [
            (&self.boundary_edges, "edges with one triangle, the rims of holes"),
            (&self.non_manifold_edges, "edges with more than two triangles"),
            (&self.inconsistent_edges, "edges whose triangles face opposite sides"),
        ];
        for (found, what) in edges {
            if let Some([a, b]) = found.first.first() {
                let count = found.count;
                notes.push(format!("{count} {what}; first: between vertices {a} and {b}"));
            }
        }
        if self.joined_vertices > 0 {
            let (vertices, edges) = (self.joined_vertices, self.joined_edges);
            notes.push(format!(
                "{vertices} vertices lie where others do and were joined with them, which closed \
                 {edges} edges with one triangle"
            ));
        }
        if self.repeated_triangles > 0 {
            notes.push(format!("{} triangles repeat others", self.repeated_triangles));
        }
        if self.turned_triangles > 0 {
            let count = self.turned_triangles;
            notes.push(format!("{count} triangles were turned to face as those around them do"));
        }
        if self.inside_out {
            notes.push("the mesh is inside out and was turned".into());
        }
        if let Some([i, j, k]) = self.doubtful.first.first() {
            notes.push(format!(
                "{} lattice points lie where a hole was closed and could be on either side; first: [{i}, {j}, {k}]",
                self.doubtful.count
            ));
        }
        notes
    }
}
