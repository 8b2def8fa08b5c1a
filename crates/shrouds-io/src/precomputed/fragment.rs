//! A mesh cut into cubes.

use std::collections::BTreeMap;

use shrouds::{Grid, TriMesh};

use super::{VertexBits, draco};

/// What lies in one cube.
#[derive(Debug, PartialEq)]
pub(crate) struct Fragment {
    /// Which cube, along x, y, z: number 1 begins at the first lattice point.
    pub(crate) place: [u32; 3],
    pub(crate) triangles: usize,
    pub(crate) bytes: Vec<u8>,
}

/// The fragments of a mesh in cubes of `edge` voxels of its lattice, in the order of their places. No
/// triangle may lie in two cubes.
pub(crate) fn fragments(
    mesh: &TriMesh,
    grid: &Grid,
    edge: usize,
    bits: VertexBits,
) -> Result<Vec<Fragment>, String> {
    let to_index = grid.inverse_affine();
    let in_cubes = |vertex: &[f64; 3]| {
        to_index.map(|[a, b, c, d]| {
            (a * vertex[0] + b * vertex[1] + c * vertex[2] + d) / edge as f64 + 1.0
        })
    };
    let positions: Vec<[f64; 3]> = mesh.vertices.iter().map(in_cubes).collect();
    let mut cubes: BTreeMap<[u32; 3], Vec<[u32; 3]>> = BTreeMap::new();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| positions[v as usize]);
        let middle = |d: usize| corners.iter().map(|corner| corner[d]).sum::<f64>() / 3.0;
        cubes.entry([0, 1, 2].map(|d| middle(d).max(0.0) as u32)).or_default().push(*triangle);
    }
    let fragment = |(place, mut triangles): ([u32; 3], Vec<[u32; 3]>)| {
        let largest = f64::from(bits.largest());
        let vertices = renumber(&mut triangles, mesh.vertices.len());
        let within = |v: u32| {
            let position = positions[v as usize];
            [0, 1, 2].map(|d| {
                let share = position[d] - f64::from(place[d]);
                (share * largest).round().clamp(0.0, largest) as u32
            })
        };
        let vertices: Vec<[u32; 3]> = vertices.into_iter().map(within).collect();
        let bytes = draco::encode(&vertices, &triangles)?;
        Ok(Fragment { place, triangles: triangles.len(), bytes })
    };
    cubes.into_iter().map(fragment).collect()
}

/// Numbers the vertices of some triangles in the order in which they come; returns those they had.
fn renumber(triangles: &mut [[u32; 3]], count: usize) -> Vec<u32> {
    let (mut numbers, mut vertices) = (vec![u32::MAX; count], Vec::new());
    for v in triangles.as_flattened_mut() {
        let number = &mut numbers[*v as usize];
        if *number == u32::MAX {
            *number = vertices.len() as u32;
            vertices.push(*v);
        }
        *v = *number;
    }
    vertices
}
