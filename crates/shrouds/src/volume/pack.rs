//! From values to bits, vector by vector.

use crate::parallel;

/// Values whose flags are made at a time: few enough to stay in the first cache.
const CHUNK: usize = 512;

/// The bits of one row of values. `mark` sets the flag of each value of a block, in a loop that
/// compilers vectorise.
#[inline]
pub(super) fn pack_row<T: Copy>(
    values: &[T],
    words: &mut [u64],
    mark: impl Fn(&[T; 64], &mut [bool; 64]),
) {
    let mut flags = [[false; 64]; CHUNK / 64];
    for (values, words) in values.chunks(CHUNK).zip(words.chunks_mut(CHUNK / 64)) {
        let (blocks, rest) = values.as_chunks::<64>();
        for (block, flags) in blocks.iter().zip(&mut flags) {
            mark(block, flags);
        }
        if let Some(&last) = rest.last() {
            let mut block = [last; 64];
            block[..rest.len()].copy_from_slice(rest);
            mark(&block, &mut flags[blocks.len()]);
            flags[blocks.len()][rest.len()..].fill(false);
        }
        for (word, flags) in words.iter_mut().zip(&flags) {
            *word = pack(flags);
        }
    }
}

/// Bit `i` is flag `i`.
#[inline]
fn pack(flags: &[bool; 64]) -> u64 {
    let mut bytes = [0; 8];
    for (byte, flags) in bytes.iter_mut().zip(flags.as_chunks::<8>().0) {
        // Bytes of 0 or 1 that move together until all eight bits are in the lowest.
        let bits = u64::from_le_bytes(flags.map(u8::from));
        let bits = bits | bits >> 7;
        let bits = bits | bits >> 14;
        *byte = (bits | bits >> 28) as u8;
    }
    u64::from_le_bytes(bytes)
}

/// The bits of a volume of `dims` lattice points in rows along x, given in rows along z that come by
/// y, then x.
pub(super) fn reverse_axes(words: &[u64], [nx, ny, nz]: [usize; 3]) -> Vec<u64> {
    let (from_words, to_words) = (nz.div_ceil(64), nx.div_ceil(64));
    let mut reversed = vec![0; to_words * ny * nz];
    // Sixty-four slices at a time, and in them squares of 64 × 64 bits.
    let ends = (0..from_words).map(|n| nz.min(64 * (n + 1)) * ny * to_words);
    parallel::pieces(&mut reversed, ends, |n, slices| {
        for (j, w) in (0..ny).flat_map(|j| (0..to_words).map(move |w| (j, w))) {
            let mut square = [0; 64];
            for (row, i) in square.iter_mut().zip(64 * w..nx) {
                *row = words[(i * ny + j) * from_words + n];
            }
            transpose(&mut square);
            for (slice, row) in slices.chunks_exact_mut(ny * to_words).zip(square) {
                slice[j * to_words + w] = row;
            }
        }
    });
    reversed
}

/// Swaps bit `j` of word `i` with bit `i` of word `j`: the off-diagonal blocks of every block, from
/// 32 × 32 bits down to one.
fn transpose(square: &mut [u64; 64]) {
    let mut mask = u64::MAX >> 32;
    let mut width = 32;
    while width > 0 {
        for block in square.chunks_exact_mut(2 * width) {
            let (low, high) = block.split_at_mut(width);
            for (a, b) in low.iter_mut().zip(high) {
                let difference = (*a >> width ^ *b) & mask;
                *a ^= difference << width;
                *b ^= difference;
            }
        }
        width /= 2;
        mask ^= mask << width;
    }
}
