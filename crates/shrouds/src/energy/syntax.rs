//! Energies as text: `bending+0.3*variation`.

use std::fmt;
use std::str::FromStr;

use crate::energy::{Energy, Entry, Part, catalogue};
use crate::error::Error;

/// Written as [`Energy`]'s [`FromStr`] reads it. Factors of single vertices are not shown, and a
/// measure that has no name of its own reads `custom`.
impl fmt::Display for Energy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, Part { measure, weight, .. }) in self.parts().iter().enumerate() {
            if n > 0 {
                f.write_str("+")?;
            }
            if *weight != 1.0 {
                write!(f, "{weight}*")?;
            }
            f.write_str(&measure.name())?;
        }
        Ok(())
    }
}

impl fmt::Debug for Energy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Energy({self})")
    }
}

/// Reads a sum of measures with weights, white space allowed: `term + term …`, where a term is
/// `name`, `weight*name` or either with `(argument, …)` after the name. The names are those of the
/// [`catalogue`].
///
/// ```
/// use shrouds::energy::Energy;
///
/// let energy: Energy = "bending + 0.3 * curvature(centripetal)".parse()?;
/// assert_eq!(energy.to_string(), "bending+0.3*curvature(centripetal)");
/// # Ok::<(), shrouds::Error>(())
/// ```
impl FromStr for Energy {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let refuse = |reason| Error::Energy { text: text.into(), reason, known: known() };
        sum(text).map_err(refuse)
    }
}

/// All names with their arguments.
fn known() -> String {
    let one = |entry: &Entry| match entry.arguments {
        "" => entry.name.to_owned(),
        arguments => format!("{}({arguments})", entry.name),
    };
    catalogue().iter().map(one).collect::<Vec<_>>().join(", ")
}

fn sum(text: &str) -> Result<Energy, String> {
    let (mut energy, mut rest) = term(text)?;
    while let Some(more) = rest.strip_prefix('+') {
        let (next, after) = term(more)?;
        energy = energy + next;
        rest = after;
    }
    if rest.is_empty() { Ok(energy) } else { Err(format!("{rest:?} was not expected")) }
}

/// The term at the start of a text, and what follows it without leading white space.
fn term(text: &str) -> Result<(Energy, &str), String> {
    let text = text.trim_start();
    let end = number_end(text);
    if end == 0 {
        return measure(text);
    }
    let (number, rest) = (&text[..end], text[end..].trim_start());
    let weight = not_negative(number)?;
    let rest = rest.strip_prefix('*').ok_or_else(|| {
        format!("after the weight {number} must come * and a measure, not {rest:?}")
    })?;
    let (energy, rest) = measure(rest.trim_start())?;
    Ok((weight * energy, rest))
}

/// Where the number at the start of a text ends; signs belong to it at its start and in an exponent.
fn number_end(text: &str) -> usize {
    let mut previous = 'e';
    let is_number = |c: char| {
        let may_follow = c.is_ascii_digit()
            || c == '.'
            || (matches!(c, 'e' | 'E') && (previous.is_ascii_digit() || previous == '.'))
            || (matches!(c, '+' | '-') && matches!(previous, 'e' | 'E'));
        previous = c;
        may_follow
    };
    let mut is_number = is_number;
    text.find(|c| !is_number(c)).unwrap_or(text.len())
}

/// A number from 0 up.
pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(format!("{text:?} is not a number from 0 up")),
    }
}

/// The measure at the start of a text, and what follows it without leading white space.
fn measure(text: &str) -> Result<(Energy, &str), String> {
    let end = text.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(text.len());
    let (name, rest) = (&text[..end], text[end..].trim_start());
    let entry = catalogue().iter().find(|entry| entry.name == name).ok_or_else(|| {
        if name.is_empty() {
            format!("a measure is missing before {text:?}")
        } else {
            format!("there is no measure named {name:?}")
        }
    })?;
    let of_measure = |reason| format!("{name}: {reason}");
    let Some(inside) = rest.strip_prefix('(') else {
        return Ok(((entry.build)(&[]).map_err(of_measure)?, rest));
    };
    let Some((inside, rest)) = inside.split_once(')') else {
        return Err(of_measure("the closing parenthesis is missing".into()));
    };
    let arguments: Vec<&str> = inside.split(',').map(str::trim).collect();
    Ok(((entry.build)(&arguments).map_err(of_measure)?, rest.trim_start()))
}
