//! From bits to crossings and patches.

use crate::error::Error;
use crate::parallel;
use crate::surface::Surface;
use crate::surface::cell::{self, CellTable};
use crate::surface::crossing::Crossing;
use crate::surface::rows::{Rows, mask_below, set_bits, shifted};
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
        let padded;
        let volume = match border {
            Border::Closed => {
                padded = volume.padded(1)?;
                &padded
            }
            Border::Open if volume.grid().dims().contains(&1) => {
                return Err(Error::NoCells { dims: volume.grid().dims() });
            }
            Border::Open => volume,
        };
        let (vertices, rows) = Rows::number(volume);
        let rows = rows.ok_or(Error::TooManyVertices { vertices, limit: Self::MAX_VERTICES })?;
        let patches = find_patches(volume, &rows, cell::table(face_rule));
        Ok(Self {
            grid: volume.grid().clone(),
            face_rule,
            border,
            crossings: list_crossings(volume, &rows),
            starts: patches.starts,
            corners: patches.corners,
            shapes: patches.shapes,
        })
    }
}

fn list_crossings(volume: &Occupancy, rows: &Rows) -> Vec<Crossing> {
    let [_, ny, nz] = volume.grid().dims();
    let slices =
        parallel::blocks(nz, 1, |slice| {
            let k = slice.start;
            let mut crossings = Vec::new();
            for (j, axis) in (0..ny).flat_map(|j| [(j, 0), (j, 1), (j, 2)]) {
                for w in 0..rows.word_count() {
                    let inside = volume.row(j, k)[w];
                    crossings.extend(set_bits(rows.word(axis, j, k, w)).map(|bit| {
                        Crossing::new([64 * w + bit, j, k], axis, inside >> bit & 1 == 1)
                    }));
                }
            }
            crossings
        });
    slices.concat()
}

#[derive(Default)]
struct Patches {
    starts: Vec<u32>,
    corners: Vec<u32>,
    shapes: Vec<u16>,
}

fn find_patches(volume: &Occupancy, rows: &Rows, table: &CellTable) -> Patches {
    let [_, ny, nz] = volume.grid().dims();
    let layers = parallel::blocks(nz - 1, 1, |layer| {
        let mut patches = Patches::default();
        for j in 0..ny - 1 {
            CellRow::new(volume, rows, j, layer.start).patches(table, &mut patches);
        }
        patches
    });
    let mut all = Patches::default();
    all.corners.reserve_exact(layers.iter().map(|p| p.corners.len()).sum());
    for layer in layers {
        let first = all.corners.len() as u32;
        all.starts.extend(layer.starts.iter().map(|start| first + start));
        all.corners.extend(layer.corners);
        all.shapes.extend(layer.shapes);
    }
    all.starts.push(all.corners.len() as u32);
    all
}

/// A row of cells along x between four rows of lattice points.
struct CellRow<'a> {
    rows: &'a Rows<'a>,
    /// Lattice rows in corner order: `(j, k)`, `(j + 1, k)`, `(j, k + 1)`, `(j + 1, k + 1)`.
    bits: [&'a [u64]; 4],
    nx: usize,
    j: usize,
    k: usize,
}

/// The rows of crossings around a row of cells, as `(axis, step in j, step in k)`. Those along y and
/// z serve two cell edges each, at `i` and at `i + 1`.
const STREAMS: [(usize, usize, usize); 8] =
    [(0, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1), (1, 0, 0), (1, 0, 1), (2, 0, 0), (2, 1, 0)];

/// For each cell edge its stream, and whether it lies at `i + 1`.
const EDGE_STREAM: [(usize, usize); 12] = [
    (0, 0),
    (1, 0),
    (2, 0),
    (3, 0),
    (4, 0),
    (5, 0),
    (4, 1),
    (5, 1),
    (6, 0),
    (6, 1),
    (7, 0),
    (7, 1),
];

impl<'a> CellRow<'a> {
    fn new(volume: &'a Occupancy, rows: &'a Rows<'a>, j: usize, k: usize) -> Self {
        let bits = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| volume.row(j + a, k + b));
        Self { rows, bits, nx: volume.grid().dims()[0], j, k }
    }

    fn patches(&self, table: &CellTable, patches: &mut Patches) {
        // Number of the first vertex of the current word in each stream.
        let mut first = STREAMS.map(|(axis, a, b)| self.rows.first(axis, self.j + a, self.k + b));
        for w in 0..self.rows.word_count() {
            let near = self.bits.map(|row| row[w]);
            let far = self.bits.map(|row| shifted(row, w));
            let any = near.iter().chain(&far).fold(0, |a, b| a | b);
            let all = near.iter().chain(&far).fold(u64::MAX, |a, b| a & b);
            let crossed =
                STREAMS.map(|(axis, a, b)| self.rows.word(axis, self.j + a, self.k + b, w));
            for bit in set_bits(any & !all & mask_below(self.nx - 1, w)) {
                let corners = (0..4).fold(0, |corners, row| {
                    let pair = (near[row] >> bit & 1) | (far[row] >> bit & 1) << 1;
                    corners | (pair as u8) << (2 * row)
                });
                let vertex = |edge: u8| {
                    let (stream, step) = EDGE_STREAM[usize::from(edge)];
                    let before = mask_below(bit + step, 0);
                    first[stream] + (crossed[stream] & before).count_ones()
                };
                for (number, shape) in table.loops(corners) {
                    patches.starts.push(patches.corners.len() as u32);
                    patches.shapes.push(number);
                    patches.corners.extend(shape.edges().iter().map(|&edge| vertex(edge)));
                }
            }
            for (first, crossed) in first.iter_mut().zip(crossed) {
                *first += crossed.count_ones();
            }
        }
    }
}
