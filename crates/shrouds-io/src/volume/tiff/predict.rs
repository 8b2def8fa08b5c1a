//! Predictors of TIFF: rows stored as differences of neighbouring samples.

use crate::volume::decode::Endian;

/// Sums up the differences of predictor 2, samples of `size` bytes in rows of `row` bytes, which then
/// are little-endian.
pub(super) fn unpredict_integers(bytes: &mut [u8], row: usize, size: usize, endian: Endian) {
    if endian == Endian::Big {
        bytes.chunks_exact_mut(size).for_each(<[u8]>::reverse);
    }
    macro_rules! sum {
        ($type:ty) => {
            for row in bytes.chunks_exact_mut(row) {
                let mut last: $type = 0;
                for sample in row.as_chunks_mut::<{ size_of::<$type>() }>().0 {
                    last = last.wrapping_add(<$type>::from_le_bytes(*sample));
                    *sample = last.to_le_bytes();
                }
            }
        };
    }
    match size {
        1 => sum!(u8),
        2 => sum!(u16),
        4 => sum!(u32),
        _ => sum!(u64),
    }
}

/// Undoes predictor 3: differences of bytes, the first bytes of all samples of a row coming first, then
/// the second ones; the samples then are big-endian.
pub(super) fn unpredict_floats(bytes: &mut [u8], row: usize, size: usize) {
    let mut planes = vec![0; row];
    for row in bytes.chunks_exact_mut(row) {
        let mut last = 0u8;
        for (sum, byte) in planes.iter_mut().zip(row.iter()) {
            last = last.wrapping_add(*byte);
            *sum = last;
        }
        let samples = row.len() / size;
        for (i, sample) in row.chunks_exact_mut(size).enumerate() {
            for (plane, byte) in sample.iter_mut().enumerate() {
                *byte = planes[plane * samples + i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_integers_are_summed_up_row_by_row() {
        let mut bytes = [1, 2, 255, 10, 1, 1];
        unpredict_integers(&mut bytes, 3, 1, Endian::Big);
        assert_eq!(bytes, [1, 3, 2, 10, 11, 12]);
        let mut wide = [0u16, 300, 65535].map(u16::to_be_bytes).concat();
        unpredict_integers(&mut wide, 6, 2, Endian::Big);
        assert_eq!(wide, [0u16, 300, 299].map(u16::to_le_bytes).concat());
    }

    #[test]
    fn bytes_of_floats_come_back_from_their_planes() {
        let samples = [1.5f32, -2.25, 1e-9];
        let stored: Vec<u8> =
            (0..4).flat_map(|plane| samples.map(|sample| sample.to_be_bytes()[plane])).collect();
        let mut last = 0;
        let mut differences: Vec<u8> = stored
            .iter()
            .map(|byte| byte.wrapping_sub(std::mem::replace(&mut last, *byte)))
            .collect();
        unpredict_floats(&mut differences, 12, 4);
        assert_eq!(differences, samples.map(f32::to_be_bytes).concat());
    }
}
