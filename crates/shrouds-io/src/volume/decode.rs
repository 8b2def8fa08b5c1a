//! From stored bytes to elements: the one decoder of all volume formats.

use shrouds::volume::{Filler, Voxel};

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::Values;

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

/// The elements of a volume file, all still to be read, and what its header says of them.
///
/// Memory grows with the bytes that arrive; the length of an uncompressed file is checked first, the
/// checksum of a compressed one last. Bytes after the last element are tolerated.
pub(super) struct Elements<'a> {
    pub(super) stream: Stream<'a>,
    pub(super) element: Element,
    pub(super) endian: Endian,
    pub(super) count: usize,
}

impl Elements<'_> {
    /// Reads all of them.
    pub(super) fn values(mut self) -> Result<Values, Error> {
        let values = with_element!(self.element, self.endian, convert => {
            let mut values = self.space()?;
            self.pieces(convert, 1, |piece| values.extend_from_slice(piece))?;
            Values::from(values)
        });
        self.stream.finish()?;
        Ok(values)
    }

    /// Reads all of them into the rows of a volume, after `slope · element + shift` if that changes
    /// anything.
    pub(super) fn fill(
        mut self,
        filler: &mut Filler,
        scaling: Option<(f64, f64)>,
    ) -> Result<(), Error> {
        let row = filler.row_length();
        with_element!(self.element, self.endian, convert => match scaling {
            None => self.pieces(convert, row, |piece| filler.push_rows(piece))?,
            Some((slope, shift)) => {
                let scaled = |bytes| convert(bytes).as_f64() * slope + shift;
                self.pieces(scaled, row, |piece| filler.push_rows(piece))?;
            }
        });
        self.stream.finish()
    }

    /// An empty list with space for the elements that a file of known length holds.
    fn space<T>(&self) -> Result<Vec<T>, Error> {
        let mut values = Vec::new();
        let held = |bytes| bytes >= self.count as u64 * self.element.size() as u64;
        if self.stream.remaining().is_some_and(held) {
            values.try_reserve_exact(self.count).map_err(|_| {
                let bytes = self.count * self.element.size();
                let what = format!("a volume of {bytes} bytes, more than memory can hold,");
                Error::unsupported(self.stream.path, what, "crop or downsample it first")
            })?;
        }
        Ok(values)
    }

    /// Hands out all elements in order, converted, whole rows of this length at a time.
    fn pieces<T, const SIZE: usize>(
        &mut self,
        convert: impl Fn([u8; SIZE]) -> T,
        row: usize,
        mut push: impl FnMut(&[T]),
    ) -> Result<(), Error> {
        let path = self.stream.path;
        let expected = self.count as u64 * SIZE as u64;
        let truncated = |found: u64| Error::Truncated { path: path.into(), expected, found };
        if let Some(found) = self.stream.remaining().filter(|found| *found < expected) {
            return Err(truncated(found));
        }
        let step = row * (CHUNK / SIZE / row).max(1);
        let mut buffer = vec![0; step.min(self.count) * SIZE];
        let mut piece = Vec::with_capacity(step.min(self.count));
        for done in (0..self.count).step_by(step) {
            let bytes = &mut buffer[..step.min(self.count - done) * SIZE];
            let found = self.stream.fill(bytes)?;
            if found < bytes.len() {
                return Err(truncated((done * SIZE + found) as u64));
            }
            piece.clear();
            piece.extend(bytes.as_chunks::<SIZE>().0.iter().map(|bytes| convert(*bytes)));
            push(&piece);
        }
        Ok(())
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
