//! The measures that the text of an energy names.

use crate::energy::{Entry, Parameter, catalogue};

/// What the catalogue calls an argument that is a parametrisation and nothing else.
const PARAMETER: &str = "[parameter]";

/// The measures of a text, and where their names end.
pub fn measures(text: &str) -> impl Iterator<Item = (usize, &'static Entry)> {
    let is_letter = |c: char| c.is_ascii_alphanumeric();
    let mut end = 0;
    text.split_inclusive(move |c| !is_letter(c)).filter_map(move |word| {
        let name = word.trim_end_matches(|c| !is_letter(c));
        let here = end + name.len();
        end += word.len();
        catalogue().iter().find(|entry| entry.name == name).map(|entry| (here, entry))
    })
}

impl Entry {
    /// Whether the measure takes a parametrisation and nothing else.
    pub fn takes_parameter(&self) -> bool {
        self.arguments == PARAMETER
    }
}

/// The text of an energy with a parametrisation for every measure that takes one and is written without; nothing
/// where no measure takes one.
///
/// ```
/// use shrouds::energy::{Parameter, with_parameter};
/// let text = with_parameter("bending+0.1*curvature", Parameter::Foley);
/// assert_eq!(text.as_deref(), Some("bending+0.1*curvature(foley)"));
/// ```
pub fn with_parameter(text: &str, parameter: Parameter) -> Option<String> {
    let (mut whole, mut done, mut is_taken) = (String::new(), 0, false);
    for (end, _) in measures(text).filter(|(_, entry)| entry.takes_parameter()) {
        is_taken = true;
        if !text[end..].trim_start().starts_with('(') {
            whole += &format!("{}({parameter})", &text[done..end]);
            done = end;
        }
    }
    is_taken.then(|| whole + &text[done..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_goes_where_none_is() {
        for (text, whole) in [
            ("curvature", Some("curvature(chord)")),
            ("2*linear + bending", Some("2*linear(chord) + bending")),
            ("curvature (uniform)+linear", Some("curvature (uniform)+linear(chord)")),
            ("bending+2*length", None),
        ] {
            assert_eq!(with_parameter(text, Parameter::Chord).as_deref(), whole);
        }
    }
}
