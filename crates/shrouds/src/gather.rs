//! Reads from all over an array whose indices were checked beforehand.
//!
//! The one file with `unsafe`. Iterations read every vertex and every place from all over again and
//! again, and a check of each index would take longer than the arithmetic.

#![allow(unsafe_code)]

use std::ops::Range;

/// Groups of `N` indices, each below a bound.
///
/// All were checked when they were put together, and nothing changes them afterwards: an array at
/// least as long as the bound holds what each of them points to.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Indices<const N: usize> {
    groups: Vec<[u32; N]>,
    bound: usize,
}

impl<const N: usize> Indices<N> {
    /// # Panics
    /// When an index is not below the bound.
    pub(crate) fn new(groups: Vec<[u32; N]>, bound: usize) -> Self {
        let largest = groups.as_flattened().iter().fold(0, |largest, &i| largest.max(i));
        assert!(groups.is_empty() || (largest as usize) < bound, "index {largest} of {bound}");
        Self { groups, bound }
    }

    pub(crate) fn groups(&self) -> &[[u32; N]] {
        &self.groups
    }

    /// What the groups in `range` point to.
    ///
    /// # Panics
    /// When `values` is shorter than the bound or `range` reaches beyond the last group.
    #[inline(always)]
    pub(crate) fn read<T: Copy>(
        &self,
        range: Range<usize>,
        values: &[T],
    ) -> impl ExactSizeIterator<Item = [T; N]> {
        assert!(values.len() >= self.bound, "{} values for {}", values.len(), self.bound);
        self.groups[range].iter().map(|group| {
            // SAFETY: every index is below the bound, which is not above the number of values.
            group.map(|i| unsafe { *values.get_unchecked(i as usize) })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_read_in_order() {
        let indices = Indices::new(vec![[4, 0], [1, 4], [2, 3]], 5);
        let read: Vec<_> = indices.read(1..3, &[10, 11, 12, 13, 14, 15]).collect();
        assert_eq!(read, [[11, 14], [12, 13]]);
    }

    #[test]
    #[should_panic(expected = "index 5 of 5")]
    fn indices_beyond_the_bound_are_refused() {
        Indices::new(vec![[5, 0]], 5);
    }

    #[test]
    #[should_panic(expected = "4 values for 5")]
    fn short_arrays_are_refused() {
        Indices::new(vec![[0]], 5).read(0..1, &[0; 4]).for_each(drop);
    }
}
