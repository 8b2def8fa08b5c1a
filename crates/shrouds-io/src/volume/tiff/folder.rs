//! A folder of slices, one file each, in the order of the numbers in their names.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// A part of a name: digits, or anything else.
#[derive(Debug, PartialEq, Eq)]
enum Part<'n> {
    Number(&'n str),
    Text(&'n str),
}

/// The slices of a folder in their order, and what is doubtful about it.
pub(in crate::volume) fn slices(path: &Path) -> Result<(Vec<PathBuf>, Vec<String>), Error> {
    let failed = |cause| Error::open(path, cause);
    let mut names = Vec::new();
    let mut others = 0usize;
    for entry in path.read_dir().map_err(failed)? {
        let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
        match name {
            name if name.starts_with('.') => {}
            name if is_slice(&name) => names.push(name),
            _ => others += 1,
        }
    }
    names.sort_by(|a, b| natural(a, b));
    let mut warnings = gaps(&names);
    if others > 0 {
        warnings.push(format!("The folder holds {others} other files, which were left alone."));
    }
    Ok((names.into_iter().map(|name| path.join(name)).collect(), warnings))
}

/// Whether a folder holds slices.
pub(in crate::volume) fn holds_slices(path: &Path) -> bool {
    let entries = path.read_dir().into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name()).any(|name| is_slice(&name.to_string_lossy()))
}

fn is_slice(name: &str) -> bool {
    let name = name.to_lowercase();
    !name.starts_with('.') && (name.ends_with(".tif") || name.ends_with(".tiff"))
}

fn parts(name: &str) -> impl Iterator<Item = Part<'_>> {
    let mut rest = name;
    std::iter::from_fn(move || {
        let digit = rest.chars().next()?.is_ascii_digit();
        let end = rest.find(|c: char| c.is_ascii_digit() != digit).unwrap_or(rest.len());
        let (part, after) = rest.split_at(end);
        rest = after;
        Some(if digit { Part::Number(part) } else { Part::Text(part) })
    })
}

/// Numbers in names compare as numbers, however long, and what is equal then as text.
fn natural(a: &str, b: &str) -> Ordering {
    let value = |digits: &str| {
        let digits = digits.trim_start_matches('0').to_string();
        (digits.len(), digits)
    };
    let compare = |(a, b): (Part, Part)| match (a, b) {
        (Part::Number(a), Part::Number(b)) => value(a).cmp(&value(b)),
        (Part::Text(a), Part::Text(b)) => a.cmp(b),
        (Part::Number(_), Part::Text(_)) => Ordering::Less,
        (Part::Text(_), Part::Number(_)) => Ordering::Greater,
    };
    let by_parts = parts(a).zip(parts(b)).map(compare).find(|order| order.is_ne());
    by_parts.unwrap_or_else(|| parts(a).count().cmp(&parts(b).count())).then_with(|| a.cmp(b))
}

/// A sentence about the names between which numbers are missing.
fn gaps(names: &[String]) -> Vec<String> {
    let gap = |pair: &&[String]| step(&pair[0], &pair[1]).is_some_and(|step| step > 1);
    let mut found = names.windows(2).filter(gap);
    let Some(first) = found.next() else { return Vec::new() };
    let more = match found.count() {
        0 => String::new(),
        more => format!(", and at {more} more places"),
    };
    let text = format!(
        "Between {} and {} numbers are missing{more}: the slices were put next to each other.",
        first[0], first[1]
    );
    vec![text]
}

/// By how much the one number grows in which two names without extensions differ.
fn step(a: &str, b: &str) -> Option<u64> {
    let [a, b] = [a, b].map(|name| name.rsplit_once('.').map_or(name, |(stem, _)| stem));
    let (a, b): (Vec<_>, Vec<_>) = (parts(a).collect(), parts(b).collect());
    let mut different = a.iter().zip(&b).filter(|(a, b)| a != b);
    match (different.next()?, different.next()) {
        ((Part::Number(a), Part::Number(b)), None) => {
            b.parse::<u64>().ok()?.checked_sub(a.parse().ok()?)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_compare_as_numbers() {
        let mut names =
            ["s10.tif", "s9.tif", "s2b.tif", "s02.tif", "s2.tif", "a1_s100.tif", "7.tif"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(
            names,
            ["7.tif", "a1_s100.tif", "s02.tif", "s2.tif", "s2b.tif", "s9.tif", "s10.tif"]
        );
        let long = ["1", "99999999999999999999999999", "100000000000000000000000000"];
        assert!(long.is_sorted_by(|a, b| natural(a, b).is_lt()));
    }

    #[test]
    fn missing_numbers_are_said() {
        let names = |list: &[&str]| list.iter().map(|name| name.to_string()).collect::<Vec<_>>();
        assert!(gaps(&names(&["s8.tif", "s9.tif", "s10.tif"])).is_empty());
        assert!(gaps(&names(&["a.tif", "b.tif"])).is_empty());
        let text = &gaps(&names(&["s1.tif", "s3.tif", "s4.tif", "s9.tif"]))[0];
        assert!(text.contains("s1.tif and s3.tif") && text.contains("1 more"), "{text}");
    }
}
