//! Values that need more than a number to be read.

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use shrouds::Choice;
use shrouds::energy::Energy;
use shrouds_io::ElementType;

use crate::args::{Field, PlaneAxis};

/// Reads a choice of the library by its name.
pub(crate) fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let values = T::ALL.iter().map(|named| PossibleValue::new(named.name).help(named.summary));
    PossibleValuesParser::new(values).try_map(|name| T::by_name(&name))
}

/// What a surface is coloured with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Paint {
    Plain([u8; 3]),
    Field(Field),
}

/// Planes at the multiples of a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Every {
    pub(crate) axis: PlaneAxis,
    pub(crate) distance: f64,
}

/// An energy that can be read.
pub(crate) fn energy(text: &str) -> Result<String, String> {
    text.parse::<Energy>().map(|_| text.into()).map_err(|error| error.to_string())
}

/// Three positive lengths.
pub(crate) fn spacing(text: &str) -> Result<[f64; 3], String> {
    let advice = "give three positive numbers along x, y, z, such as 1,1,2.5";
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| number(part.trim())).collect();
    let numbers: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.filter(|numbers| numbers.iter().all(|x| *x > 0.0)).ok_or_else(|| advice.into())
}

/// Three positive numbers of voxels.
pub(crate) fn dims(text: &str) -> Result<[usize; 3], String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let numbers: Option<[usize; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
    let advice = "give three whole numbers above 0 along x, y, z, such as 512,512,200";
    numbers.filter(|numbers| numbers.iter().all(|n| *n > 0)).ok_or_else(|| advice.into())
}

/// A type of values.
pub(crate) fn element(text: &str) -> Result<ElementType, String> {
    ElementType::from_name(text).ok_or_else(|| {
        let names: Vec<&str> = ElementType::ALL.iter().map(|element| element.name()).collect();
        format!("give one of {}", names.join(", "))
    })
}

/// One positive length for all axes, or three.
pub(crate) fn lengths(text: &str) -> Result<[f64; 3], String> {
    match positive(text) {
        Ok(length) => Ok([length; 3]),
        Err(_) => spacing(text)
            .map_err(|_| "give a positive number, or three along x, y, z such as 1,1,2.5".into()),
    }
}

/// A number that is no infinity.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    number(text).ok_or_else(|| "give a number".into())
}

/// Bits for the place of a vertex.
pub(crate) fn bits(text: &str) -> Result<u8, String> {
    let bits = text.parse().ok().filter(|bits| [0, 1, 2, 4, 8].contains(bits));
    bits.ok_or_else(|| "give 0, 1, 2, 4 or 8".into())
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    number(text).filter(|x| *x > 0.0).ok_or_else(|| "give a number above 0".into())
}

/// A number above 0 and below 1.
pub(crate) fn fraction(text: &str) -> Result<f64, String> {
    let inside = number(text).filter(|x| *x > 0.0 && *x < 1.0);
    inside.ok_or_else(|| "give a number above 0 and below 1".into())
}

/// The turning angle of a crease.
pub(crate) fn crease(text: &str) -> Result<f64, String> {
    let inside = number(text).filter(|x| (0.6..=57.0).contains(x));
    inside.ok_or_else(|| "give degrees between 0.6 and 57".into())
}

/// An angle above the horizon.
pub(crate) fn elevation(text: &str) -> Result<f64, String> {
    let inside = number(text).filter(|x| x.abs() <= 90.0);
    inside.ok_or_else(|| "give degrees between -90 and 90".into())
}

/// A field of view.
pub(crate) fn field_of_view(text: &str) -> Result<f64, String> {
    let inside = number(text).filter(|x| (1.0..=120.0).contains(x));
    inside.ok_or_else(|| "give degrees between 1 and 120".into())
}

/// Red, green and blue as six hexadecimal digits.
pub(crate) fn colour(text: &str) -> Result<[u8; 3], String> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let whole = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let value = whole.then(|| u32::from_str_radix(digits, 16).ok()).flatten();
    let [_, rgb @ ..] = value.ok_or("give six hexadecimal digits, such as DEB880")?.to_be_bytes();
    Ok(rgb)
}

/// A colour, or the name of numbers.
pub(crate) fn paint(text: &str) -> Result<Paint, String> {
    let field = Field::from_str(text, false).map(Paint::Field);
    field.or_else(|_| colour(text).map(Paint::Plain)).map_err(|advice| {
        let names: Vec<String> = Field::value_variants()
            .iter()
            .filter_map(|field| Some(field.to_possible_value()?.get_name().to_owned()))
            .collect();
        format!("{advice}, or one of {}", names.join(", "))
    })
}

/// Two numbers, the smaller first.
pub(crate) fn range(text: &str) -> Result<[f64; 2], String> {
    let ends = text.split_once(',');
    let ends = ends.and_then(|(low, high)| Some([number(low.trim())?, number(high.trim())?]));
    ends.filter(|[low, high]| low < high)
        .ok_or_else(|| "give two numbers, the smaller first, such as -0.1,0.1".into())
}

/// An axis and a distance of planes across it.
pub(crate) fn every(text: &str) -> Result<Every, String> {
    let advice = "give an axis and a distance above 0, such as z:10";
    let (axis, distance) = text.split_once(':').ok_or(advice)?;
    let axis = PlaneAxis::from_str(axis, false).map_err(|_| advice)?;
    Ok(Every { axis, distance: positive(distance).map_err(|_| advice)? })
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_or_refused() {
        assert_eq!(spacing("1, 2,.5"), Ok([1.0, 2.0, 0.5]));
        assert_eq!((lengths("2"), lengths("1,2,3")), (Ok([2.0; 3]), Ok([1.0, 2.0, 3.0])));
        assert!(["", "0", "1,2", "x"].iter().all(|s| lengths(s).is_err()));
        assert_eq!(dims("3, 4,5"), Ok([3, 4, 5]));
        assert!(["3,4", "3,4,0", "3,4,x"].iter().all(|s| dims(s).is_err()));
        assert!(element("uint16").is_ok() && element("word").is_err());
        assert_eq!(colour("#ff8000"), Ok([255, 128, 0]));
        assert!(["1,2", "1,2,0", "1,2,-3", "1,2,inf", "a"].iter().all(|s| spacing(s).is_err()));
        assert!(["ff80", "+f8000", "gg0000"].iter().all(|s| colour(s).is_err()));
        assert_eq!(paint("00ff00"), Ok(Paint::Plain([0, 255, 0])));
        assert_eq!(paint("mean-curvature"), Ok(Paint::Field(Field::MeanCurvature)));
        assert!(paint("red").unwrap_err().contains("minimum-curvature, delta"));
        assert_eq!(range("-0.1, 2"), Ok([-0.1, 2.0]));
        assert!(["1", "2,1", "1,1", "a,b", "0,inf"].iter().all(|s| range(s).is_err()));
        assert_eq!(every("k:2.5"), Ok(Every { axis: PlaneAxis::K, distance: 2.5 }));
        assert!(["z", "z:", "z:0", "w:1", "z:-1"].iter().all(|s| every(s).is_err()));
        assert!(["0", "1", "nan"].iter().all(|s| fraction(s).is_err()));
        assert!(bits("2") == Ok(2) && ["3", "-1", "16"].iter().all(|s| bits(s).is_err()));
        assert!(finite("nan").is_err() && positive("0").is_err() && elevation("91").is_err());
    }
}
