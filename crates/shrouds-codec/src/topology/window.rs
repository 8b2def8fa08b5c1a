//! What a model sees of the voxels around one.

/// The known voxels around one, a byte for each of 24 rows.
///
/// Byte 0 holds the eight voxels before it in its own row, the nearest in the lowest bit. Byte `n` holds
/// eight voxels of row `ROWS[n - 1]`: bit 3 is the one at the same x, bit 2 the one before and bit 4
/// the one after that. Outside of the lattice nothing is inside.
pub type Window = [u8; 24];

/// The rows of a window after its own, as steps along y and z: nearest first, so that a model that
/// looks at few rows looks at the first of them.
pub const ROWS: [[isize; 2]; 23] = [
    [-1, 0],
    [0, -1],
    [-1, -1],
    [1, -1],
    [-2, 0],
    [0, -2],
    [2, -1],
    [-2, -1],
    [-1, -2],
    [1, -2],
    [0, -3],
    [-3, 0],
    [-2, -2],
    [2, -2],
    [-1, -3],
    [1, -3],
    [-3, -1],
    [3, -1],
    [-3, -2],
    [3, -2],
    [-2, -3],
    [2, -3],
    [0, -4],
];

/// A model of the voxels where the surface is.
pub trait Model {
    /// How many of the [`ROWS`] it looks at; the others are 0 in its windows.
    const ROWS: usize;

    /// The probability that the voxel is inside, in units of 1/65536, never 0.
    fn predict(&mut self, window: &Window) -> u16;

    /// Learns the voxel of the last prediction.
    fn update(&mut self, inside: bool);
}
