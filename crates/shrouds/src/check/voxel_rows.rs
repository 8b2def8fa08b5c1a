//! The rows of a volume as words, with a layer of outside points around a closed border.

use crate::volume::Border;
use crate::volume::Occupancy;

/// The volume as its topology sees it.
pub(super) struct Rows<'a> {
    volume: &'a Occupancy,
    margin: usize,
    dims: [usize; 3],
}

impl<'a> Rows<'a> {
    pub(super) fn new(volume: &'a Occupancy, border: Border) -> Self {
        let margin = usize::from(border == Border::Closed);
        Self { volume, margin, dims: volume.grid().dims().map(|n| n + 2 * margin) }
    }

    /// Points along x, y, z, the layer included.
    pub(super) fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Whether there is a layer of outside points around the volume.
    pub(super) fn are_closed(&self) -> bool {
        self.margin > 0
    }

    /// Whether a point, the layer included, is inside.
    pub(super) fn get(&self, index: [usize; 3]) -> bool {
        let dims = self.volume.grid().dims();
        let own = index.map(|x| x.wrapping_sub(self.margin));
        (0..3).all(|d| own[d] < dims[d]) && self.volume.get(own)
    }

    /// A buffer for [`Rows::read`].
    pub(super) fn buffer(&self) -> Vec<u64> {
        // One word more, so that every word has a next one.
        vec![0; self.dims[0].div_ceil(64) + 1]
    }

    /// Copies row `(j, k)`, all zero where there is none; bit `i` is point `i`.
    pub(super) fn read(&self, j: usize, k: usize, buffer: &mut [u64]) {
        buffer.fill(0);
        let [_, ny, nz] = self.volume.grid().dims();
        let (j, k) = (j.wrapping_sub(self.margin), k.wrapping_sub(self.margin));
        if j >= ny || k >= nz {
            return;
        }
        let row = self.volume.row(j, k);
        if self.margin == 0 {
            buffer[..row.len()].copy_from_slice(row);
            return;
        }
        for (w, &bits) in row.iter().enumerate() {
            buffer[w] |= bits << 1;
            buffer[w + 1] |= bits >> 63;
        }
    }
}
