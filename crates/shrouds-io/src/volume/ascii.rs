//! Numbers written as text, as the bytes of a binary file.

use std::io::{self, BufRead, Read};

use crate::volume::decode::Element;

/// Bytes that one byte of text can become at most: the last digit of a file may make eight.
pub(super) const EXPANSION: u64 = 8;
/// Longest number that is read.
const MAX_NUMBER: usize = 400;

/// The bytes, little-endian, of numbers between white space or commas. The text ends at its end or
/// at a `<`.
pub(super) struct AsciiNumbers<R> {
    reader: R,
    element: Element,
    /// A number of which the end has not come.
    number: Vec<u8>,
    /// Bytes of numbers that have not been handed out, and how many of them have been.
    bytes: Vec<u8>,
    used: usize,
    ended: bool,
}

impl<R: BufRead> AsciiNumbers<R> {
    pub(super) fn new(reader: R, element: Element) -> Self {
        Self { reader, element, number: Vec::new(), bytes: Vec::new(), used: 0, ended: false }
    }

    /// Makes the bytes of the numbers that end in the next piece of text with any.
    fn refill(&mut self) -> io::Result<()> {
        self.bytes.clear();
        self.used = 0;
        while !self.ended && self.bytes.is_empty() {
            let text = self.reader.fill_buf()?;
            self.ended = text.is_empty();
            let mut used = text.len();
            for (place, byte) in text.iter().enumerate() {
                if !byte.is_ascii_whitespace() && ![b',', b'<'].contains(byte) {
                    self.number.push(*byte);
                    continue;
                }
                push(&mut self.number, self.element, &mut self.bytes)?;
                if *byte == b'<' {
                    (self.ended, used) = (true, place);
                    break;
                }
            }
            self.reader.consume(used);
            if self.number.len() > MAX_NUMBER {
                return Err(not_a_number(&self.number));
            }
        }
        if self.ended { push(&mut self.number, self.element, &mut self.bytes) } else { Ok(()) }
    }
}

impl<R: BufRead> Read for AsciiNumbers<R> {
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

/// Appends the bytes of a number, if there is one, and empties it.
fn push(number: &mut Vec<u8>, element: Element, bytes: &mut Vec<u8>) -> io::Result<()> {
    if number.is_empty() {
        return Ok(());
    }
    macro_rules! parse {
        ($text:expr; $($name:ident $type:ty),*) => {
            match element {
                $(Element::$name => $text.parse().ok()
                    .map(|value: $type| bytes.extend(value.to_le_bytes())),)*
                // No text has halves; a flag is any number that is not 0.
                Element::F16 => None,
                Element::Bool => $text.parse().ok().map(|value: f64| bytes.push(u8::from(value != 0.0))),
            }
        };
    }
    let text = std::str::from_utf8(number).unwrap_or_default();
    let known = parse!(text; U8 u8, I8 i8, U16 u16, I16 i16, U32 u32, I32 i32, U64 u64, I64 i64,
        F32 f32, F64 f64);
    let result = known.ok_or_else(|| not_a_number(number));
    number.clear();
    result
}

fn not_a_number(text: &[u8]) -> io::Error {
    let text = String::from_utf8_lossy(text);
    let problem = format!("'{text:.40}' is no number of this type");
    io::Error::new(io::ErrorKind::InvalidData, problem)
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;

    fn numbers(text: &str, element: Element) -> io::Result<Vec<u8>> {
        let mut all = Vec::new();
        // Pieces of three bytes, so that numbers are cut.
        let reader = BufReader::with_capacity(3, text.as_bytes());
        AsciiNumbers::new(reader, element).read_to_end(&mut all).map(|_| all)
    }

    #[test]
    fn numbers_end_at_space_comma_tag_or_end() {
        assert_eq!(numbers(" 1 22,255\n0", Element::U8).unwrap(), [1, 22, 255, 0]);
        assert_eq!(numbers("-1 -32768</x>9", Element::I16).unwrap(), [255, 255, 0, 128]);
        assert_eq!(numbers("1.5e3 ", Element::F32).unwrap(), 1500f32.to_le_bytes());
        assert_eq!(numbers("", Element::F64).unwrap(), [0; 0]);
    }

    #[test]
    fn other_words_are_refused() {
        for (text, element) in [("256", Element::U8), ("1.5", Element::I32), ("x", Element::F64)] {
            assert!(numbers(text, element).is_err());
        }
        assert!(numbers(&"1".repeat(500), Element::F64).is_err());
    }
}
