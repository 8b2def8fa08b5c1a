//! Rows of lattice points as words of bits.

/// Word `w` of a row moved down by one bit: bit `i` is lattice point `i + 1`.
#[inline]
pub(crate) fn shifted(row: &[u64], w: usize) -> u64 {
    row[w] >> 1 | row.get(w + 1).map_or(0, |next| next << 63)
}

/// The bits of word `w` that stand for indices below `end`.
#[inline]
pub(crate) fn mask_below(end: usize, w: usize) -> u64 {
    match end.saturating_sub(64 * w) {
        0 => 0,
        n if n >= 64 => u64::MAX,
        n => (1 << n) - 1,
    }
}

/// The positions of the set bits of a word, lowest first.
#[inline]
pub(crate) fn set_bits(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        (word != 0).then(|| {
            let bit = word.trailing_zeros();
            word &= word - 1;
            bit
        })
    })
}

/// Number of set bits below `bit`, which is below 64.
#[inline]
pub(crate) fn rank(word: u64, bit: u32) -> u32 {
    (word & ((1 << bit) - 1)).count_ones()
}
