//! The triangles of a chunk.

use crate::chunks::Chunk;
use crate::mesh::{MeshKind, TriMesh, Triangles, slope_normals};
use crate::surface::Region;

/// The part of a surface that belongs to a chunk, in world coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChunkMesh {
    /// The triangles of the chunk's cells. Its own vertices come first, in the order of
    /// [`Chunk::rows`]; then those of other chunks that the triangles have.
    pub mesh: TriMesh,
    /// The δ of its own vertices, from 0 at the outside end to 1 at the inside end.
    pub delta: Vec<f64>,
    /// The numbers of the other vertices.
    pub borrowed: Vec<u64>,
}

impl ChunkMesh {
    /// The number in the whole surface of a vertex of the mesh, where the chunk's first has `first`.
    ///
    /// # Panics
    /// When the mesh has no such vertex.
    pub fn number(&self, vertex: u32, first: u64) -> u64 {
        match (vertex as usize).checked_sub(self.delta.len()) {
            None => first + u64::from(vertex),
            Some(other) => self.borrowed[other],
        }
    }
}

impl Chunk<'_> {
    /// How many triangles the chunk has.
    pub fn triangle_count(&self) -> usize {
        self.surface.crop(self.cells()).triangle_count()
    }

    /// The mesh of the chunk. `x`, `slopes` and `numbers` are those of the known vertices; of vertices
    /// that are neither the chunk's nor one step above they may be anything.
    ///
    /// # Panics
    /// When there is not one of each for each known vertex.
    pub fn mesh(
        &self,
        x: &[f32],
        slopes: &[[f32; 2]],
        numbers: &[u64],
        triangles: Triangles,
    ) -> ChunkMesh {
        let counts = [x.len(), slopes.len(), numbers.len()];
        assert_eq!(counts, [self.known_count(); 3], "one of each per known vertex");
        let delta = self.piece().deltas(x);
        let cells = self.cells();
        let first = cells.each_ref().map(|range| range.start);
        let surface = self.surface.crop(cells.clone());
        let mut known = vec![0; surface.vertex_count()];
        surface.for_each_row_of(&self.surface, first, &cells, |here, there| {
            known[here].iter_mut().zip(there).for_each(|(v, known)| *v = known);
        });
        // Places are those that the whole lattice gives, to the last bit.
        let corner = [0, 1, 2].map(|d| first[d] + self.first[d]);
        let vertices = surface.crossings().zip(&known).map(|(crossing, &v)| {
            self.layout.lattice().point(crossing.moved(corner).position(delta[v]))
        });
        let vertices = vertices.collect();
        let slopes: Vec<[f32; 2]> = known.iter().map(|&v| slopes[v]).collect();
        let normals = slope_normals(&surface, &slopes);
        let all = TriMesh::span(&surface, vertices, normals, MeshKind::Primal, triangles);
        let own = self.layout.own(self.index);
        let mut is_own = vec![false; known.len()];
        surface.for_each_row_of(&self.surface, first, &self.local(&own), |here, _| {
            is_own[here].fill(true);
        });
        let mut found = ChunkMesh { delta: self.of_chunk(&delta), ..ChunkMesh::default() };
        found.mesh = reordered(&all, &is_own, |v| found.borrowed.push(numbers[known[v]]));
        found
    }

    /// The points between which the chunk's cells lie, as what is known has them.
    fn cells(&self) -> Region {
        self.local(&self.layout.widened(&self.layout.own(self.index), [0, 1]))
    }
}

/// A mesh with its own vertices first and others behind them, those that no triangle has left out; tells
/// of each of the others.
fn reordered(mesh: &TriMesh, is_own: &[bool], mut borrow: impl FnMut(usize)) -> TriMesh {
    let mut is_used = is_own.to_vec();
    mesh.triangles.as_flattened().iter().for_each(|&v| is_used[v as usize] = true);
    let others = (0..is_own.len()).filter(|&v| is_used[v] && !is_own[v]);
    let order: Vec<usize> = (0..is_own.len()).filter(|&v| is_own[v]).chain(others).collect();
    let mut place = vec![0; is_own.len()];
    for (n, &v) in order.iter().enumerate() {
        place[v] = n as u32;
        if !is_own[v] {
            borrow(v);
        }
    }
    TriMesh {
        vertices: order.iter().map(|&v| mesh.vertices[v]).collect(),
        triangles: mesh.triangles.iter().map(|t| t.map(|v| place[v as usize])).collect(),
        normals: order.iter().map(|&v| mesh.normals[v]).collect(),
    }
}
