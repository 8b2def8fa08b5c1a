//! Names of the files that hold the data of a header.

use std::path::{Path, PathBuf};

use crate::error::Error;

/// Files that share the data of one header, at most.
pub(super) const MAX_FILES: usize = 1 << 16;

/// Where the file that a header names is: beside the header, unless the name says otherwise.
pub(super) fn beside(header: &Path, name: &str) -> PathBuf {
    header.parent().unwrap_or(Path::new("")).join(name)
}

/// The names that a pattern such as `slice%03d.raw` makes of the numbers from `first` to `last`.
///
/// # Errors
/// [`Error::Header`] when the step does not lead from one to the other or the pattern has no place
/// for one number.
pub(super) fn numbered(
    header: &Path,
    pattern: &str,
    [first, last, step]: [i64; 3],
) -> Result<Vec<PathBuf>, Error> {
    let damaged = |problem: String| Error::header(header, problem);
    let steps = i128::from(last) - i128::from(first);
    let count = match i128::from(step) {
        0 => None,
        step => usize::try_from(steps / step).ok().filter(|n| *n < MAX_FILES),
    };
    let count = count.filter(|_| (steps < 0) == (step < 0) || steps == 0).ok_or_else(|| {
        let range = format!("from {first} to {last} by {step}");
        damaged(format!(
            "the data files are numbered {range}: that is none, or more than {MAX_FILES}"
        ))
    })?;
    let names = (0..=count as i128).map(|n| {
        let number = i128::from(first) + n * i128::from(step);
        let name = with_number(pattern, number).ok_or_else(|| {
            damaged(format!(
                "the data file '{pattern:.80}' needs one place for a number, such as %03d"
            ))
        })?;
        Ok(beside(header, &name))
    });
    names.collect()
}

/// `pattern` with its one `%d`, `%i` or `%u`, which may have a width, replaced by the number.
fn with_number(pattern: &str, number: i128) -> Option<String> {
    let (mut text, mut rest, mut places) = (String::new(), pattern, 0);
    while let Some((before, after)) = rest.split_once('%') {
        text.push_str(before);
        if let Some(after) = after.strip_prefix('%') {
            text.push('%');
            rest = after;
            continue;
        }
        let end = after.find(|c: char| !c.is_ascii_digit())?;
        let (width, after) = after.split_at(end);
        rest = after.strip_prefix(['d', 'i', 'u'])?;
        let columns = if width.is_empty() { 0 } else { width.parse().ok().filter(|n| *n < 100)? };
        text.push_str(&match width.starts_with('0') {
            true => format!("{number:0columns$}"),
            false => format!("{number:columns$}"),
        });
        places += 1;
    }
    text.push_str(rest);
    (places == 1).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_those_of_printf() {
        for (pattern, number, expected) in [
            ("a%d.raw", 7, "a7.raw"),
            ("%03d", 7, "007"),
            ("%3i", 7, "  7"),
            ("%04d", -7, "-007"),
            ("100%%-%u", 12, "100%-12"),
        ] {
            assert_eq!(with_number(pattern, number).unwrap(), expected);
        }
        for pattern in ["a.raw", "%d%d", "%s", "%", "%5", "%100d", "%%d"] {
            assert_eq!(with_number(pattern, 1), None, "{pattern}");
        }
    }

    #[test]
    fn numbers_go_either_way_and_never_on_for_ever() {
        let header = Path::new("folder/a.nhdr");
        let names = |range| {
            numbered(header, "%d", range).map(|names| {
                names.iter().map(|name| name.display().to_string()).collect::<Vec<_>>().join(" ")
            })
        };
        assert_eq!(names([1, 7, 3]).unwrap(), "folder/1 folder/4 folder/7");
        assert_eq!(names([2, 1, -1]).unwrap(), "folder/2 folder/1");
        assert_eq!(names([5, 5, 1]).unwrap(), "folder/5");
        for range in [[1, 2, 0], [1, 2, -1], [2, 1, 1], [0, i64::MAX, 1], [i64::MIN, i64::MAX, 1]] {
            assert!(matches!(names(range), Err(Error::Header { .. })), "{range:?}");
        }
    }
}
