//! The header of an NRRD file: lines of text up to a blank one, or to the end where the data is in
//! other files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::stream::Stream;
use crate::volume::file_names::{beside, numbered};

/// Longest line and most lines that are read: 3D Slicer keeps tables of segments in its headers.
const MAX_LINE: u64 = 1 << 20;
const MAX_LINES: usize = 1 << 17;

/// The lines of a header.
pub(super) struct Header {
    /// Fields of the format by name, in lower case and without spaces.
    fields: BTreeMap<String, String>,
    /// The user's own pairs of key and value.
    pub(super) pairs: BTreeMap<String, String>,
    /// The names of data files that stand at the end, one a line.
    list: Vec<String>,
    pub(super) warnings: Vec<String>,
}

impl Header {
    /// Reads the header; the stream stands behind it.
    ///
    /// # Errors
    /// [`Error::Content`] when the file is no NRRD file, [`Error::Header`] when a line is no field or
    /// the end is missing.
    pub(super) fn read(stream: &mut Stream) -> Result<Self, Error> {
        let path = stream.path;
        let magic = stream.line(MAX_LINE)?.unwrap_or_default();
        if !magic.starts_with("NRRD000") {
            let advice = "check the extension, or write it again as .nrrd";
            return Err(Error::Content { path: path.into(), expected: "an NRRD volume", advice });
        }
        let (fields, pairs) = (BTreeMap::new(), BTreeMap::new());
        let mut header = Self { fields, pairs, list: Vec::new(), warnings: Vec::new() };
        for _ in 0..MAX_LINES {
            match stream.last_line(MAX_LINE)? {
                None if header.is_detached() => return Ok(header),
                None => break,
                Some(line) if line.is_empty() => return Ok(header),
                Some(line) => header.take(path, line)?,
            }
        }
        Err(Error::header(path, "the blank line that ends it is missing"))
    }

    fn take(&mut self, path: &Path, line: String) -> Result<(), Error> {
        if line.starts_with('#') {
            return Ok(());
        }
        if self.get("data file").is_some_and(|value| value.starts_with("LIST")) {
            self.list.push(line);
            return Ok(());
        }
        let Some((name, value)) = line.split_once(':') else {
            return Err(Error::header(path, format!("the line '{line:.60}' has no field")));
        };
        if let Some(value) = value.strip_prefix('=') {
            self.pairs.insert(unescaped(name), unescaped(value));
            return Ok(());
        }
        let value = value.trim();
        let before = self.fields.insert(key(name), value.into());
        if before.is_some_and(|before| before != value) {
            self.warnings.push(format!(
                "The field '{}' stands in the header twice; the last one is used.",
                name.trim()
            ));
        }
        Ok(())
    }

    /// The value of a field.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.fields.get(&key(name)).map(String::as_str)
    }

    /// The value of a field that must be there.
    pub(super) fn need(&self, path: &Path, name: &str) -> Result<&str, Error> {
        self.get(name).ok_or_else(|| Error::header(path, format!("the field '{name}' is missing")))
    }

    /// The numbers of a field with one for each axis; what is written as none of a number is NaN.
    pub(super) fn numbers(&self, path: &Path, name: &str) -> Result<Option<Vec<f64>>, Error> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let number = |word: &str| match word.to_lowercase().as_str() {
            "nan" | "none" | "???" => Some(f64::NAN),
            word => word.parse().ok(),
        };
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
        let damaged = || Error::header(path, format!("the {name} '{text:.60}' are not numbers"));
        numbers.map(Some).ok_or_else(damaged)
    }

    fn is_detached(&self) -> bool {
        self.get("data file").is_some()
    }

    /// The files that hold the data, if it does not follow the header; `axes` is the number of axes.
    ///
    /// # Errors
    /// [`Error::Header`] when the field does not name them.
    pub(super) fn data_files(
        &self,
        path: &Path,
        sizes: &[usize],
    ) -> Result<Option<Vec<PathBuf>>, Error> {
        let Some(text) = self.get("data file") else { return Ok(None) };
        let damaged = || Error::header(path, format!("the data file is '{text:.80}'"));
        if let Some(rest) = text.strip_prefix("LIST") {
            check_parts(path, rest.trim(), sizes, self.list.len())?;
            return Ok(Some(self.list.iter().map(|name| beside(path, name.trim())).collect()));
        }
        // A pattern has a range behind it; a name may hold a % and spaces.
        let words: Vec<&str> = text.split_whitespace().collect();
        let range = words.get(1..4).and_then(|words| {
            let numbers: Option<Vec<i64>> = words.iter().map(|word| word.parse().ok()).collect();
            <[i64; 3]>::try_from(numbers?).ok()
        });
        match (range, words.len()) {
            (Some(range), 4 | 5) if words[0].contains('%') => {
                let files = numbered(path, words[0], range)?;
                check_parts(path, words.get(4).unwrap_or(&""), sizes, files.len())?;
                Ok(Some(files))
            }
            _ if text.is_empty() => Err(damaged()),
            _ => Ok(Some(vec![beside(path, text)])),
        }
    }
}

/// Checks the number of data files against the number of axes that each of them has.
fn check_parts(path: &Path, axes: &str, sizes: &[usize], files: usize) -> Result<(), Error> {
    let damaged = |problem| Err(Error::header(path, problem));
    let axes = match axes.parse() {
        _ if axes.is_empty() => sizes.len() - 1,
        Ok(axes) if axes >= 1 && axes <= sizes.len() => axes,
        _ => return damaged(format!("'{axes:.20}' is no number of axes of a data file")),
    };
    // Files with all axes are thick slices: any number of them, as long as they are equally thick.
    let expected = sizes[axes..].iter().try_fold(1usize, |product, n| product.checked_mul(*n));
    if axes == sizes.len() || expected == Some(files) {
        return Ok(());
    }
    damaged(format!("it names {files} data files for slices of {axes} axes of sizes {sizes:?}"))
}

/// The name of a field as it is stored: `data file` and `datafile` are one.
fn key(name: &str) -> String {
    name.to_lowercase().replace(char::is_whitespace, "")
}

/// A key or value with its line feeds and backslashes put back.
fn unescaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match (letter, letters.as_str().chars().next()) {
            ('\\', Some('n')) => plain.push('\n'),
            ('\\', Some('\\')) => plain.push('\\'),
            _ => {
                plain.push(letter);
                continue;
            }
        }
        letters.next();
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_stand_for_line_feeds_and_backslashes() {
        for (stored, plain) in
            [(r"a\nb", "a\nb"), (r"a\\nb", r"a\nb"), (r"\x\", r"\x\"), ("größe", "größe")]
        {
            assert_eq!(unescaped(stored), plain);
        }
    }
}
