//! Loops over fixed blocks, on as many threads as the caller's pool has.
//!
//! The blocks do not depend on the number of threads and partial results are combined in block
//! order, so every result has the same bits on any number of threads, and without the feature
//! `parallel` too.

use std::ops::Range;

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Entries per block: large enough to hide the cost of handing out work.
const BLOCK: usize = 4096;

/// `out[i] = f(i)` for every entry.
pub(crate) fn fill<T: Send>(out: &mut [T], f: impl Fn(usize) -> T + Sync) {
    update(out, |i, slot| *slot = f(i));
}

/// The results of `f` on successive blocks of `0..count`, in order.
pub(crate) fn blocks<R: Send>(
    count: usize,
    block: usize,
    f: impl Fn(Range<usize>) -> R + Sync,
) -> Vec<R> {
    let run = |index: usize| f(index * block..((index + 1) * block).min(count));
    let blocks = count.div_ceil(block);
    #[cfg(feature = "parallel")]
    return (0..blocks).into_par_iter().map(run).collect();
    #[cfg(not(feature = "parallel"))]
    (0..blocks).map(run).collect()
}

/// The results of both, at the same time where there is a thread for it.
pub(crate) fn both<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    return rayon::join(a, b);
    #[cfg(not(feature = "parallel"))]
    (a(), b())
}

/// Sum of `f(i)` over `0..count`, always in the same order.
pub(crate) fn sum(count: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    blocks(count, BLOCK, |range| range.map(&f).sum::<f64>()).into_iter().sum()
}

/// `f(i, &mut values[i])` for every entry.
pub(crate) fn update<T: Send>(values: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    update_sum(values, |i, value| {
        f(i, value);
        0.0
    });
}

/// `f(i, &mut values[i])` for every entry; the sum of what it returns, always in the same order.
pub(crate) fn update_sum<T: Send>(
    values: &mut [T],
    f: impl Fn(usize, &mut T) -> f64 + Sync,
) -> f64 {
    let update_block = |(block, part): (usize, &mut [T])| {
        let first = block * BLOCK;
        part.iter_mut().enumerate().map(|(n, value)| f(first + n, value)).sum::<f64>()
    };
    if values.len() <= BLOCK {
        return update_block((0, values));
    }
    #[cfg(feature = "parallel")]
    let sums: Vec<f64> = values.par_chunks_mut(BLOCK).enumerate().map(update_block).collect();
    #[cfg(not(feature = "parallel"))]
    let sums: Vec<f64> = values.chunks_mut(BLOCK).enumerate().map(update_block).collect();
    sums.into_iter().sum()
}

/// The results of `f` on successive pieces of `values`, which end at `ends`, in order. What lies
/// beyond the last end is left alone.
pub(crate) fn pieces<T: Send, R: Send>(
    mut values: &mut [T],
    ends: impl IntoIterator<Item = usize>,
    f: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    let mut pieces = Vec::new();
    let mut start = 0;
    for end in ends {
        let (piece, rest) = values.split_at_mut(end - start);
        pieces.push(piece);
        (values, start) = (rest, end);
    }
    let run = |(index, piece): (usize, &mut [T])| f(index, piece);
    #[cfg(feature = "parallel")]
    return pieces.into_par_iter().enumerate().map(run).collect();
    #[cfg(not(feature = "parallel"))]
    pieces.into_iter().enumerate().map(run).collect()
}
