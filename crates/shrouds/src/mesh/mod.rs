//! Stage 6 of 7, mesh: in a surface and its δ, out placed vertices, oriented triangles and normals.
//!
//! Uses: `grid`, `surface`, `network`.

/// A triangle mesh in world coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// Vertex positions, `N × 3`, world coordinates.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices, `T × 3`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals pointing outside, `N × 3`, or empty where none are known.
    pub normals: Vec<[f64; 3]>,
}
