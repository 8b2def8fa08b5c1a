//! The mesh with every vertex in the middle of its grid edge.

use crate::mesh::{TriMesh, place_by};
use crate::parallel;
use crate::surface::Surface;

impl TriMesh {
    /// The separating surface with δ = ½ everywhere, without normals: the midpoint surface of
    /// hole-free marching cubes, by the fixed triangles. What placing makes of the same δ, in the
    /// time that writing it down takes.
    pub fn midpoint(surface: &Surface) -> Self {
        let vertices = place_by(surface, |_| 0.5);
        let mut triangles = surface.fixed_triangles();
        if surface.grid().is_mirrored() {
            parallel::update(&mut triangles, |_, triangle| triangle.swap(1, 2));
        }
        Self { vertices, triangles, normals: Vec::new() }
    }
}
