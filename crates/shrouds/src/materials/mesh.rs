//! The mesh of all interfaces.

use std::collections::BTreeMap;

use crate::mesh::TriMesh;
use crate::vector::{cross, length, subtract};

/// Triangles between two labels each, in world coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MaterialMesh {
    /// All triangles, counter-clockwise seen from the second label: the normal points from the first to
    /// the second. Vertices are the crossings, then the junction points, then the cell points. There
    /// are normals only where there are no junctions.
    pub surface: TriMesh,
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
        let sides = self.pairs.iter().enumerate();
        let sides = sides.filter_map(|(n, &[first, second])| match label {
            _ if first == label => Some((n, false)),
            _ if second == label => Some((n, true)),
            _ => None,
        });
        self.gathered(sides)
    }

    /// The boundaries of all labels, ascending, that of the background among them.
    pub fn closed_meshes(&self) -> impl Iterator<Item = (i64, TriMesh)> {
        let mut sides: BTreeMap<i64, Vec<(usize, bool)>> = BTreeMap::new();
        for (n, &[first, second]) in self.pairs.iter().enumerate() {
            sides.entry(first).or_default().push((n, false));
            sides.entry(second).or_default().push((n, true));
        }
        sides.into_iter().map(|(label, sides)| (label, self.gathered(sides.into_iter())))
    }

    /// The interface of two labels, in the order of a pair, with the vertices it uses, in their order.
    pub fn interface(&self, pair: [i64; 2]) -> TriMesh {
        let own = self.pairs.iter().enumerate().filter(|(_, found)| **found == pair);
        self.gathered(own.map(|(n, _)| (n, false)))
    }

    /// Some triangles, each perhaps turned over.
    fn gathered(&self, sides: impl Iterator<Item = (usize, bool)>) -> TriMesh {
        let TriMesh { vertices, triangles, normals } = &self.surface;
        let side = |(n, is_turned): (usize, bool)| {
            let [a, b, c] = triangles[n];
            if is_turned { [a, c, b] } else { [a, b, c] }
        };
        let mut triangles: Vec<[u32; 3]> = sides.map(side).collect();
        let mut used = triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        for v in triangles.as_flattened_mut() {
            *v = used.partition_point(|&other| other < *v) as u32;
        }
        TriMesh {
            vertices: used.iter().map(|&v| vertices[v as usize]).collect(),
            triangles,
            normals: used.iter().filter_map(|&v| normals.get(v as usize).copied()).collect(),
        }
    }

    /// For each pair of labels that touch the number of their triangles and the area, in squared world
    /// units.
    pub fn contacts(&self) -> BTreeMap<[i64; 2], (usize, f64)> {
        let mut contacts = BTreeMap::new();
        for (&triangle, &pair) in self.surface.triangles.iter().zip(&self.pairs) {
            let [a, b, c] = self.surface.corners(triangle);
            let contact: &mut (usize, f64) = contacts.entry(pair).or_default();
            contact.0 += 1;
            contact.1 += 0.5 * length(cross(subtract(b, a), subtract(c, a)));
        }
        contacts
    }
}
