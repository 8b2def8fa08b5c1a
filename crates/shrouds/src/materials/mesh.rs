//! The mesh of all interfaces.

use std::collections::BTreeMap;

use crate::mesh::TriMesh;
use crate::vector::{cross, length, subtract};

/// Triangles between two labels each, in world coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MaterialMesh {
    /// Vertex positions, `N × 3`: crossings, then junction points, then cell points.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices, `T × 3`, counter-clockwise seen from the second label: the normal points from
    /// the first to the second.
    pub triangles: Vec<[u32; 3]>,
    /// The labels on both sides of every triangle, `T × 2`: the background second, else ascending.
    pub pairs: Vec<[i64; 2]>,
    /// Where three or more labels meet: edges of the mesh, `L × 2`.
    pub lines: Vec<[u32; 2]>,
}

impl MaterialMesh {
    /// The labels that bound triangles, ascending; the background is one of them.
    pub fn labels(&self) -> Vec<i64> {
        let mut labels: Vec<i64> = self.contacts().into_keys().flatten().collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    }

    /// The boundary of a label: the very triangles it shares with its neighbours, counter-clockwise seen
    /// from outside, with the vertices they use, in their order. Empty for a label that is not there.
    pub fn closed_mesh(&self, label: i64) -> TriMesh {
        let own =
            self.triangles.iter().zip(&self.pairs).filter_map(|(&[a, b, c], pair)| match *pair {
                [first, _] if first == label => Some([a, b, c]),
                [_, second] if second == label => Some([a, c, b]),
                _ => None,
            });
        let mut triangles: Vec<[u32; 3]> = own.collect();
        let mut numbers = vec![u32::MAX; self.vertices.len()];
        for &v in triangles.as_flattened() {
            numbers[v as usize] = 0;
        }
        let mut vertices = Vec::new();
        for (number, &vertex) in numbers.iter_mut().zip(&self.vertices).filter(|(n, _)| **n == 0) {
            *number = vertices.len() as u32;
            vertices.push(vertex);
        }
        for v in triangles.as_flattened_mut() {
            *v = numbers[*v as usize];
        }
        TriMesh { vertices, triangles, normals: Vec::new() }
    }

    /// For each pair of labels that touch the number of their triangles and the area, in squared world
    /// units.
    pub fn contacts(&self) -> BTreeMap<[i64; 2], (usize, f64)> {
        let mut contacts = BTreeMap::new();
        for (triangle, &pair) in self.triangles.iter().zip(&self.pairs) {
            let [a, b, c] = triangle.map(|v| self.vertices[v as usize]);
            let contact: &mut (usize, f64) = contacts.entry(pair).or_default();
            contact.0 += 1;
            contact.1 += 0.5 * length(cross(subtract(b, a), subtract(c, a)));
        }
        contacts
    }
}
