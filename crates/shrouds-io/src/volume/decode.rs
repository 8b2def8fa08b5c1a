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

/// Type of a stored element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Element {
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

impl Element {
    /// Bytes of one element.
    pub(super) fn size(self) -> usize {
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
        Ok(self.buffer.as_chunks::<SIZE>().0.iter().map(|bytes| convert(*bytes)).collect())
    }
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

/// Every `step`-th of the elements, from element `first` on: one of several lists whose elements
/// take turns. Rows of the elements are rows of every list.
pub(super) struct OneOf<'a> {
    elements: Elements<'a>,
    step: usize,
    first: usize,
}

impl<'a> OneOf<'a> {
    pub(super) fn new(elements: Elements<'a>, step: usize, first: usize) -> Self {
        Self { elements, step, first }
    }
}

impl Slabs for OneOf<'_> {
    fn next(&mut self) -> Result<Option<Values>, Error> {
        let all = self.elements.next()?;
        Ok(all.map(|values| values.every(self.step, self.first)))
    }

    fn held(&self) -> usize {
        self.elements.held() / self.step
    }
}

/// IEEE 754 half precision: 1 sign bit, 5 exponent bits (bias 15), 10 fraction bits.
fn half(bits: u16) -> f32 {
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
