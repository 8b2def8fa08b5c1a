//! The pixels of all frames: native, or coded frame by frame.

use std::io::Read;

use flate2::read::DeflateDecoder;

use crate::error::Error;
use crate::volume::Values;
use crate::volume::decode::Endian;
use crate::volume::dicom::elements::Reader;

/// How the pixels of a frame are coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    Native,
    RunLength,
    Deflate,
}

impl Coding {
    /// The coding that a transfer syntax names, and the reader set up for the elements in it.
    pub(super) fn new<'a>(
        mut reader: Reader<'a>,
        transfer_syntax: &str,
    ) -> Result<(Self, Reader<'a>), Error> {
        let Some(name) = transfer_syntax.strip_prefix("1.2.840.10008.1.2") else {
            return Err(reader.damaged(format!("the transfer syntax is '{transfer_syntax}'")));
        };
        let coding = match name {
            // Implicit, explicit, big endian, deflated as a whole, uncompressed with a fragment each frame.
            "" | ".1" | ".2" | ".1.99" | ".1.98" => Self::Native,
            ".5" => Self::RunLength,
            ".8.1" => Self::Deflate,
            _ => {
                let what = format!("DICOM pixels in transfer syntax {transfer_syntax}");
                let advice = "write it again uncompressed (Explicit VR Little Endian) or as RLE";
                return Err(Error::unsupported(reader.stream.path, what, advice));
            }
        };
        reader.explicit = !name.is_empty();
        if name == ".2" {
            reader.endian = Endian::Big;
        }
        Ok((coding, if name == ".1.99" { reader.inflate() } else { reader }))
    }
}

/// The shape of the pixels of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    pub(super) frames: usize,
    /// Of each frame.
    pub(super) pixels: usize,
    /// Of each pixel: 1, 8 or 16.
    pub(super) bits: usize,
}

/// The pixels of all frames.
#[derive(Debug)]
pub(super) enum Pixels {
    /// Without a gap even between bits.
    Whole(Vec<u8>),
    /// Each from its own first bit on.
    Frames(Vec<Vec<u8>>),
}

/// Which pixels of a frame are inside, 64 to a word.
pub(super) type Mask = Vec<u64>;

impl Stored {
    fn frame_bytes(self) -> usize {
        (self.pixels * self.bits).div_ceil(8)
    }

    /// The pixels, which are `length` bytes or else follow in fragments.
    pub(super) fn read(
        self,
        reader: &mut Reader,
        coding: Coding,
        length: Option<u32>,
    ) -> Result<Pixels, Error> {
        let path = reader.stream.path;
        let Some(length) = length else { return self.read_fragments(reader, coding) };
        if coding != Coding::Native {
            return Err(reader.damaged("compressed pixels have a length"));
        }
        let bits = self.frames as u128 * self.pixels as u128 * self.bits as u128;
        let expected = u64::try_from(bits.div_ceil(8)).unwrap_or(u64::MAX);
        if u64::from(length) < expected {
            return Err(Error::Truncated { path: path.into(), expected, found: length.into() });
        }
        reader.bytes(expected).map(Pixels::Whole)
    }

    fn read_fragments(self, reader: &mut Reader, coding: Coding) -> Result<Pixels, Error> {
        // The first lists offsets, or nothing.
        reader.fragment()?;
        let mut frames = Vec::new();
        while let Some(fragment) = reader.fragment()? {
            if frames.len() == self.frames {
                return Err(reader.damaged("it has more fragments of pixels than frames"));
            }
            let decoded = match coding {
                Coding::Native => Some(fragment),
                Coding::RunLength => self.run_lengths(&fragment),
                Coding::Deflate => self.inflated(&fragment),
            };
            let whole = decoded.filter(|bytes| bytes.len() >= self.frame_bytes());
            let number = frames.len() + 1;
            frames.push(whole.ok_or_else(|| {
                reader.damaged(format!("the pixels of frame {number} are truncated or damaged"))
            })?);
        }
        if frames.len() < self.frames {
            let (found, frames) = (frames.len(), self.frames);
            return Err(reader.damaged(format!("it has pixels of {found} of {frames} frames")));
        }
        Ok(Pixels::Frames(frames))
    }

    /// RLE Lossless: a plane for each byte of a pixel, the highest first.
    fn run_lengths(self, fragment: &[u8]) -> Option<Vec<u8>> {
        let word = |n: usize| {
            let bytes = fragment.get(4 * n..4 * n + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(bytes) as usize)
        };
        let planes = self.bits.div_ceil(8);
        if word(0)? != planes {
            return None;
        }
        let plane_bytes = self.frame_bytes() / planes;
        let mut frame = Vec::new();
        for plane in 0..planes {
            let end = if plane + 1 < planes { word(plane + 2)? } else { fragment.len() };
            let bytes = unpack_bits(fragment.get(word(plane + 1)?..end)?, plane_bytes)?;
            if planes == 1 {
                return Some(bytes);
            }
            frame.resize(planes * plane_bytes, 0);
            for (pixel, byte) in frame.chunks_exact_mut(planes).zip(bytes) {
                pixel[planes - 1 - plane] = byte;
            }
        }
        Some(frame)
    }

    fn inflated(self, fragment: &[u8]) -> Option<Vec<u8>> {
        let mut frame = Vec::new();
        let most = self.frame_bytes() as u64;
        DeflateDecoder::new(fragment).take(most).read_to_end(&mut frame).ok()?;
        Some(frame)
    }

    /// The bytes of a frame of whole bytes.
    fn frame(self, pixels: &Pixels, n: usize) -> &[u8] {
        let bytes = self.frame_bytes();
        match pixels {
            Pixels::Whole(all) => &all[n * bytes..(n + 1) * bytes],
            Pixels::Frames(frames) => &frames[n][..bytes],
        }
    }

    /// The labels of a frame of a label map, or as many zeros.
    pub(super) fn labels(self, pixels: &Pixels, frame: Option<usize>) -> Values {
        let frame = frame.map(|n| self.frame(pixels, n));
        match (frame, self.bits) {
            (Some(frame), 16) => {
                let labels = frame.as_chunks().0.iter().map(|label| u16::from_le_bytes(*label));
                Values::U16(labels.collect())
            }
            (None, 16) => Values::U16(vec![0; self.pixels]),
            (Some(frame), _) => Values::U8(frame.into()),
            (None, _) => Values::U8(vec![0; self.pixels]),
        }
    }

    /// The inside pixels of each frame; of fractional ones those of at least half of `maximum`.
    pub(super) fn masks(self, pixels: Pixels, maximum: Option<usize>) -> Vec<Mask> {
        let mask = |n: usize| match (&pixels, maximum) {
            (_, Some(maximum)) => at_least_half(self.frame(&pixels, n), maximum),
            (Pixels::Whole(all), None) => bit_range(all, n * self.pixels, self.pixels),
            (Pixels::Frames(frames), None) => bit_range(&frames[n], 0, self.pixels),
        };
        (0..self.frames).map(mask).collect()
    }
}

/// PackBits: a count and that many bytes, or a count and a byte to be repeated.
fn unpack_bits(mut packed: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    while bytes.len() < length {
        let (count, rest) = packed.split_first()?;
        packed = match *count {
            count @ 0..128 => {
                let (literal, rest) = rest.split_at_checked(usize::from(count) + 1)?;
                bytes.extend_from_slice(literal);
                rest
            }
            128 => rest,
            count => {
                let (byte, rest) = rest.split_first()?;
                bytes.resize(bytes.len() + 257 - usize::from(count), *byte);
                rest
            }
        };
    }
    bytes.truncate(length);
    Some(bytes)
}

fn at_least_half(pixels: &[u8], maximum: usize) -> Mask {
    let word = |pixels: &[u8]| {
        let bits = pixels.iter().rev().map(|pixel| u64::from(2 * usize::from(*pixel) >= maximum));
        bits.fold(0, |word, bit| word << 1 | bit)
    };
    pixels.chunks(64).map(word).collect()
}

/// `count` bits from bit `first` on, the lowest bit of a byte being its first.
fn bit_range(bytes: &[u8], first: usize, count: usize) -> Mask {
    let shift = first % 8;
    let bytes = &bytes[first / 8..(first + count).div_ceil(8)];
    let word = |n: usize| {
        // 64 bits that start within a byte end within the ninth.
        let mut nine = [0; 16];
        let part = &bytes[8 * n..bytes.len().min(8 * n + 9)];
        nine[..part.len()].copy_from_slice(part);
        let word = (u128::from_le_bytes(nine) >> shift) as u64;
        match count - 64 * n {
            left @ 0..64 => word & ((1 << left) - 1),
            _ => word,
        }
    };
    (0..count.div_ceil(64)).map(word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_found_wherever_a_frame_starts() {
        let bytes: Vec<u8> = (0..40).map(|n| (n * 37 + n * n) as u8).collect();
        let bit = |n: usize| bytes[n / 8] >> (n % 8) & 1 == 1;
        for (first, count) in (0..70).flat_map(|first| (1..200).map(move |count| (first, count))) {
            let mask = bit_range(&bytes, first, count);
            assert_eq!(mask.len(), count.div_ceil(64));
            for n in 0..64 * mask.len() {
                let expected = n < count && bit(first + n);
                assert_eq!(mask[n / 64] >> (n % 64) & 1 == 1, expected, "{first} {count} {n}");
            }
        }
    }

    #[test]
    fn runs_unpack_as_in_the_standard() {
        // The example of PackBits everywhere: PS3.5 G.3 has the rules only.
        let packed = [0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0x80, 0xfd, 0xaa, 0x00, 0x07];
        let expected = [0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x07];
        assert_eq!(unpack_bits(&packed, 11).unwrap(), expected);
        assert_eq!(unpack_bits(&packed, 12), None);
        assert_eq!(unpack_bits(&[5, 1, 2], 6), None);
    }

    #[test]
    fn half_is_inside() {
        let values = [0, 127, 128, 255];
        assert_eq!(at_least_half(&values, 255), [0b1100]);
        assert_eq!(at_least_half(&values, 254), [0b1110]);
        assert_eq!(at_least_half(&[1, 0], 1), [0b01]);
    }
}
