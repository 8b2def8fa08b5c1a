//! Blosc 1 buffers: blocks of a chunk, each compressed by itself after its bytes or bits were sorted
//! by their place in the element.
//!
//! Format: "Blosc Chunk Format" of c-blosc 1. Nothing is allocated beyond what the compressed bytes
//! can become.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::volume::zarr::codec::zstd;

const HEADER: usize = 16;
/// Shortest part of a block that is compressed apart from the others, and most parts.
const MIN_SPLIT: usize = 128;
const MAX_SPLITS: usize = 16;
/// Bytes that one byte of LZ4 or BloscLZ can become at most.
const EXPANSION: usize = 256;
/// Farthest match of BloscLZ that needs no extra bytes.
const MAX_DISTANCE: usize = 8191;

/// What a buffer says of itself.
struct Header {
    flags: u8,
    element: usize,
    length: usize,
    block: usize,
}

/// The bytes of a buffer, at most `limit`.
pub(super) fn decode(bytes: &[u8], limit: usize) -> Result<Vec<u8>, String> {
    let header = read_header(bytes, limit)?;
    if header.flags & 2 != 0 {
        let stored = bytes.get(HEADER..HEADER + header.length).ok_or("the bytes end too early")?;
        return Ok(stored.into());
    }
    let mut decoded = Vec::new();
    for (n, start) in (0..header.length).step_by(header.block.max(1)).enumerate() {
        let length = header.block.min(header.length - start);
        let place = number(bytes, HEADER + 4 * n).filter(|place| *place >= HEADER);
        let source = place.and_then(|place| bytes.get(place..)).ok_or("a block lies outside")?;
        let block = decode_block(&header, source, length)?;
        let sorted = if header.flags & 4 != 0 {
            gather_bits(&block, header.element)
        } else if header.flags & 1 != 0 {
            gather_bytes(&block, header.element)
        } else {
            block
        };
        decoded.extend(sorted);
    }
    Ok(decoded)
}

fn read_header(bytes: &[u8], limit: usize) -> Result<Header, String> {
    let (Some(length), Some(block)) = (number(bytes, 4), number(bytes, 8)) else {
        return Err("the Blosc header is cut off".into());
    };
    let header = Header { flags: bytes[2], element: bytes[3].into(), length, block };
    // Version 2 has other flags, but its number is 3 and more.
    if bytes[0] > 2 || header.element == 0 {
        return Err(format!("the Blosc header is damaged or of version {}", bytes[0]));
    }
    if length > limit {
        return Err(format!("it unpacks to {length} bytes, more than the {limit} of a chunk"));
    }
    if length > 0 && block == 0 {
        return Err("the Blosc blocks are empty".into());
    }
    Ok(header)
}

fn number(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..at + 4)?.try_into().ok()?;
    usize::try_from(i32::from_le_bytes(bytes)).ok()
}

fn decode_block(header: &Header, mut source: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let whole = length == header.block;
    let split = header.flags & 0x10 == 0
        && header.element <= MAX_SPLITS
        && length / header.element >= MIN_SPLIT
        && whole;
    let parts = if split { header.element } else { 1 };
    let part = length / parts;
    let mut block = Vec::new();
    for _ in 0..parts {
        let count = number(source, 0).ok_or("a block is cut off")?;
        let packed = source[4..].get(..count).ok_or("a block is cut off")?;
        source = &source[4 + count..];
        if count == part {
            block.extend_from_slice(packed);
        } else {
            let unpacked = decompress(header.flags >> 5, packed, part)?;
            if unpacked.len() != part {
                return Err("a block unpacks to another length than it should".into());
            }
            block.extend(unpacked);
        }
    }
    // Elements that do not divide a block leave bytes over, which no split has.
    if block.len() == length { Ok(block) } else { Err("the blocks are not whole elements".into()) }
}

fn decompress(method: u8, packed: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let room = || {
        let possible = length / EXPANSION <= packed.len();
        possible.then(|| vec![0; length]).ok_or_else(|| "a block is cut off".to_owned())
    };
    match method {
        0 => blosclz(packed, length).ok_or_else(|| "a BloscLZ block is damaged".into()),
        1 => {
            let mut unpacked = room()?;
            let done = lz4_flex::block::decompress_into(packed, &mut unpacked);
            unpacked.truncate(done.map_err(|error| format!("an LZ4 block is damaged ({error})"))?);
            Ok(unpacked)
        }
        3 => {
            let mut unpacked = Vec::new();
            let done = ZlibDecoder::new(packed).take(length as u64).read_to_end(&mut unpacked);
            done.map_err(|error| format!("a zlib block is damaged ({error})"))?;
            Ok(unpacked)
        }
        4 => zstd(packed, length),
        _ => Err("it is compressed with Snappy or a newer method".into()),
    }
}

/// BloscLZ: runs of literal bytes, and matches of 3 and more bytes at a distance.
fn blosclz(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut bytes = packed.iter().copied().map(usize::from);
    let mut unpacked: Vec<u8> = Vec::new();
    // The first is a literal whatever its upper bits say.
    let mut control = bytes.next()? & 31;
    loop {
        if control < 32 {
            for _ in 0..=control {
                unpacked.push(bytes.next()? as u8);
            }
        } else {
            let mut count = (control >> 5) + 2;
            if control >> 5 == 7 {
                loop {
                    let more = bytes.next()?;
                    count += more;
                    if more < 255 || count > length {
                        break;
                    }
                }
            }
            let (high, low) = ((control & 31) << 8, bytes.next()?);
            let distance = if low == 255 && high == 31 << 8 {
                MAX_DISTANCE + 1 + (bytes.next()? << 8 | bytes.next()?)
            } else {
                high + low + 1
            };
            let start = unpacked.len().checked_sub(distance)?;
            if count > length - unpacked.len() {
                return None;
            }
            for n in start..start + count {
                unpacked.push(unpacked[n]);
            }
        }
        if unpacked.len() > length {
            return None;
        }
        match bytes.next() {
            Some(next) => control = next,
            None => return Some(unpacked),
        }
    }
}

/// Elements from the first bytes of all of them, then the second ones and so on.
fn gather_bytes(block: &[u8], element: usize) -> Vec<u8> {
    let count = block.len() / element;
    let mut gathered = block.to_vec();
    for (n, bytes) in block.chunks_exact(count.max(1)).take(element).enumerate() {
        for (target, byte) in gathered.chunks_exact_mut(element).zip(bytes) {
            target[n] = *byte;
        }
    }
    gathered
}

/// Elements from the first bits of all of them, then the second ones and so on.
fn gather_bits(block: &[u8], element: usize) -> Vec<u8> {
    let count = block.len() / element;
    let mut gathered = block.to_vec();
    // Other numbers of elements were not sorted.
    if count == 0 || !count.is_multiple_of(8) {
        return gathered;
    }
    for (n, rows) in block.chunks_exact(count).take(element).enumerate() {
        for m in 0..count / 8 {
            let bits = std::array::from_fn(|row| rows[row * count / 8 + m]);
            for (k, byte) in transposed(bits).into_iter().enumerate() {
                gathered[(8 * m + k) * element + n] = byte;
            }
        }
    }
    gathered
}

/// Bit `j` of byte `i` for bit `i` of byte `j`, in blocks of 1, 2 and 4 bits.
fn transposed(bits: [u8; 8]) -> [u8; 8] {
    let mut bits = u64::from_le_bytes(bits);
    for (shift, mask) in
        [(7, 0x00aa_00aa_00aa_00aa), (14, 0x0000_cccc_0000_cccc), (28, 0x0000_0000_f0f0_f0f0)]
    {
        let swapped = (bits ^ bits >> shift) & mask;
        bits ^= swapped ^ swapped << shift;
    }
    bits.to_le_bytes()
}
