//! From the bytes of a chunk file to the bytes of its elements.
//!
//! What a chunk unpacks to is bounded by its shape, and memory grows as bytes are unpacked.

use std::io::{Cursor, Read};

use flate2::read::{MultiGzDecoder, ZlibDecoder};
use ruzstd::decoding::StreamingDecoder;

use crate::volume::zarr::blosc;

/// Window of zstd that is accepted for the smallest chunks.
const MIN_WINDOW: usize = 1 << 23;
/// Room for what a step adds to bytes that it cannot compress.
const OVERHEAD: usize = 1 << 12;

/// A step from bytes to bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Gzip,
    Zlib,
    Zstd,
    /// An LZ4 block after its unpacked length.
    Lz4,
    Blosc,
    /// A checksum at the end.
    Crc32c,
}

impl Packing {
    /// The step that metadata call by this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name.strip_prefix("numcodecs.").unwrap_or(name) {
            "gzip" => Self::Gzip,
            "zlib" => Self::Zlib,
            "zstd" => Self::Zstd,
            "lz4" => Self::Lz4,
            "blosc" => Self::Blosc,
            "crc32c" => Self::Crc32c,
            _ => return None,
        })
    }

    fn undo(self, bytes: Vec<u8>, limit: usize) -> Result<Vec<u8>, String> {
        match self {
            Self::Gzip => read(MultiGzDecoder::new(&bytes[..]), limit, "gzip"),
            Self::Zlib => read(ZlibDecoder::new(&bytes[..]), limit, "zlib"),
            Self::Zstd => zstd(&bytes, limit),
            Self::Lz4 => lz4(&bytes, limit),
            Self::Blosc => blosc::decode(&bytes, limit),
            Self::Crc32c => without_checksum(bytes),
        }
    }
}

/// The bytes of a chunk, which must be `length`, after the steps that packed it.
pub(super) fn unpack(
    mut bytes: Vec<u8>,
    steps: &[Packing],
    length: usize,
) -> Result<Vec<u8>, String> {
    for (left, step) in steps.iter().enumerate().rev() {
        let limit = length.saturating_add(if left > 0 { length / 8 + OVERHEAD } else { 0 });
        bytes = step.undo(bytes, limit)?;
    }
    if bytes.len() == length {
        return Ok(bytes);
    }
    Err(format!("it has {} bytes of voxels, not {length}", bytes.len()))
}

fn read(packed: impl Read, limit: usize, method: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // One more, so that what is too long is not taken for right.
    let done = packed.take(limit as u64 + 1).read_to_end(&mut bytes);
    done.map_err(|error| format!("its {method} data is truncated or damaged ({error})"))?;
    if bytes.len() > limit {
        return Err(format!("it unpacks to more than the {limit} bytes of a chunk"));
    }
    Ok(bytes)
}

pub(super) fn zstd(packed: &[u8], limit: usize) -> Result<Vec<u8>, String> {
    let window = limit.saturating_mul(2).max(MIN_WINDOW) as u64;
    let decoder = StreamingDecoder::new_with_max_window_size(Cursor::new(packed), window);
    let decoder =
        decoder.map_err(|error| format!("its zstd data is truncated or damaged ({error})"))?;
    read(decoder, limit, "zstd")
}

fn lz4(packed: &[u8], limit: usize) -> Result<Vec<u8>, String> {
    let cut = || "its LZ4 data is truncated or damaged".to_owned();
    let (length, block) = packed.split_first_chunk().ok_or_else(cut)?;
    let length = u32::from_le_bytes(*length) as usize;
    if length > limit || length / 256 > block.len() {
        return Err(cut());
    }
    let mut bytes = vec![0; length];
    let done = lz4_flex::block::decompress_into(block, &mut bytes).map_err(|_| cut())?;
    bytes.truncate(done);
    Ok(bytes)
}

fn without_checksum(mut bytes: Vec<u8>) -> Result<Vec<u8>, String> {
    let (data, stored) = bytes.split_last_chunk().ok_or("it is too short for its checksum")?;
    if crc32c(data) != u32::from_le_bytes(*stored) {
        return Err("its checksum is wrong".into());
    }
    bytes.truncate(bytes.len() - 4);
    Ok(bytes)
}

/// The cyclic redundancy check of polynomial 0x1EDC6F41, bits reflected.
fn crc32c(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut n = 0;
        while n < 256 {
            let mut sum = n as u32;
            let mut bit = 0;
            while bit < 8 {
                sum = if sum & 1 == 1 { sum >> 1 ^ 0x82f6_3b78 } else { sum >> 1 };
                bit += 1;
            }
            table[n] = sum;
            n += 1;
        }
        table
    };
    !bytes.iter().fold(!0, |sum, byte| TABLE[(sum as u8 ^ byte) as usize] ^ sum >> 8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        // RFC 3720, B.4, and the check value of the catalogue of such sums.
        assert_eq!(crc32c(b"123456789"), 0xe306_9283);
        assert_eq!(crc32c(&[0; 32]), 0x8a91_36aa);
    }

    #[test]
    fn what_unpacks_to_another_length_is_refused() {
        assert_eq!(unpack(vec![1, 2, 3], &[], 3), Ok(vec![1, 2, 3]));
        let refusal = unpack(vec![1, 2, 3], &[], 4).unwrap_err();
        assert!(refusal.contains("3 bytes of voxels, not 4"), "{refusal}");
    }
}
