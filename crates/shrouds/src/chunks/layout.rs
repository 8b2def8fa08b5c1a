//! Where the chunks of a volume are.

use std::ops::Range;

use crate::error::Error;
use crate::grid::Grid;
use crate::optimize::{BLOCK, FLAT_REACH, HALO, KNOWN};
use crate::surface::Region;
use crate::volume::Border;

/// A volume cut into cubes of voxels, the last ones along each axis smaller.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    voxels: Grid,
    border: Border,
    /// The voxels with the layers of a closed border around them.
    lattice: Grid,
    edge: usize,
}

impl Layout {
    /// Chunks of `edge` voxels along each axis, a multiple of 128.
    ///
    /// # Errors
    /// [`Error::Setting`] when `edge` is another number or beyond 1024; [`Error::NoCells`] when an open
    /// border leaves no cell; [`Error::Dimensions`] when the lattice of a closed border is too large.
    pub fn new(voxels: Grid, border: Border, edge: usize) -> Result<Self, Error> {
        if edge == 0 || !edge.is_multiple_of(BLOCK) || edge > 8 * BLOCK {
            let range = "a multiple of 128 from 128 to 1024";
            return Err(Error::Setting { name: "chunk", value: edge.to_string(), range });
        }
        let dims = voxels.dims();
        let lattice = match border {
            Border::Closed => voxels.padded(1)?,
            Border::Open if dims.contains(&1) => return Err(Error::NoCells { dims }),
            Border::Open => voxels.clone(),
        };
        Ok(Self { voxels, border, lattice, edge })
    }

    /// The lattice of the voxels.
    pub fn grid(&self) -> &Grid {
        &self.voxels
    }

    /// What lies beyond the volume.
    pub fn border(&self) -> Border {
        self.border
    }

    /// Voxels along an edge of a chunk.
    pub fn edge(&self) -> usize {
        self.edge
    }

    /// How many chunks there are along x, y, z.
    pub fn counts(&self) -> [usize; 3] {
        self.voxels.dims().map(|count| count.div_ceil(self.edge))
    }

    /// All chunks, x fastest: the order in which vertices and triangles are numbered.
    pub fn chunks(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.counts();
        let rows = (0..nz).flat_map(move |k| (0..ny).map(move |j| [j, k]));
        rows.flat_map(move |[j, k]| (0..nx).map(move |i| [i, j, k]))
    }

    /// The voxels of a chunk.
    pub fn voxels(&self, chunk: [usize; 3]) -> [Range<usize>; 3] {
        let dims = self.voxels.dims();
        [0, 1, 2].map(|d| chunk[d] * self.edge..dims[d].min((chunk[d] + 1) * self.edge))
    }

    /// The chunks whose voxels a chunk must know, itself among them.
    pub fn around(&self, chunk: [usize; 3]) -> Vec<[usize; 3]> {
        self.that_meet(&self.piece(chunk))
    }

    /// The chunks that have a share in the vertices a chunk must know, itself among them.
    pub fn beside(&self, chunk: [usize; 3]) -> Vec<[usize; 3]> {
        self.that_meet(&self.widened(&self.known(chunk), [HALO; 2]))
    }

    /// The chunks with vertices of the triangles of a chunk, itself among them.
    pub fn above(&self, chunk: [usize; 3]) -> Vec<[usize; 3]> {
        self.that_meet(&self.widened(&self.own(chunk), [0, 1]))
    }

    fn that_meet(&self, points: &Region) -> Vec<[usize; 3]> {
        let counts = self.counts();
        let [x, y, z]: [Range<usize>; 3] = std::array::from_fn(|d| {
            let chunk_of = |point: usize| point.saturating_sub(self.margin()) / self.edge;
            chunk_of(points[d].start)..(chunk_of(points[d].end - 1) + 1).min(counts[d])
        });
        let rows = z.flat_map(|k| y.clone().map(move |j| [j, k]));
        rows.flat_map(|[j, k]| x.clone().map(move |i| [i, j, k])).collect()
    }

    /// Layers around the voxels.
    pub(super) fn margin(&self) -> usize {
        usize::from(self.border == Border::Closed)
    }

    pub(super) fn lattice(&self) -> &Grid {
        &self.lattice
    }

    /// The points of the lattice that belong to a chunk: its voxels, and the layers that touch them.
    pub(super) fn own(&self, chunk: [usize; 3]) -> Region {
        let (counts, dims) = (self.counts(), self.lattice.dims());
        let voxels = self.voxels(chunk);
        std::array::from_fn(|d| {
            let start = if chunk[d] == 0 { 0 } else { voxels[d].start + self.margin() };
            let is_last = chunk[d] + 1 == counts[d];
            start..if is_last { dims[d] } else { voxels[d].end + self.margin() }
        })
    }

    /// The points whose vertices a chunk has a share in.
    pub(super) fn shared(&self, chunk: [usize; 3]) -> Region {
        self.widened(&self.own(chunk), [HALO; 2])
    }

    /// The points whose vertices a chunk must know.
    pub(super) fn known(&self, chunk: [usize; 3]) -> Region {
        self.widened(&self.own(chunk), KNOWN)
    }

    /// The points whose sides a chunk must know.
    pub(super) fn piece(&self, chunk: [usize; 3]) -> Region {
        self.widened(&self.own(chunk), KNOWN.map(|known| known + FLAT_REACH))
    }

    pub(super) fn widened(&self, points: &Region, [below, above]: [usize; 2]) -> Region {
        let dims = self.lattice.dims();
        std::array::from_fn(|d| {
            points[d].start.saturating_sub(below)..dims[d].min(points[d].end + above)
        })
    }
}
