//! Energies as they are typed: what there are, and what the text of one names.

use shrouds::energy::{Energy, Entry, Parameter, catalogue, measures, with_parameter};

use crate::failure::Failure;

/// The energy of a text, its measures without a parametrisation having this one; none without a text.
pub(crate) fn read(text: Option<&str>, parameter: Option<&str>) -> Result<Option<Energy>, Failure> {
    let Some(parameter) = parameter else { return Ok(text.map(str::parse).transpose()?) };
    let known = Parameter::ALL.into_iter().find(|known| known.name() == parameter);
    match known.zip(text).and_then(|(parameter, text)| with_parameter(text, parameter)) {
        Some(completed) => Ok(Some(completed.parse()?)),
        None => {
            let names = catalogue().iter().filter(|entry| entry.takes_parameter());
            let names: Vec<&str> = names.map(|entry| entry.name).collect();
            Err(Failure::Call(format!(
                "--parameter cannot go into --energy {}: leave it out, or choose an energy with {}",
                text.unwrap_or("bending"),
                names.join(" or ")
            )))
        }
    }
}

/// The names of the measures of a text that may destroy thin parts, if there are some.
pub(crate) fn destructive(text: &str) -> Option<String> {
    let mut names: Vec<&str> = measures(text)
        .filter(|(_, entry)| !entry.keeps_thin_parts)
        .map(|(_, entry)| entry.name)
        .collect();
    names.dedup();
    (!names.is_empty()).then(|| names.join(" and "))
}

/// The energies that a comparison is of unless told otherwise, but for that of the preset: those that
/// keep thin parts, and the two of the paper with every parametrisation.
pub(crate) fn usual() -> Vec<String> {
    let safe = catalogue().iter().filter(|entry| entry.keeps_thin_parts).map(|entry| entry.name);
    let alone = |name: &&str| name.parse::<Energy>().is_ok();
    let paper = ["curvature", "linear"].into_iter().flat_map(|name| {
        Parameter::ALL.into_iter().map(move |parameter| format!("{name}({parameter})"))
    });
    let mut all: Vec<String> = safe.filter(alone).map(str::to_owned).collect();
    all.extend(paper);
    all
}

/// All measures with what they are, a line each.
pub(crate) fn list() -> String {
    let name = |entry: &Entry| match entry.arguments {
        "" => entry.name.to_owned(),
        arguments => format!("{}({arguments})", entry.name),
    };
    let width = catalogue().iter().map(|entry| name(entry).len()).max().unwrap_or(0);
    let line = |entry: &Entry| {
        let mark = if entry.keeps_thin_parts { ' ' } else { '*' };
        let indent = " ".repeat(width + 5);
        let summary = wrapped(entry.summary, 98 - indent.len()).join(&format!("\n{indent}"));
        format!("  {:<width$} {mark} {summary}", name(entry))
    };
    let lines: Vec<String> = catalogue().iter().map(line).collect();
    format!(
        "Energies are sums of these measures with weights, such as bending+0.3*variation:\n{}\n\
         * may destroy parts one voxel thin. Parameters: {}.",
        lines.join("\n"),
        Parameter::ALL.map(Parameter::name).join(", ")
    )
}

/// The words in lines of at most so many letters, unless a word has more.
fn wrapped(text: &str, letters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < letters => {
                *line += " ";
                *line += word;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_goes_where_none_is() {
        let energy = read(Some("linear+curvature"), Some("uniform")).unwrap().unwrap();
        assert_eq!(energy.to_string(), "linear(uniform)+curvature(uniform)");
        assert!(read(None, None).unwrap().is_none());
        for text in [None, Some("bending"), Some("bending+2*length")] {
            let failure = read(text, Some("chord")).unwrap_err();
            assert!(failure.message().contains("--parameter cannot go"), "{failure:?}");
        }
    }

    #[test]
    fn measures_that_may_destroy_are_named() {
        assert_eq!(destructive("2*bending+0.5*bending"), None);
        assert_eq!(destructive("bending+0.5*linear(chord)").as_deref(), Some("linear"));
        assert_eq!(destructive("linear+curvature").as_deref(), Some("linear and curvature"));
    }

    #[test]
    fn the_usual_energies_can_be_read() {
        let all = usual();
        assert!(all.iter().all(|text| text.parse::<Energy>().is_ok()), "{all:?}");
        assert!(
            ["bending", "variation", "linear(uniform)"]
                .map(str::to_owned)
                .iter()
                .all(|e| all.contains(e))
        );
    }
}
