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

    /// Whether one of the lattice faces normal to x between rows `(j, k)` and `(j + 1, k + 1)` has its
    /// inside corners on one diagonal.
    pub(super) fn have_ambiguous_face(&self, j: usize, k: usize) -> bool {
        let rows = [(j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1)].map(|(j, k)| self.own(j, k));
        let word = |row: Option<&[u64]>, w: usize| row.map_or(0, |row| row[w]);
        (0..self.volume.grid().dims()[0].div_ceil(64)).any(|w| {
            let [a, b, c, d] = rows.map(|row| word(row, w));
            (a ^ b) & (c ^ d) & (a ^ c) != 0
        })
    }

    /// The words of row `(j, k)`, if it is one of the volume.
    fn own(&self, j: usize, k: usize) -> Option<&[u64]> {
        let [_, ny, nz] = self.volume.grid().dims();
        let (j, k) = (j.wrapping_sub(self.margin), k.wrapping_sub(self.margin));
        (j < ny && k < nz).then(|| self.volume.row(j, k))
    }

    /// A buffer for [`Rows::read`].
    pub(super) fn buffer(&self) -> Vec<u64> {
        // One word more, so that every word has a next one.
        vec![0; self.dims[0].div_ceil(64) + 1]
    }

    /// Copies row `(j, k)`, all zero where there is none; bit `i` is point `i`.
    pub(super) fn read(&self, j: usize, k: usize, buffer: &mut [u64]) {
        buffer.fill(0);
        let Some(row) = self.own(j, k) else { return };
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
