//! From bits to the numbers of crossings and patches.

use crate::error::Error;
use crate::parallel;
use crate::surface::Surface;
use crate::surface::bits::shifted;
use crate::surface::cell::{self, CellTable};
use crate::surface::cells::{for_each_word, rows_around};
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
        if vertices > Self::MAX_VERTICES {
            return Err(Error::TooManyVertices { vertices, limit: Self::MAX_VERTICES });
        }
        let mut before = 0;
        let mut layers = vec![(0, 0)];
        for (rows, (vertices, (patches, triangles))) in all.chunks_mut(ny).zip(&slices) {
            rows.as_flattened_mut().iter_mut().for_each(|first| *first += before);
            before += *vertices as u32;
            let last = layers[layers.len() - 1];
            layers.push((last.0 + patches, last.1 + triangles));
        }
        // Above the last slice there is no layer.
        layers.pop();
        end[0] = [before; 3];
        Ok(Self { volume, face_rule, border, rows, layers })
    }
}

/// Numbers the first crossings of the rows of a slice, as if there were none before it. Returns how
/// many there are.
fn number_rows(volume: &Occupancy, k: usize, rows: &mut [[u32; 3]]) -> u64 {
    let [nx, ny, nz] = volume.grid().dims();
    let mut next = 0u64;
    for (j, first) in rows.iter_mut().enumerate() {
        let row = volume.row(j, k);
        // The last rows have no neighbour to differ from.
        let beside = &volume.row((j + 1).min(ny - 1), k)[..row.len()];
        let above = &volume.row(j, (k + 1).min(nz - 1))[..row.len()];
        let mut counts = [0; 3];
        if (0..row.len()).fold(0, |any, w| any | row[w] | beside[w] | above[w]) != 0 {
            for w in 0..row.len() {
                counts[0] += u64::from((row[w] ^ shifted(row, w)).count_ones());
                counts[1] += u64::from((row[w] ^ beside[w]).count_ones());
                counts[2] += u64::from((row[w] ^ above[w]).count_ones());
            }
            // An inside point at the end seemed to differ from one beyond.
            counts[0] -= row[(nx - 1) / 64] >> ((nx - 1) % 64) & 1;
        }
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
        for_each_word(rows_around(volume, j, layer), nx - 1, |word| {
            let crossed = word.crossed();
            patches += word.active().count_ones();
            for cell in word.entangled(&crossed) {
                patches += table.loops(cell).len() as u32 - 1;
            }
            for edges in crossed {
                corners += (edges & word.active()).count_ones() as usize;
            }
        });
    }
    (patches, corners - 2 * patches as usize)
}
