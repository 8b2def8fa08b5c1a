//! From stored bytes to elements: the one decoder of all formats whose elements follow each other.

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::{Slabs, Values};

/// Bytes decoded at a time, unless a row is longer; a multiple of every element size.
const CHUNK: usize = 1 << 20;

/// Byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

/// The name of [`ElementType`] among the readers.
pub(super) use ElementType as Element;

/// Type of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // Each variant is named after its type.
pub enum ElementType {
    Bool,
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
}

impl ElementType {
    /// All types.
    pub const ALL: [Self; 12] = [
        Self::Bool,
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F16,
        Self::F32,
        Self::F64,
    ];

    /// Its name: `bool`, `uint8` … `int64`, `float16`, `float32`, `float64`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F16 => "float16",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }

    /// The type of this name, which may also be short: `u8` … `i64`, `f16`, `f32`, `f64`.
    pub fn from_name(name: &str) -> Option<Self> {
        let short = |long: &str| {
            let width = long.trim_start_matches(|letter: char| letter.is_ascii_alphabetic());
            format!("{}{width}", &long[..1])
        };
        let name = name.trim().to_lowercase();
        let named = |element: &Self| {
            let long = element.name();
            long == name || (long != "bool" && short(long) == name)
        };
        Self::ALL.into_iter().find(named)
    }

    /// Bytes of one element.
    pub fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

/// `$body` with `$convert` bound to the function from stored bytes to an element.
macro_rules! with_element {
    ($element:expr, $endian:expr, $convert:ident => $body:expr) => {
        with_element!(@types $element, $endian, $convert => $body;
            U8 u8, I8 i8, U16 u16, I16 i16, U32 u32, I32 i32, U64 u64, I64 i64, F32 f32, F64 f64)
    };
    (@types $element:expr, $endian:expr, $convert:ident => $body:expr; $($name:ident $type:ty),*) => {
        match ($element, $endian) {
            (Element::Bool, _) => {
                let $convert = |[byte]: [u8; 1]| byte != 0;
                $body
            }
            (Element::F16, Endian::Little) => {
                let $convert = |bytes| half(u16::from_le_bytes(bytes));
                $body
            }
            (Element::F16, Endian::Big) => {
                let $convert = |bytes| half(u16::from_be_bytes(bytes));
                $body
            }
            $((Element::$name, Endian::Little) => {
                let $convert = <$type>::from_le_bytes;
                $body
            }
            (Element::$name, Endian::Big) => {
                let $convert = <$type>::from_be_bytes;
                $body
            })*
        }
    };
}

impl Element {
    /// The bytes, little-endian, of an element that is written as a decimal number.
    pub(super) fn parse(self, text: &str) -> Option<Vec<u8>> {
        macro_rules! bytes {
            ($type:ty) => {
                text.parse::<$type>().ok()?.to_le_bytes().into()
            };
        }
        Some(match self {
            Self::Bool => vec![u8::from(text.parse::<u8>().ok()? != 0)],
            Self::U8 => bytes!(u8),
            Self::I8 => bytes!(i8),
            Self::U16 => bytes!(u16),
            Self::I16 => bytes!(i16),
            Self::U32 => bytes!(u32),
            Self::I32 => bytes!(i32),
            Self::U64 => bytes!(u64),
            Self::I64 => bytes!(i64),
            Self::F32 => bytes!(f32),
            Self::F64 => bytes!(f64),
            Self::F16 => return None,
        })
    }
}

/// The elements of a volume file that follow each other in one stream, and what its header says of
/// them.
///
/// Memory grows with the bytes that arrive; the length of an uncompressed file is checked first, the
/// checksum of a compressed one last. Bytes after the last element are tolerated.
pub(super) struct Elements<'a> {
    stream: Stream<'a>,
    element: Element,
    endian: Endian,
    count: usize,
    /// How many have been handed out.
    done: usize,
    /// How many are handed out at a time.
    step: usize,
    buffer: Vec<u8>,
}

impl<'a> Elements<'a> {
    /// `count` elements in rows of `row`; the stream stands before the first of them.
    pub(super) fn new(
        stream: Stream<'a>,
        element: Element,
        endian: Endian,
        count: usize,
        row: usize,
    ) -> Self {
        let step = row * (CHUNK / element.size() / row).max(1);
        Self { stream, element, endian, count, done: 0, step, buffer: Vec::new() }
    }

    /// The next elements, converted.
    fn read<T, const SIZE: usize>(
        &mut self,
        convert: impl Fn([u8; SIZE]) -> T,
    ) -> Result<Vec<T>, Error> {
        let path = self.stream.path;
        let expected = self.count as u64 * SIZE as u64;
        let truncated = |found: u64| Error::Truncated { path: path.into(), expected, found };
        let read = self.done as u64 * SIZE as u64;
        if let Some(left) = self.stream.remaining().filter(|left| *left < expected - read) {
            return Err(truncated(read + left));
        }
        if self.stream.most().is_some_and(|left| left < expected - read) {
            let problem =
                format!("it promises {expected} bytes of voxels, more than are packed here");
            return Err(Error::header(path, problem));
        }
        let count = self.step.min(self.count - self.done);
        self.buffer.resize(count * SIZE, 0);
        let found = self.stream.fill(&mut self.buffer)?;
        if found < self.buffer.len() {
            return Err(truncated(read + found as u64));
        }
        self.done += count;
        Ok(convert_all(&self.buffer, convert))
    }
}

/// The elements that these bytes are.
pub(super) fn decode(element: Element, endian: Endian, bytes: &[u8]) -> Values {
    with_element!(element, endian, convert => convert_all(bytes, convert).into())
}

fn convert_all<T, const SIZE: usize>(bytes: &[u8], convert: impl Fn([u8; SIZE]) -> T) -> Vec<T> {
    bytes.as_chunks::<SIZE>().0.iter().map(|bytes| convert(*bytes)).collect()
}

impl Slabs for Elements<'_> {
    fn next(&mut self) -> Result<Option<Values>, Error> {
        if self.done == self.count {
            return self.stream.finish().map(|()| None);
        }
        with_element!(self.element, self.endian, convert => Ok(Some(self.read(convert)?.into())))
    }

    fn held(&self) -> usize {
        let bytes = self.stream.remaining().unwrap_or(0);
        self.count.min(usize::try_from(bytes).unwrap_or(usize::MAX) / self.element.size())
    }
}

/// The elements that some bytes are.
pub(super) fn convert(bytes: &[u8], element: Element, endian: Endian) -> Values {
    fn all<T, const SIZE: usize>(bytes: &[u8], convert: impl Fn([u8; SIZE]) -> T) -> Vec<T> {
        bytes.as_chunks::<SIZE>().0.iter().map(|bytes| convert(*bytes)).collect()
    }
    with_element!(element, endian, element => all(bytes, element).into())
}

/// IEEE 754 half precision: 1 sign bit, 5 exponent bits (bias 15), 10 fraction bits.
pub(super) fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023));
    match exponent {
        0 => sign * fraction * 2f32.powi(-24),
        31 if fraction == 0.0 => sign * f32::INFINITY,
        31 => f32::NAN,
        _ => sign * (1.0 + fraction / 1024.0) * 2f32.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_a_long_and_a_short_name() {
        let short = ["bool", "u8", "i8", "u16", "i16", "u32", "i32", "u64", "i64", "f16", "f32"];
        for (element, short) in ElementType::ALL.into_iter().zip(short) {
            assert_eq!(ElementType::from_name(element.name()), Some(element));
            assert_eq!(ElementType::from_name(short), Some(element));
        }
        for name in ["b", "u", "uint", "u9", "", "i128"] {
            assert_eq!(ElementType::from_name(name), None, "{name}");
        }
    }

    #[test]
    fn half_precision_follows_the_standard() {
        let cases = [
            (0x0000, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0400, 6.103_515_6e-5),
            (0x0001, 5.960_464_5e-8),
            (0x3555, 0.333_251_95),
            (0x7c00, f32::INFINITY),
            (0xfc00, f32::NEG_INFINITY),
        ];
        for (bits, value) in cases {
            assert_eq!(half(bits), value, "{bits:#06x}");
        }
        assert!(half(0x7e00).is_nan() && half(0x8000).is_sign_negative());
    }
}
