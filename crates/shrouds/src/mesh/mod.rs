//! Stage 6 of 7, mesh: in a surface and its δ, out placed vertices, oriented triangles and normals.
//!
//! Uses: `grid`, `surface`, `network`.

mod dual;
mod fit;
mod midpoint;
mod normals;
mod primal;

pub use normals::{network_normals, slope_normals};

use crate::choice::choice;
use crate::network::Network;
use crate::parallel;
use crate::surface::Surface;
use crate::vector::{Vector, cross, dot, length, subtract};

/// A triangle mesh in world coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// Vertex positions, `N × 3`, world coordinates.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices, `T × 3`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals pointing outside, `N × 3`, or empty where none are known.
    pub normals: Vec<[f32; 3]>,
}

/// Which mesh stands for the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum MeshKind {
    /// One vertex per crossing; the 4\*-network is part of the mesh's edges.
    #[default]
    Primal,
    /// One vertex per patch, at the mean of its corners, and one polygon per crossing: separates the
    /// voxels as strictly, and its triangles have no small angles. Needs a closed border.
    Dual,
}

/// How patches are cut into triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Triangles {
    /// The legal triangles that fit the network's normals best; they depend on δ.
    #[default]
    Fitted,
    /// The same legal triangles for every δ.
    Fixed,
}

choice!(MeshKind, "surface":
    Primal = "primal", "One vertex per grid edge crossed; slice curves are mesh edges";
    Dual = "dual",
        "One vertex per cell patch: no small angles, for simulation and print. Needs a closed border";
);

choice!(Triangles, "triangles":
    Fitted = "fitted", "To fit the normals of the curves best";
    Fixed = "fixed", "The same for every position of the vertices";
);

impl TriMesh {
    /// The mesh of the separating surface S(δ) (equation 3), made as [`place_vertices`],
    /// [`network_normals`] and [`TriMesh::span`] do.
    ///
    /// # Panics
    /// When `delta` has not one value per vertex.
    pub fn place(
        surface: &Surface,
        network: &Network,
        delta: &[f64],
        kind: MeshKind,
        triangles: Triangles,
    ) -> Self {
        let vertices = place_vertices(surface, delta);
        let normals = network_normals(surface, network, &vertices);
        Self::span(surface, vertices, normals, kind, triangles)
    }

    /// The mesh whose surface has these vertices and normals, in world coordinates: one of each per
    /// vertex of the surface. They become those of a primal mesh.
    ///
    /// # Panics
    /// When there is not one position and one normal per vertex.
    pub fn span(
        surface: &Surface,
        vertices: Vec<[f64; 3]>,
        normals: Vec<[f32; 3]>,
        kind: MeshKind,
        triangles: Triangles,
    ) -> Self {
        let counts = [vertices.len(), normals.len()];
        assert_eq!(counts, [surface.vertex_count(); 2], "one position and one normal per vertex");
        let mut mesh = match kind {
            MeshKind::Primal => {
                let triangles = match triangles {
                    Triangles::Fixed => surface.fixed_triangles(),
                    Triangles::Fitted => primal::fitted(surface, &vertices, &normals),
                };
                Self { vertices, triangles, normals }
            }
            MeshKind::Dual => dual::mesh(surface, &vertices, &normals, triangles),
        };
        if surface.grid().is_mirrored() {
            parallel::update(&mut mesh.triangles, |_, triangle| triangle.swap(1, 2));
        }
        mesh
    }

    /// The three corners of a triangle.
    ///
    /// # Panics
    /// When the triangle names a vertex that does not exist.
    pub fn corners(&self, triangle: [u32; 3]) -> [[f64; 3]; 3] {
        triangle.map(|v| self.vertices[v as usize])
    }

    /// Area of the mesh in squared world units.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|&t| length(doubled_area(self.corners(t))) / 2.0).sum()
    }

    /// Volume enclosed by a closed mesh, in cubic world units; positive when it faces outwards.
    pub fn volume(&self) -> f64 {
        let Some(&origin) = self.vertices.first() else { return 0.0 };
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(*t).map(|p| subtract(p, origin));
            dot(a, cross(b, c)) / 6.0
        };
        self.triangles.iter().map(tetrahedron).sum()
    }
}

/// World positions of the vertices of S(δ) (equation 3).
///
/// `delta` has one value per vertex of the surface, 1 at the inside end of its grid edge.
///
/// # Panics
/// When `delta` has not one value per vertex.
pub fn place_vertices(surface: &Surface, delta: &[f64]) -> Vec<[f64; 3]> {
    assert_eq!(delta.len(), surface.vertex_count(), "one delta per vertex");
    place_by(surface, |v| delta[v])
}

/// World positions of the vertices by the δ of each.
fn place_by(surface: &Surface, delta: impl Fn(usize) -> f64 + Sync) -> Vec<Vector> {
    let mut vertices = vec![[0.0; 3]; surface.vertex_count()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut vertices, ends, |k, piece| {
        let numbered = (surface.slice_vertices(k).start as usize..).zip(surface.slice_crossings(k));
        for (vertex, (v, crossing)) in piece.iter_mut().zip(numbered) {
            *vertex = surface.grid().point(crossing.position(delta(v)));
        }
    });
    vertices
}

/// Normal of a triangle with twice its area as length.
fn doubled_area([a, b, c]: [Vector; 3]) -> Vector {
    cross(subtract(b, a), subtract(c, a))
}
