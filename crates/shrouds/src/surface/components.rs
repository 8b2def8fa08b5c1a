//! The connected components of a surface.

use crate::surface::Surface;

/// Which vertices of a surface hang together over its patches, and how many voxels each such
/// component encloses.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Components {
    of_vertex: Vec<u32>,
    voxels: Vec<i64>,
}

impl Components {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.voxels.len()
    }

    /// The component of every vertex; they are numbered in the order of their first vertices.
    pub fn of_vertices(&self) -> &[u32] {
        &self.of_vertex
    }

    /// How many voxels each component encloses, whatever lies within them; negative where it bounds a
    /// cavity. Without meaning for a component that an open border cuts.
    pub fn voxels(&self) -> &[i64] {
        &self.voxels
    }
}

impl Surface {
    /// The connected components.
    pub fn components(&self) -> Components {
        let mut of_vertex = self.joined();
        let mut voxels: Vec<i64> = Vec::new();
        for (v, crossing) in self.crossings().enumerate() {
            // The first of a component comes before all others that name it.
            of_vertex[v] = match of_vertex[v] {
                first if first as usize == v => {
                    voxels.push(0);
                    voxels.len() as u32 - 1
                }
                first => of_vertex[first as usize],
            };
            // Every line along x leaves what the component encloses as often as it enters, so the ends
            // of its stretches count voxels as the volume between them is counted.
            if crossing.axis() == 0 {
                let index = crossing.low()[0] as i64;
                let sum = &mut voxels[of_vertex[v] as usize];
                *sum += if crossing.inside_low() { index } else { -index };
            }
        }
        Components { of_vertex, voxels }
    }

    /// The first vertex of the component of every vertex.
    fn joined(&self) -> Vec<u32> {
        let mut first: Vec<u32> = (0..self.vertex_count() as u32).collect();
        for layer in 0..self.layer_count() {
            self.for_each_patch(layer, |patch, _| {
                let mut a = find(&mut first, patch[0]);
                for &v in &patch[1..] {
                    let b = find(&mut first, v);
                    first[a.max(b) as usize] = a.min(b);
                    a = a.min(b);
                }
            });
        }
        // Every vertex names one before it, which names its first by then.
        for v in 0..first.len() {
            first[v] = first[first[v] as usize];
        }
        first
    }
}

/// The first of the set of `v`, where every vertex names one before it or itself; shortens the way for
/// the next time.
fn find(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        let grandparent = parents[parents[v as usize] as usize];
        parents[v as usize] = grandparent;
        v = grandparent;
    }
    v
}
