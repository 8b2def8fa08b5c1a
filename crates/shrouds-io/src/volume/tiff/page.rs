//! One page of a TIFF file: its layout, and from its strips or tiles to values.

use std::io::Read;

use flate2::bufread::ZlibDecoder;
use weezl::{BitOrder, decode::Decoder};

use crate::error::Error;
use crate::stream::EXPANSION;
use crate::volume::Values;
use crate::volume::decode::{Element, Endian, convert};
use crate::volume::tiff::file::{Directory, TiffFile};
use crate::volume::tiff::predict::{unpredict_floats, unpredict_integers};

mod tags {
    pub(super) const SUBFILE: u16 = 254;
    pub(super) const WIDTH: u16 = 256;
    pub(super) const HEIGHT: u16 = 257;
    pub(super) const BITS: u16 = 258;
    pub(super) const COMPRESSION: u16 = 259;
    pub(super) const PHOTOMETRIC: u16 = 262;
    pub(super) const FILL_ORDER: u16 = 266;
    pub(super) const STRIP_PLACES: u16 = 273;
    pub(super) const SAMPLES: u16 = 277;
    pub(super) const STRIP_ROWS: u16 = 278;
    pub(super) const STRIP_LENGTHS: u16 = 279;
    pub(super) const PREDICTOR: u16 = 317;
    pub(super) const TILE_WIDTH: u16 = 322;
    pub(super) const TILE_HEIGHT: u16 = 323;
    pub(super) const TILE_PLACES: u16 = 324;
    pub(super) const TILE_LENGTHS: u16 = 325;
    pub(super) const FORMAT: u16 = 339;
    pub(super) const DEPTH: u16 = 32997;
}

/// How the bytes of a strip or tile are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
}

impl Compression {
    /// Bytes that one compressed byte can become at most.
    fn expansion(self) -> u64 {
        match self {
            Self::None => 1,
            // A code of 12 bits stands for fewer than 4096 bytes.
            Self::Lzw => 4096 * 8 / 12 + 1,
            Self::Deflate => EXPANSION,
            Self::PackBits => 64,
        }
    }
}

/// What all pages of a volume have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) element: Element,
    /// Bits of a sample: those of the element, or 1, 2 or 4.
    bits: u32,
    /// Stored values grow darker.
    pub(super) white_is_zero: bool,
}

impl Image {
    /// Bytes of an uncompressed row of `width` samples.
    fn row_bytes(self, width: usize) -> u64 {
        (width as u64).saturating_mul(u64::from(self.bits)).div_ceil(8)
    }

    /// Bytes of an uncompressed page.
    pub(super) fn page_bytes(self) -> u64 {
        self.row_bytes(self.width).saturating_mul(self.height as u64)
    }

    /// The values of whole rows.
    fn values(self, bytes: &[u8], endian: Endian) -> Values {
        if self.bits >= 8 {
            return convert(bytes, self.element, endian);
        }
        let (bits, mask) = (self.bits as usize, (1u8 << self.bits) - 1);
        let sample = |row: &[u8], i: usize| row[i * bits / 8] >> (8 - bits - i * bits % 8) & mask;
        let rows = bytes.chunks_exact(self.row_bytes(self.width) as usize);
        rows.flat_map(|row| (0..self.width).map(move |i| sample(row, i)))
            .collect::<Vec<u8>>()
            .into()
    }
}

/// The layout of a page.
pub(super) struct Page {
    pub(super) image: Image,
    compression: Compression,
    predictor: u64,
    /// The lowest bit of a byte is its first sample.
    reversed: bool,
    /// Width and height of a tile; those of the page and of a strip where there are strips.
    chunk: [usize; 2],
    /// Where the strips or tiles are, and their lengths.
    chunks: Vec<(u64, u64)>,
}

/// Whether a page is a smaller copy of another one, or a mask for it.
pub(super) fn is_secondary(file: &mut TiffFile, directory: &Directory) -> Result<bool, Error> {
    Ok(file.number_of(directory, tags::SUBFILE)?.unwrap_or(0) & 5 != 0)
}

impl Page {
    pub(super) fn new(file: &mut TiffFile, directory: &Directory) -> Result<Self, Error> {
        let image = image(file, directory)?;
        let mut number = |tag, default| Ok(file.number_of(directory, tag)?.unwrap_or(default));
        let compression = number(tags::COMPRESSION, 1)?;
        let predictor = number(tags::PREDICTOR, 1)?;
        let reversed = number(tags::FILL_ORDER, 1)? == 2;
        let width = number(tags::TILE_WIDTH, image.width as u64)?;
        let height = number(tags::STRIP_ROWS, image.height as u64)?.min(image.height as u64);
        let height = number(tags::TILE_HEIGHT, height)?;
        let compression = match compression {
            1 => Compression::None,
            5 => Compression::Lzw,
            8 | 32946 => Compression::Deflate,
            32773 => Compression::PackBits,
            other => return Err(compressed_otherwise(file, other)),
        };
        // Rows of tiles are whole bytes, so that they can be put side by side.
        let whole = width >= image.width as u64 || width.saturating_mul(image.bits.into()) % 8 == 0;
        let suits = match predictor {
            _ if !whole => false,
            1 => true,
            2 => image.bits >= 8,
            3 => matches!(image.element, Element::F16 | Element::F32 | Element::F64),
            _ => false,
        };
        let chunk = [width, height].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        if !suits || chunk.contains(&0) {
            let problem = format!("predictor {predictor}, tiles or strips of {width} x {height}");
            return Err(Error::header(file.path, problem));
        }
        let mut page = Self { image, compression, predictor, reversed, chunk, chunks: Vec::new() };
        page.chunks = page.places(file, directory)?;
        Ok(page)
    }

    fn places(&self, file: &mut TiffFile, directory: &Directory) -> Result<Vec<(u64, u64)>, Error> {
        let damaged = |what: &str| Error::header(file.path, format!("a page has {what}"));
        let Image { width, height, .. } = self.image;
        let expected = width.div_ceil(self.chunk[0]).saturating_mul(height.div_ceil(self.chunk[1]));
        let most = expected.saturating_add(1);
        let missing = damaged("no table of its strips or tiles");
        let wrong = damaged("more or fewer strips or tiles than it needs");
        let places = match file.numbers(directory, tags::TILE_PLACES, most)? {
            Some(places) => places,
            None => file.numbers(directory, tags::STRIP_PLACES, most)?.ok_or(missing)?,
        };
        let lengths = match file.numbers(directory, tags::TILE_LENGTHS, most)? {
            Some(lengths) => Some(lengths),
            None => file.numbers(directory, tags::STRIP_LENGTHS, most)?,
        };
        // Old files do without the lengths where nothing is compressed.
        let lengths = match lengths {
            None if self.compression == Compression::None => {
                (0..places.len()).map(|n| self.chunk_bytes(self.rows(n))).collect()
            }
            lengths => lengths.unwrap_or_default(),
        };
        if places.len() != expected || lengths.len() != expected {
            return Err(wrong);
        }
        Ok(places.into_iter().zip(lengths).collect())
    }

    /// Where the data starts, if it is not compressed.
    pub(super) fn raw_start(&self) -> Option<u64> {
        let whole = self.compression == Compression::None && self.chunk[0] == self.image.width;
        self.chunks.first().filter(|_| whole && self.predictor == 1 && !self.reversed).map(|c| c.0)
    }

    /// Counts what the page takes of the file, and checks that it can be all of the page.
    pub(super) fn check(&self, file: &mut TiffFile) -> Result<(), Error> {
        for (n, &(place, length)) in self.chunks.iter().enumerate() {
            let expected = self.chunk_bytes(self.rows(n));
            if length.saturating_mul(self.compression.expansion()) < expected {
                let problem = format!("{length} bytes of a strip or tile cannot be {expected}");
                return Err(Error::header(file.path, problem));
            }
            if place.saturating_add(length) > file.length {
                let (path, found) = (file.path.into(), file.length.saturating_sub(place));
                return Err(Error::Truncated { path, expected: length, found });
            }
            // Its data, and two numbers in tables.
            file.spend(length.saturating_add(4))?;
        }
        Ok(())
    }

    /// Rows of a strip or tile: of strips, the last one is shorter.
    fn rows(&self, n: usize) -> usize {
        let [width, height] = self.chunk;
        let rest = self.image.height.saturating_sub(n.saturating_mul(height));
        if width == self.image.width { height.min(rest) } else { height }
    }

    /// Bytes of an uncompressed strip or tile of so many rows.
    fn chunk_bytes(&self, rows: usize) -> u64 {
        self.image.row_bytes(self.chunk[0]).saturating_mul(rows as u64)
    }

    /// The values, row by row.
    pub(super) fn values(&self, file: &mut TiffFile) -> Result<Values, Error> {
        let [width, height] = self.chunk;
        let across = self.image.width.div_ceil(width);
        // The strips and tiles were checked to be able to hold as much.
        let row = self.image.row_bytes(self.image.width) as usize;
        let chunk_row = self.image.row_bytes(width) as usize;
        let mut page = vec![0; row * self.image.height];
        for (n, &chunk) in self.chunks.iter().enumerate() {
            let bytes = self.chunk(file, chunk, self.rows(n))?;
            let (start, from) = (n / across * height, n % across * chunk_row);
            let rows = page.chunks_exact_mut(row).skip(start);
            for (to, bytes) in rows.zip(bytes.chunks_exact(chunk_row)) {
                let count = chunk_row.min(row - from);
                to[from..from + count].copy_from_slice(&bytes[..count]);
            }
        }
        let endian = match self.predictor {
            2 => Endian::Little,
            3 => Endian::Big,
            _ => file.endian,
        };
        Ok(self.image.values(&page, endian))
    }

    /// The bytes of a strip or tile of so many rows.
    fn chunk(
        &self,
        file: &mut TiffFile,
        (place, length): (u64, u64),
        rows: usize,
    ) -> Result<Vec<u8>, Error> {
        let mut bytes = file.bytes(place, length)?;
        if self.reversed {
            bytes.iter_mut().for_each(|byte| *byte = byte.reverse_bits());
        }
        let expected = self.chunk_bytes(rows) as usize;
        let mut bytes = match self.compression {
            Compression::None => bytes,
            Compression::Lzw => unpack_lzw(&bytes, expected),
            Compression::Deflate => unpack_deflate(file, &bytes, expected)?,
            Compression::PackBits => unpack_bits(&bytes, expected),
        };
        if bytes.len() < expected {
            let (path, expected, found) = (file.path.into(), expected as u64, bytes.len() as u64);
            return Err(Error::Truncated { path, expected, found });
        }
        bytes.truncate(expected);
        let (row, size) = (self.image.row_bytes(self.chunk[0]) as usize, self.image.element.size());
        match self.predictor {
            2 => unpredict_integers(&mut bytes, row, size, file.endian),
            3 => unpredict_floats(&mut bytes, row, size),
            _ => {}
        }
        Ok(bytes)
    }
}

fn image(file: &mut TiffFile, directory: &Directory) -> Result<Image, Error> {
    let mut number = |tag, default| Ok(file.number_of(directory, tag)?.unwrap_or(default));
    let (width, height) = (number(tags::WIDTH, 0)?, number(tags::HEIGHT, 0)?);
    let (samples, depth) = (number(tags::SAMPLES, 1)?, number(tags::DEPTH, 1)?);
    let photometric = number(tags::PHOTOMETRIC, 1)?;
    let (bits, format) = (number(tags::BITS, 1)?, number(tags::FORMAT, 1)?);
    // 0 and 1 are grey values, 3 numbers of colours, 4 a mask.
    if samples != 1 || ![0, 1, 3, 4].contains(&photometric) {
        let what = format!("an image of {samples} samples a pixel (colour model {photometric})");
        let advice = "save one channel, or the labels, as an image of one sample a pixel";
        return Err(Error::unsupported(file.path, what, advice));
    }
    if depth != 1 {
        let what = format!("a page of {depth} slices");
        return Err(Error::unsupported(file.path, what, "write one slice a page"));
    }
    let element = match (format, bits) {
        (1 | 4, 1 | 2 | 4 | 8) => Element::U8,
        (1 | 4, 16) => Element::U16,
        (1 | 4, 32) => Element::U32,
        (1 | 4, 64) => Element::U64,
        (2, 8) => Element::I8,
        (2, 16) => Element::I16,
        (2, 32) => Element::I32,
        (2, 64) => Element::I64,
        (3, 16) => Element::F16,
        (3, 32) => Element::F32,
        (3, 64) => Element::F64,
        _ => {
            let what = format!("samples of {bits} bits in format {format}");
            let advice = "convert it to an integer or float type";
            return Err(Error::unsupported(file.path, what, advice));
        }
    };
    if width == 0 || height == 0 {
        return Err(Error::header(file.path, format!("a page of {width} x {height} pixels")));
    }
    let [width, height] = [width, height].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    Ok(Image { width, height, element, bits: bits as u32, white_is_zero: photometric == 0 })
}

fn compressed_otherwise(file: &TiffFile, code: u64) -> Error {
    let name = match code {
        2..=4 => "fax",
        6 | 7 => "JPEG",
        34712 | 33003 | 33004 | 33005 => "JPEG 2000",
        34887 => "LERC",
        34925 => "LZMA",
        50000 => "Zstandard",
        50001 | 34927 => "WebP",
        _ => "an unusual method",
    };
    let what = format!("a TIFF compressed by {name} (code {code})");
    Error::unsupported(file.path, what, "write it uncompressed, or by LZW, deflate or PackBits")
}

fn unpack_deflate(file: &TiffFile, bytes: &[u8], expected: usize) -> Result<Vec<u8>, Error> {
    let mut unpacked = Vec::new();
    // One byte more, so that the checksum at the end is read.
    let result = ZlibDecoder::new(bytes).take(expected as u64 + 1).read_to_end(&mut unpacked);
    let failed = |cause| Error::Compressed { path: file.path.into(), method: "zlib", cause };
    result.map(|_| unpacked).map_err(failed)
}

/// As much as there is, at most `expected` bytes.
fn unpack_lzw(bytes: &[u8], expected: usize) -> Vec<u8> {
    let mut decoder = Decoder::with_tiff_size_switch(BitOrder::Msb, 8);
    let mut unpacked = vec![0; expected];
    let (mut read, mut written) = (0, 0);
    while written < expected {
        let step = decoder.decode_bytes(&bytes[read..], &mut unpacked[written..]);
        (read, written) = (read + step.consumed_in, written + step.consumed_out);
        if step.status.is_err() || step.consumed_in + step.consumed_out == 0 {
            break;
        }
    }
    unpacked.truncate(written);
    unpacked
}

/// As much as there is: runs of a byte that repeats, and of bytes as they are.
fn unpack_bits(bytes: &[u8], expected: usize) -> Vec<u8> {
    let mut unpacked = Vec::new();
    let mut rest = bytes;
    while let ([first, after @ ..], true) = (rest, unpacked.len() < expected) {
        rest = match (*first as i8, after) {
            (-128, _) => after,
            (count @ 0.., _) => {
                let (run, after) = after.split_at(after.len().min(count as usize + 1));
                unpacked.extend(run);
                after
            }
            (count, [byte, after @ ..]) => {
                unpacked.resize(unpacked.len() + 1 + usize::from(count.unsigned_abs()), *byte);
                after
            }
            (_, []) => after,
        };
    }
    unpacked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pack_bits_follows_the_example_of_the_standard() {
        let packed = [
            0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7,
            0xaa,
        ];
        let unpacked = [
            0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22,
            0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa,
        ];
        assert_eq!(unpack_bits(&packed, 24), unpacked);
        assert_eq!(unpack_bits(&[0x80, 0x05, 1, 2], 6), [1, 2]);
        assert_eq!(unpack_bits(&[0xff], 6), [0; 0]);
    }
}
