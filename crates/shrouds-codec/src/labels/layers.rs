//! The last few layers of labels.

use crate::topology::window::{ROWS, Window};

/// Voxels before and after each row, and rows before and after each layer.
const MARGIN: usize = 8;
const MARGIN_ROWS: usize = 3;
/// The layer that is being coded and the four before it.
const DEPTH: usize = 5;

/// The rows within reach of a voxel that decide whether it is in a run.
const NEAR: [[isize; 2]; 10] =
    [[-1, 0], [-2, 0], [0, -1], [-1, -1], [1, -1], [-2, -1], [2, -1], [0, -2], [-1, -2], [1, -2]];

/// The last layers, with the first label around them.
pub(super) struct Layers {
    stride: usize,
    /// The newest first.
    labels: [Vec<u32>; DEPTH],
    /// Whether the labels two steps to both sides along x are the same.
    flat: [Vec<bool>; 3],
}

impl Layers {
    pub(super) fn new([nx, ny]: [usize; 2]) -> Self {
        let stride = nx + 2 * MARGIN;
        let size = stride * (ny + 2 * MARGIN_ROWS);
        Self {
            stride,
            labels: std::array::from_fn(|_| vec![0; size]),
            flat: std::array::from_fn(|_| vec![true; size]),
        }
    }

    /// Begins a layer.
    pub(super) fn advance(&mut self) {
        self.labels.rotate_right(1);
        self.flat.rotate_right(1);
    }

    /// Where voxel `x` of row `j` lies in a layer.
    #[inline(always)]
    fn at(&self, j: usize, x: usize) -> usize {
        (j + MARGIN_ROWS) * self.stride + MARGIN + x
    }

    #[inline(always)]
    fn from(&self, at: usize, [y, _]: [isize; 2]) -> usize {
        (at as isize + y * self.stride as isize) as usize
    }

    /// The label `steps` along x, y, z from voxel `x` of row `j`.
    #[inline(always)]
    pub(super) fn label(&self, [j, x]: [usize; 2], steps: [isize; 3]) -> u32 {
        let at = self.from(self.at(j, x), [steps[1], 0]);
        self.labels[steps[2].unsigned_abs()][(at as isize + steps[0]) as usize]
    }

    /// Takes in a voxel of the newest layer.
    #[inline(always)]
    pub(super) fn set(&mut self, [j, x]: [usize; 2], label: u32) {
        let at = self.at(j, x);
        self.labels[0][at] = label;
    }

    /// Whether all known labels within reach of a voxel are `label`.
    #[inline(always)]
    pub(super) fn is_quiet(&self, [j, x]: [usize; 2], label: u32) -> bool {
        let at = self.at(j, x);
        NEAR.iter().all(|&steps| {
            let (depth, from) = (steps[1].unsigned_abs(), self.from(at, steps));
            self.labels[depth][from] == label && self.flat[depth][from]
        })
    }

    /// Finds the flat places of a row that is complete.
    pub(super) fn finish_row(&mut self, j: usize) {
        let start = self.at(j, 0);
        // The margins, too: the row ends within reach of them.
        for at in start - 2..start + self.stride - 2 * MARGIN + 2 {
            let near = &self.labels[0][at - 2..at + 3];
            self.flat[0][at] = near.iter().all(|&label| label == near[2]);
        }
    }

    /// The voxels around one, 1 where they have `label`: as [`Window`] has them.
    pub(super) fn window(&self, [j, x]: [usize; 2], label: u32, rows: usize) -> Window {
        let at = self.at(j, x);
        let same = |voxels: &[u32]| {
            voxels.iter().rev().fold(0, |bits, &other| bits << 1 | u8::from(other == label))
        };
        let mut window = [0; 24];
        window[0] = same(&self.labels[0][at - 8..at]).reverse_bits();
        for (byte, &steps) in window[1..].iter_mut().zip(&ROWS).take(rows) {
            let from = self.from(at, steps);
            *byte = same(&self.labels[steps[1].unsigned_abs()][from - 3..from + 5]);
        }
        window
    }
}
