//! The bytes of an array of a VTK file: base64 or raw, behind a length or in compressed blocks.

use std::io::{self, BufRead, Read};

use flate2::bufread::ZlibDecoder;

use crate::error::Error;
use crate::stream::{EXPANSION, Stream};
use crate::volume::decode::Endian;

/// How the lengths before the data are stored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lengths {
    pub(super) endian: Endian,
    /// Whether they have 64 bits, not 32.
    pub(super) wide: bool,
}

impl Lengths {
    fn size(self) -> usize {
        if self.wide { 8 } else { 4 }
    }

    fn of(self, bytes: &[u8]) -> u64 {
        let mut all = [0; 8];
        match self.endian {
            Endian::Little => {
                all[..bytes.len()].copy_from_slice(bytes);
                u64::from_le_bytes(all)
            }
            Endian::Big => {
                all[8 - bytes.len()..].copy_from_slice(bytes);
                u64::from_be_bytes(all)
            }
        }
    }

    /// The next of them, which must be there.
    fn next(self, stream: &mut Stream) -> Result<u64, Error> {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..self.size()];
        if stream.fill(bytes)? < bytes.len() {
            return Err(Error::header(stream.path, "the file ends in the lengths before an array"));
        }
        Ok(self.of(bytes))
    }
}

/// The bytes behind their length, which must be `expected`.
pub(super) fn behind_length<'a>(
    mut stream: Stream<'a>,
    lengths: Lengths,
    expected: u64,
) -> Result<Stream<'a>, Error> {
    let length = lengths.next(&mut stream)?;
    // Lengths of 32 bits wrap around in files that old versions wrote.
    if length == expected || (!lengths.wide && length == expected & u64::from(u32::MAX)) {
        // Other arrays may follow.
        return Ok(stream.limited(expected));
    }
    let problem = format!("an array has {length} bytes, the lattice needs {expected}");
    Err(Error::header(stream.path, problem))
}

/// The bytes of blocks compressed by zlib, behind the table of their lengths.
pub(super) fn in_blocks<'a>(
    mut stream: Stream<'a>,
    lengths: Lengths,
    expected: u64,
) -> Result<Stream<'a>, Error> {
    let path = stream.path;
    let count = lengths.next(&mut stream)?;
    let (size, last) = (lengths.next(&mut stream)?, lengths.next(&mut stream)?);
    let whole = count.saturating_sub(u64::from(last > 0));
    let total = whole.saturating_mul(size).saturating_add(last);
    if total != expected {
        let problem =
            format!("the blocks of an array have {total} bytes, the lattice needs {expected}");
        return Err(Error::header(path, problem));
    }
    if stream.most().is_some_and(|most| most / (lengths.size() as u64) < count) {
        return Err(Error::header(
            path,
            format!("an array has {count} blocks, more than fit here"),
        ));
    }
    // Grows with the bytes that arrive.
    let mut blocks = Vec::new();
    for n in 0..count {
        let unpacked = if n < whole { size } else { last };
        blocks.push((lengths.next(&mut stream)?, unpacked));
    }
    blocks.reverse();
    let most = stream.most_times(EXPANSION);
    Ok(stream.through("zlib", most, |reader| Blocks {
        reader,
        blocks,
        packed: Vec::new(),
        bytes: Vec::new(),
        used: 0,
    }))
}

/// Unpacks block by block.
struct Blocks<R> {
    reader: R,
    /// Lengths of the blocks to come, packed and unpacked, the next one last.
    blocks: Vec<(u64, u64)>,
    packed: Vec<u8>,
    /// A block of which `used` bytes have been handed out.
    bytes: Vec<u8>,
    used: usize,
}

impl<R: Read> Read for Blocks<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.used == self.bytes.len() {
            let Some((packed, unpacked)) = self.blocks.pop() else { return Ok(0) };
            self.packed.clear();
            self.bytes.clear();
            self.used = 0;
            self.reader.by_ref().take(packed).read_to_end(&mut self.packed)?;
            let most = unpacked.saturating_add(1);
            ZlibDecoder::new(&self.packed[..]).take(most).read_to_end(&mut self.bytes)?;
            if self.bytes.len() as u64 != unpacked {
                let problem = "a block has another length than the table says";
                return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
            }
        }
        let count = buffer.len().min(self.bytes.len() - self.used);
        buffer[..count].copy_from_slice(&self.bytes[self.used..self.used + count]);
        self.used += count;
        Ok(count)
    }
}

/// The bytes before the next `<`.
pub(super) struct UntilTag<R> {
    reader: R,
    ended: bool,
}

impl<R: BufRead> UntilTag<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, ended: false }
    }
}

impl<R: BufRead> Read for UntilTag<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.ended {
            return Ok(0);
        }
        let text = self.reader.fill_buf()?;
        let tag = text.iter().take(buffer.len()).position(|byte| *byte == b'<');
        self.ended = tag.is_some();
        let count = tag.unwrap_or(buffer.len().min(text.len()));
        buffer[..count].copy_from_slice(&text[..count]);
        self.reader.consume(count);
        Ok(count)
    }
}

/// The bytes of base64 text, which ends at its end or at a `<`. A padded group may be followed by
/// more: VTK encodes the lengths and the data apart.
pub(super) struct Base64<R> {
    reader: R,
    /// Bits of an unfinished group, and how many characters they come from.
    bits: u32,
    held: u32,
    /// Bytes that have not been handed out, and how many of them have been.
    bytes: Vec<u8>,
    used: usize,
    ended: bool,
}

impl<R: BufRead> Base64<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, bits: 0, held: 0, bytes: Vec::new(), used: 0, ended: false }
    }

    fn refill(&mut self) -> io::Result<()> {
        self.bytes.clear();
        self.used = 0;
        while !self.ended && self.bytes.is_empty() {
            let text = self.reader.fill_buf()?;
            self.ended = text.is_empty();
            let mut used = text.len();
            for (place, byte) in text.iter().enumerate() {
                let value = match byte {
                    b'A'..=b'Z' => byte - b'A',
                    b'a'..=b'z' => byte - b'a' + 26,
                    b'0'..=b'9' => byte - b'0' + 52,
                    b'+' => 62,
                    b'/' => 63,
                    b'=' => {
                        // The group holds 0, 1 or 2 whole bytes; further signs find it empty.
                        let whole = (self.held * 6 / 8) as usize;
                        let bits = self.bits << (24 - 6 * self.held);
                        self.bytes.extend(&bits.to_be_bytes()[1..1 + whole]);
                        (self.bits, self.held) = (0, 0);
                        continue;
                    }
                    b'<' => {
                        (self.ended, used) = (true, place);
                        break;
                    }
                    _ if byte.is_ascii_whitespace() => continue,
                    _ => {
                        let problem = format!("the byte {byte:#04x} is no base64");
                        return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
                    }
                };
                self.bits = self.bits << 6 | u32::from(value);
                self.held += 1;
                if self.held == 4 {
                    self.bytes.extend(&self.bits.to_be_bytes()[1..]);
                    (self.bits, self.held) = (0, 0);
                }
            }
            self.reader.consume(used);
        }
        Ok(())
    }
}

impl<R: BufRead> Read for Base64<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.used == self.bytes.len() {
            self.refill()?;
        }
        let count = buffer.len().min(self.bytes.len() - self.used);
        buffer[..count].copy_from_slice(&self.bytes[self.used..self.used + count]);
        self.used += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;

    fn decode(text: &str) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let reader = BufReader::with_capacity(5, text.as_bytes());
        Base64::new(reader).read_to_end(&mut bytes).map(|_| bytes)
    }

    #[test]
    fn base64_follows_the_standard() {
        // RFC 4648, section 10.
        let cases =
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob")];
        for (text, bytes) in cases {
            assert_eq!(decode(text).unwrap(), bytes.as_bytes());
        }
        assert_eq!(decode(" Zm9v\nYmE=Zm8= </DataArray>AAAA").unwrap(), b"foobafo");
        assert_eq!(decode("+/+/").unwrap(), [0xfb, 0xff, 0xbf]);
        assert!(decode("Zm9*").is_err());
    }
}
