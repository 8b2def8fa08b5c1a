//! Boolean operations on volumes that share a lattice.

use crate::error::Error;
use crate::volume::Occupancy;

/// A Boolean operation on two sets of lattice points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operation {
    /// In either or both.
    Union,
    /// In both.
    Intersect,
    /// In the first and not in the second.
    Subtract,
    /// In one of them only.
    Xor,
}

impl Occupancy {
    /// The lattice points that `operation` makes of those inside this volume (the first) and those
    /// inside `other`. The result has the grid of this volume.
    ///
    /// # Errors
    /// [`Error::DifferentLattices`] unless both have the same lattice points, to 1e-4 of the smallest
    /// spacing.
    pub fn combine(&self, operation: Operation, other: &Self) -> Result<Self, Error> {
        self.grid().check_same_lattice(other.grid())?;
        Ok(match operation {
            Operation::Union => self.zip_words(other, |a, b| a | b),
            Operation::Intersect => self.zip_words(other, |a, b| a & b),
            Operation::Subtract => self.zip_words(other, |a, b| a & !b),
            Operation::Xor => self.zip_words(other, |a, b| a ^ b),
        })
    }

    /// The volume of the words that `f` makes of those of two volumes of the same dimensions. Two words
    /// of 0 must give 0.
    pub(super) fn zip_words(&self, other: &Self, f: impl Fn(u64, u64) -> u64) -> Self {
        let words = self.words().0.iter().zip(other.words().0).map(|(&a, &b)| f(a, b)).collect();
        Self::of_words(self.grid().clone(), words)
    }

    /// The lattice points that are outside.
    pub(super) fn complement(&self) -> Self {
        let [nx, _, _] = self.grid().dims();
        Self::from_rows(self.grid().clone(), |j, k, words| {
            for (word, bits) in words.iter_mut().zip(self.row(j, k)) {
                *word = !bits;
            }
            clear_past(words, nx);
        })
    }
}

/// Clears the bits from `length` on in the last word of a row.
pub(super) fn clear_past(words: &mut [u64], length: usize) {
    if let (Some(last), 1..) = (words.last_mut(), length % 64) {
        *last &= (1 << (length % 64)) - 1;
    }
}
