//! From stored bytes to values: the one decoder of all volume formats.

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::Values;

/// Bytes decoded at a time, a multiple of every element size.
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

/// Reads `count` elements. Memory grows with the bytes that arrive; the length of an uncompressed
/// file is checked first, the checksum of a compressed one last. Bytes after the last element are
/// tolerated.
pub(super) fn decode(
    stream: &mut Stream,
    element: Element,
    endian: Endian,
    count: usize,
) -> Result<Values, Error> {
    macro_rules! read {
        ($variant:ident, $type:ty) => {
            Values::$variant(match endian {
                Endian::Little => collect(stream, count, <$type>::from_le_bytes)?,
                Endian::Big => collect(stream, count, <$type>::from_be_bytes)?,
            })
        };
    }
    let values = match element {
        Element::Bool => Values::Bool(collect(stream, count, |[byte]: [u8; 1]| byte != 0)?),
        Element::U8 => read!(U8, u8),
        Element::I8 => read!(I8, i8),
        Element::U16 => read!(U16, u16),
        Element::I16 => read!(I16, i16),
        Element::U32 => read!(U32, u32),
        Element::I32 => read!(I32, i32),
        Element::U64 => read!(U64, u64),
        Element::I64 => read!(I64, i64),
        Element::F16 => Values::F32(match endian {
            Endian::Little => collect(stream, count, |b| half(u16::from_le_bytes(b)))?,
            Endian::Big => collect(stream, count, |b| half(u16::from_be_bytes(b)))?,
        }),
        Element::F32 => read!(F32, f32),
        Element::F64 => read!(F64, f64),
    };
    stream.finish()?;
    Ok(values)
}

fn collect<T, const SIZE: usize>(
    stream: &mut Stream,
    count: usize,
    convert: impl Fn([u8; SIZE]) -> T,
) -> Result<Vec<T>, Error> {
    let path = stream.path;
    let expected = count as u64 * SIZE as u64;
    let truncated = |found: u64| Error::Truncated { path: path.into(), expected, found };
    let mut values = Vec::new();
    if let Some(found) = stream.remaining() {
        if found < expected {
            return Err(truncated(found));
        }
        values.try_reserve_exact(count).map_err(|_| {
            let what = format!("a volume of {expected} bytes, more than memory can hold,");
            Error::unsupported(path, what, "crop or downsample it first")
        })?;
    }
    let mut buffer = vec![0; CHUNK.min(count * SIZE)];
    while values.len() < count {
        let wanted = CHUNK.min((count - values.len()) * SIZE);
        let found = stream.fill(&mut buffer[..wanted])?;
        let (elements, rest) = buffer[..found].as_chunks::<SIZE>();
        values.extend(elements.iter().map(|bytes| convert(*bytes)));
        if found < wanted {
            return Err(truncated((values.len() * SIZE + rest.len()) as u64));
        }
    }
    Ok(values)
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
