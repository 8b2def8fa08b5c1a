//! Stretches of set bits in a row.

use std::ops::Range;

/// The stretches of set bits in the words of a row, in order.
pub(super) fn runs(words: &[u64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    std::iter::from_fn(move || {
        let start = next(words, end, 0);
        end = next(words, start, u64::MAX);
        (start < end).then_some(start..end)
    })
}

/// The first bit from `from` on that differs from those of `flip`, or the number of bits.
fn next(words: &[u64], from: usize, flip: u64) -> usize {
    let (mut w, mut mask) = (from / 64, u64::MAX << (from % 64));
    while let Some(bits) = words.get(w) {
        let found = (bits ^ flip) & mask;
        if found != 0 {
            return 64 * w + found.trailing_zeros() as usize;
        }
        (w, mask) = (w + 1, u64::MAX);
    }
    64 * words.len()
}

/// Sets the bits of a stretch.
pub(super) fn set_run(words: &mut [u64], run: Range<usize>) {
    if run.is_empty() {
        return;
    }
    let (first, last) = (run.start / 64, (run.end - 1) / 64);
    let (low, high) = (u64::MAX << (run.start % 64), u64::MAX >> (63 - (run.end - 1) % 64));
    if first == last {
        words[first] |= low & high;
        return;
    }
    words[first] |= low;
    words[first + 1..last].fill(u64::MAX);
    words[last] |= high;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_those_of_the_bits() {
        let bits = |i: usize| (i * i / 7 + i / 40) % 3 == 1 || (70..140).contains(&i);
        let mut words = [0u64; 5];
        for i in (0..320).filter(|&i| bits(i)) {
            words[i / 64] |= 1 << (i % 64);
        }
        let mut again = [0; 5];
        let mut expected_from = 0;
        for run in runs(&words) {
            assert!((expected_from..run.start).all(|i| !bits(i)) && run.clone().all(bits));
            assert!(run.end == 320 || !bits(run.end));
            expected_from = run.end;
            set_run(&mut again, run);
        }
        assert!((expected_from..320).all(|i| !bits(i)));
        assert_eq!(again, words);
        assert_eq!(runs(&[0, 0]).count(), 0);
        assert!(runs(&[u64::MAX; 3]).eq(std::iter::once(0..192)));
    }
}
