//! What lies around the vertices of a mesh: their neighbours and, where it has none, normals.

use std::borrow::Cow;

use crate::error::Error;
use crate::measure::contours::refuse_damage;
use crate::mesh::TriMesh;
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// The neighbours of every vertex along edges, one vertex after another.
pub(super) struct Stars {
    /// Where those of a vertex begin, and the end of all.
    firsts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Stars {
    /// Triangles must name vertices that exist.
    pub(super) fn of(mesh: &TriMesh) -> Self {
        let both = |[u, v]: [u32; 2]| [[u, v], [v, u]];
        let mut ways: Vec<[u32; 2]> = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .flat_map(both)
            .filter(|[u, v]| u != v)
            .collect();
        ways.sort_unstable();
        ways.dedup();
        let mut firsts = vec![0; mesh.vertices.len() + 1];
        ways.iter().for_each(|&[u, _]| firsts[u as usize + 1] += 1);
        (1..firsts.len()).for_each(|v| firsts[v] += firsts[v - 1]);
        Self { firsts, neighbours: ways.into_iter().map(|[_, v]| v).collect() }
    }

    /// In ascending order.
    fn of_vertex(&self, v: u32) -> &[u32] {
        &self.neighbours[self.firsts[v as usize]..self.firsts[v as usize + 1]]
    }

    /// The vertices one and two edges away, each once, ascending.
    pub(super) fn around(&self, v: u32) -> Vec<u32> {
        let near = self.of_vertex(v);
        let mut all = near.to_vec();
        all.extend(near.iter().flat_map(|&u| self.of_vertex(u)));
        all.sort_unstable();
        all.dedup();
        all.retain(|&u| u != v);
        all
    }
}

/// The normals of a mesh, or those of Max (1999) where it has none; an error for what cannot be measured.
pub(super) fn normals_of(mesh: &TriMesh) -> Result<Cow<'_, [[f32; 3]]>, Error> {
    refuse_damage(mesh)?;
    let [normals, vertices] = [mesh.normals.len(), mesh.vertices.len()];
    if normals == vertices {
        return Ok(Cow::Borrowed(&mesh.normals));
    }
    if normals > 0 {
        return Err(Error::Mesh(format!("there are {normals} normals for {vertices} vertices")));
    }
    let mut sums = vec![[0.0; 3]; vertices];
    for &triangle in &mesh.triangles {
        let corners = mesh.corners(triangle);
        for n in 0..3 {
            let sum = &mut sums[triangle[n] as usize];
            *sum = add(*sum, turn(corners[n], corners[(n + 1) % 3], corners[(n + 2) % 3]));
        }
    }
    let unit = |sum: Vector| scale(sum, length(sum).recip()).map(|x| x as f32);
    let known =
        |normal: [f32; 3]| if normal.iter().all(|x| x.is_finite()) { normal } else { [0.0; 3] };
    Ok(Cow::Owned(sums.into_iter().map(|sum| known(unit(sum))).collect()))
}

/// What the corner at `place` adds to the normal there: nothing where a side has no length.
fn turn(place: Vector, next: Vector, last: Vector) -> Vector {
    let [u, v] = [next, last].map(|end| subtract(end, place));
    let factor = (dot(u, u) * dot(v, v)).recip();
    if factor.is_finite() { scale(cross(u, v), factor) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_one_and_two_edges_away() {
        // A strip of triangles 012, 123, 234, 345; the last names a vertex twice.
        let mut triangles: Vec<[u32; 3]> = (0..4).map(|n| [n, n + 1, n + 2]).collect();
        triangles.push([5, 5, 4]);
        let mesh = TriMesh { vertices: vec![[0.0; 3]; 7], triangles, normals: vec![] };
        let stars = Stars::of(&mesh);
        assert_eq!(stars.of_vertex(0), [1, 2]);
        assert_eq!(stars.around(0), [1, 2, 3, 4]);
        assert_eq!(stars.around(5), [1, 2, 3, 4]);
        assert!(stars.around(6).is_empty());
    }

    #[test]
    fn normals_on_a_sphere_are_exact() {
        // A fan of uneven triangles around the point (0, 0, 1), and a vertex of none.
        let ring = [0.1, 0.9, 1.7, 3.5, 4.1, 5.6].map(|angle: f64| {
            let tilt = 0.3 + 0.1 * angle.sin();
            [tilt.sin() * angle.cos(), tilt.sin() * angle.sin(), tilt.cos()]
        });
        let vertices = [vec![[0.0, 0.0, 1.0]], ring.to_vec(), vec![[9.0; 3]]].concat();
        let triangles = (0..6).map(|n| [0, 1 + n, 1 + (n + 1) % 6]).collect();
        let mesh = TriMesh { vertices, triangles, normals: vec![] };
        let normals = normals_of(&mesh).unwrap();
        assert!(normals[0][0].abs() < 1e-6 && normals[0][1].abs() < 1e-6 && normals[0][2] > 0.999);
        assert_eq!(normals[7], [0.0; 3]);
        let wrong = TriMesh { normals: vec![[0.0; 3]], ..mesh };
        assert!(normals_of(&wrong).unwrap_err().to_string().contains("1 normals for 8"));
    }
}
