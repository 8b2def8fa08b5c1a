//! From bits to the numbers of crossings and patches.

use std::sync::OnceLock;

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
        let (surface, vertices) = number(volume, face_rule, border);
        if vertices > Self::MAX_VERTICES {
            return Err(Error::TooManyVertices { vertices, limit: Self::MAX_VERTICES });
        }
        Ok(surface)
    }
}

impl Surface {
    /// Finds the crossings of an image, a volume of one slice along z: the same in two dimensions.
    ///
    /// There are vertices on grid edges along x and y only, no cells and so no patches; every vertex
    /// lies on one planar curve across z, and stands alone on the other one. A closed border is a frame of outside points, and
    /// [`Surface::border`] is open in any case: along z the slice ends.
    ///
    /// # Errors
    /// [`Error::NotAnImage`] when there are several slices; [`Error::NoCells`] when an open border
    /// leaves no square of four lattice points; otherwise as for [`Surface::extract`].
    pub fn of_image(image: &Occupancy, face_rule: FaceRule, border: Border) -> Result<Self, Error> {
        let dims = image.grid().dims();
        let [nx, ny, slices] = dims;
        if slices != 1 {
            return Err(Error::NotAnImage { slices });
        }
        let image = match border {
            Border::Closed => image.slice(2, 0)?.padded(1)?.slice(2, 1)?,
            Border::Open if nx == 1 || ny == 1 => return Err(Error::NoCells { dims }),
            Border::Open => image.slice(2, 0)?,
        };
        let (surface, vertices) = number(image, face_rule, Border::Open);
        // Of the places on curves that are numbered, a vertex of an image has many.
        let limit = Self::MAX_VERTICES / 4;
        if vertices > limit {
            return Err(Error::TooManyVertices { vertices, limit });
        }
        Ok(surface)
    }
}

/// Numbers the crossings of a volume that has its border already. Returns the surface and the number
/// of its vertices, beyond [`Surface::MAX_VERTICES`] of which the surface means nothing.
pub(super) fn number(volume: Occupancy, face_rule: FaceRule, border: Border) -> (Surface, u64) {
    let [_, ny, nz] = volume.grid().dims();
    let mut rows = vec![[0; 3]; ny * nz + 1];
    let (all, end) = rows.split_at_mut(ny * nz);
    let ends = (1..=nz).map(|k| k * ny);
    let slices = parallel::pieces(all, ends, |k, rows| number_rows(&volume, k, rows));
    let mut before = 0u32;
    for (rows, vertices) in all.chunks_mut(ny).zip(&slices) {
        for first in rows.as_flattened_mut() {
            *first = first.wrapping_add(before);
        }
        before = before.wrapping_add(*vertices as u32);
    }
    end[0] = [before; 3];
    let surface = Surface { volume, face_rule, border, rows, layers: OnceLock::new() };
    (surface, slices.iter().sum())
}

/// Numbers of the first patch and the first fixed triangle of every layer, and those of all.
pub(super) fn count_layers(volume: &Occupancy, face_rule: FaceRule) -> Vec<(u32, usize)> {
    let table = cell::table(face_rule);
    let count = volume.grid().dims()[2] - 1;
    let counts = parallel::blocks(count, 1, |layer| count_patches(volume, layer.start, table));
    let mut layers = vec![(0, 0)];
    for (patches, triangles) in counts {
        let last = layers[layers.len() - 1];
        layers.push((last.0 + patches, last.1 + triangles));
    }
    layers
}

/// Numbers the first crossings of the rows of a slice, as if there were none before it. Returns how
/// many there are.
pub(super) fn number_rows(volume: &Occupancy, k: usize, rows: &mut [[u32; 3]]) -> u64 {
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
pub(super) fn count_patches(volume: &Occupancy, layer: usize, table: &CellTable) -> (u32, usize) {
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
