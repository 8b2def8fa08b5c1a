//! The mesh with every vertex in the middle of its grid edge.

use crate::mesh::TriMesh;
use crate::parallel;
use crate::surface::Surface;

impl TriMesh {
    /// The separating surface with δ = ½ everywhere, without normals: the midpoint surface of
    /// hole-free marching cubes, by the fixed triangles. What placing makes of the same δ, in the
    /// time that writing it down takes.
    pub fn midpoint(surface: &Surface) -> Self {
        let mut vertices = vec![[0.0; 3]; surface.vertex_count()];
        let slices = 0..surface.slice_count();
        let ends = slices.map(|k| surface.slice_vertices(k).end as usize);
        parallel::pieces(&mut vertices, ends, |k, vertices| {
            for (vertex, crossing) in vertices.iter_mut().zip(surface.slice_crossings(k)) {
                *vertex = surface.grid().point(crossing.position(0.5));
            }
        });
        let mut triangles = surface.fixed_triangles();
        if surface.grid().is_mirrored() {
            parallel::update(&mut triangles, |_, triangle| triangle.swap(1, 2));
        }
        Self { vertices, triangles, normals: Vec::new() }
    }
}
