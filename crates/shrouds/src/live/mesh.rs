//! The mesh of some cells.

use crate::error::Error;
use crate::live::{LiveShroud, Ranges};
use crate::mesh::{MeshKind, TriMesh, network_normals};
use crate::network::Network;
use crate::surface::Part;

impl LiveShroud {
    /// The mesh of a box of cells, with vertices and normals of its own: all patches there, as
    /// [`TriMesh::place`] makes them. Meshes of boxes beside each other meet without gaps.
    ///
    /// Cell `[i, j, k]` lies between lattice points `[i, j, k]` and `[i + 1, j + 1, k + 1]` of
    /// [`Surface::grid`](crate::surface::Surface::grid).
    ///
    /// # Errors
    /// [`Error::NoSuchPoints`] when a range is empty or there are no such cells.
    pub fn mesh(&self, cells: Ranges) -> Result<TriMesh, Error> {
        let grid = self.surface.grid();
        grid.crop(cells.clone())?;
        let points = cells.map(|range| range.start..range.end.saturating_add(1));
        grid.crop(points.clone())?;
        // The neighbours of a vertex are at most one cell away.
        let around = self.surface.widened(&points, [1; 2]);
        let part = Part::cut(&self.surface, &around);
        let placed = part.crossings().zip(part.read(&self.delta, 0.5));
        let vertices: Vec<_> =
            placed.map(|(crossing, delta)| grid.point(crossing.position(delta))).collect();
        let normals = network_normals(&part.piece, &Network::trace(&part.piece), &vertices);
        let inner =
            [0, 1, 2].map(|d| points[d].start - around[d].start..points[d].end - around[d].start);
        let inner = Part::cut(&part.piece, &inner);
        let (vertices, normals) = (inner.read(&vertices, [0.0; 3]), inner.read(&normals, [0.0; 3]));
        Ok(TriMesh::span(&inner.piece, vertices, normals, MeshKind::Primal, self.triangles))
    }
}
