//! Types of elements by their names, and the value of those that are not stored.

use serde_json::Value;

use crate::volume::decode::{Element, half};

/// The type that version 3 calls by this name.
pub(super) fn data_type(name: &str) -> Option<Element> {
    Some(match name {
        "bool" => Element::Bool,
        "uint8" => Element::U8,
        "int8" => Element::I8,
        "uint16" => Element::U16,
        "int16" => Element::I16,
        "uint32" => Element::U32,
        "int32" => Element::I32,
        "uint64" => Element::U64,
        "int64" => Element::I64,
        "float16" => Element::F16,
        "float32" => Element::F32,
        "float64" => Element::F64,
        _ => return None,
    })
}

/// The type of a name such as `<u2`: byte order, kind and number of bytes.
pub(super) fn numpy_type(name: &str) -> Option<Element> {
    let name = name.trim_start_matches(['<', '>', '|', '=']);
    let (kind, size) = name.split_at_checked(1)?;
    let bits = size.parse::<usize>().ok()?.checked_mul(8)?;
    match kind {
        "b" if bits == 8 => Some(Element::Bool),
        "u" => data_type(&format!("uint{bits}")),
        "i" => data_type(&format!("int{bits}")),
        "f" => data_type(&format!("float{bits}")),
        _ => None,
    }
}

/// The fill value as an element, little endian.
pub(super) fn fill_bytes(element: Element, value: &Value) -> Option<Vec<u8>> {
    if value.is_null() {
        return Some(vec![0; element.size()]);
    }
    if let Some(digits) = value.as_str().and_then(|text| text.strip_prefix("0x")) {
        let bits = u64::from_str_radix(digits, 16).ok()?.to_le_bytes();
        return Some(bits[..element.size()].into());
    }
    let float = match value.as_str() {
        Some("NaN") => Some(f64::NAN),
        Some("Infinity") => Some(f64::INFINITY),
        Some("-Infinity") => Some(f64::NEG_INFINITY),
        _ => value.as_f64(),
    };
    let whole = value.as_i64().map(i128::from).or_else(|| value.as_u64().map(i128::from));
    let whole = whole.or_else(|| value.as_bool().map(i128::from)).or_else(|| {
        float.filter(|x| x.fract() == 0.0 && x.abs() < 2f64.powi(53)).map(|x| x as i128)
    });
    macro_rules! integer {
        ($type:ty) => {
            <$type>::try_from(whole?).ok()?.to_le_bytes().into()
        };
    }
    Some(match element {
        Element::Bool => vec![u8::from(whole? != 0)],
        Element::U8 => integer!(u8),
        Element::I8 => integer!(i8),
        Element::U16 => integer!(u16),
        Element::I16 => integer!(i16),
        Element::U32 => integer!(u32),
        Element::I32 => integer!(i32),
        Element::U64 => integer!(u64),
        Element::I64 => integer!(i64),
        Element::F16 => {
            let same = |bits: &u16| {
                let value = f64::from(half(*bits));
                Some(value) == float || value.is_nan() && float.is_some_and(f64::is_nan)
            };
            (0..=u16::MAX).find(same)?.to_le_bytes().into()
        }
        Element::F32 => (float? as f32).to_le_bytes().into(),
        Element::F64 => float?.to_le_bytes().into(),
    })
}
