//! From bits to the numbers of crossings and patches.

use crate::error::Error;
use crate::parallel;
use crate::surface::Surface;
use crate::surface::bits::{mask_below, shifted};
use crate::surface::cell::{self, CellTable};
use crate::surface::cells::for_each_word;
use crate::volume::{Border, FaceRule, Occupancy};

impl Surface {
    /// Finds the crossings and patches of a volume.
    ///
    /// An empty volume has an empty surface; so has a full one with an open border.
    ///
    /// # Errors
    /// [`Error::TooManyVertices`] beyond [`Surface::MAX_VERTICES`]; [`Error::NoCells`] when an open
    /// border leaves no cell; [`Error::Dimensions`] when the padded grid of a closed border is too
    /// large.
    pub fn extract(volume: &Occupancy, face_rule: FaceRule, border: Border) -> Result<Self, Error> {
        let volume = match border {
            Border::Closed => volume.padded(1)?,
            Border::Open if volume.grid().dims().contains(&1) => {
                return Err(Error::NoCells { dims: volume.grid().dims() });
            }
            Border::Open => volume.clone(),
        };
        let (surface, vertices) = number(volume, face_rule, border);
        if vertices > Self::MAX_VERTICES {
            return Err(Error::TooManyVertices { vertices, limit: Self::MAX_VERTICES });
        }
        Ok(surface)
    }
}

/// Counts crossings and patches of a volume that has its border already. Returns the surface and the
/// number of its vertices, beyond [`Surface::MAX_VERTICES`] of which the surface means nothing.
pub(super) fn number(volume: Occupancy, face_rule: FaceRule, border: Border) -> (Surface, u64) {
    let [_, ny, nz] = volume.grid().dims();
    let mut rows = vec![[0; 3]; ny * nz + 1];
    let (all, end) = rows.split_at_mut(ny * nz);
    let table = cell::table(face_rule);
    let slices = parallel::pieces(all, (1..=nz).map(|k| k * ny), |k, rows| {
        let vertices = number_rows(&volume, k, rows);
        let layer = if k + 1 < nz { count_patches(&volume, k, table) } else { (0, 0) };
        (vertices, layer)
    });
    let vertices = slices.iter().map(|(vertices, _)| vertices).sum();
    let mut before = 0u32;
    let mut layers = vec![(0, 0)];
    for (rows, (vertices, (patches, triangles))) in all.chunks_mut(ny).zip(&slices) {
        for first in rows.as_flattened_mut() {
            *first = first.wrapping_add(before);
        }
        before = before.wrapping_add(*vertices as u32);
        let last = layers[layers.len() - 1];
        layers.push((last.0 + patches, last.1 + triangles));
    }
    // Above the last slice there is no layer.
    layers.pop();
    end[0] = [before; 3];
    (Surface { volume, face_rule, border, rows, layers }, vertices)
}

/// Numbers the first crossings of the rows of a slice, as if there were none before it. Returns how
/// many there are.
fn number_rows(volume: &Occupancy, k: usize, rows: &mut [[u32; 3]]) -> u64 {
    let [nx, ny, nz] = volume.grid().dims();
    let mut next = 0u64;
    for (j, first) in rows.iter_mut().enumerate() {
        let row = volume.row(j, k);
        let along = |w| (row[w] ^ shifted(row, w)) & mask_below(nx - 1, w);
        // The last rows have no neighbour to differ from.
        let [beside, above] =
            [volume.row((j + 1).min(ny - 1), k), volume.row(j, (k + 1).min(nz - 1))];
        let counts = (0..row.len()).fold([0; 3], |[x, y, z]: [u64; 3], w| {
            let ones = [along(w), row[w] ^ beside[w], row[w] ^ above[w]].map(u64::count_ones);
            let [a, b, c] = ones.map(u64::from);
            [x + a, y + b, z + c]
        });
        for (first, count) in first.iter_mut().zip(counts) {
            *first = next as u32;
            next += count;
        }
    }
    next
}

/// Numbers of patches and of their fixed triangles in a layer.
fn count_patches(volume: &Occupancy, layer: usize, table: &CellTable) -> (u32, usize) {
    let [nx, ny, _] = volume.grid().dims();
    let (mut patches, mut corners) = (0, 0);
    for j in 0..ny - 1 {
        let rows = [(j, layer), (j + 1, layer), (j, layer + 1), (j + 1, layer + 1)];
        let rows = rows.map(|(j, k)| volume.row(j, k));
        for_each_word(rows, nx - 1, |word| {
            let crossed = word.crossed();
            patches += word.active().count_ones() as usize;
            patches += word.entangled(&crossed).map(|c| table.loops(c).len() - 1).sum::<usize>();
            let ones = crossed.map(|edges| (edges & word.active()).count_ones() as usize);
            corners += ones.iter().sum::<usize>();
        });
    }
    (patches as u32, corners - 2 * patches)
}
