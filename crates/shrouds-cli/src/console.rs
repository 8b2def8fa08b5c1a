//! What people read: results on standard output, messages on standard error.

use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use crate::failure::Failure;

/// Writes messages, unless it is to be quiet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Console {
    pub(crate) quiet: bool,
}

impl Console {
    /// A message; standard error may be closed, which is no reason to fail.
    pub(crate) fn message(self, text: &str) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    pub(crate) fn warn(self, text: &str) {
        self.message(&format!("warning: {text}"));
    }

    /// A result in words.
    pub(crate) fn result(self, text: &str) -> Result<(), Failure> {
        if self.quiet { Ok(()) } else { print(text) }
    }
}

/// The line that explains a failure; printed however quiet.
pub(crate) fn error(failure: &Failure) {
    let _ = writeln!(io::stderr(), "error: {}", failure.message());
}

/// A result as JSON, the only thing on standard output.
pub(crate) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    print(&json(value)?)
}

/// Text on standard output. A reader that has seen enough is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => Err(Failure::Undone(format!(
            "standard output: cannot write it ({cause}); check where it leads"
        ))),
        _ => Ok(()),
    }
}

pub(crate) fn json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value)
        .map_err(|cause| Failure::Undone(format!("the report cannot be written: {cause}")))
}

/// A whole number with commas between thousands.
pub(crate) fn grouped(number: impl Into<u128>) -> String {
    let digits = number.into().to_string();
    let mut text = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// So many of something.
pub(crate) fn plural(count: usize, noun: &str) -> String {
    format!("{} {noun}{}", grouped(count as u64), if count == 1 { "" } else { "s" })
}

/// A number with about six significant digits and no exponent where it can be helped.
pub(crate) fn number(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e9).contains(&x.abs()) {
        return format!("{x:.5e}");
    }
    let whole = x.abs().max(1.0).log10().floor() as usize;
    let text = format!("{x:.*}", 5usize.saturating_sub(whole));
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Lines of cells in columns as wide as they need, the first `names` of them to the left and the numbers
/// behind to the right.
pub(crate) fn aligned(lines: &[Vec<String>], names: usize) -> Vec<String> {
    let count = lines.first().map_or(0, Vec::len);
    let width = |k: usize| lines.iter().map(|line| line[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count).map(width).collect();
    let line = |cells: &Vec<String>| {
        let cell = |(k, (text, width)): (usize, (&String, &usize))| match k < names {
            true => format!("{text:<width$}"),
            false => format!("{text:>width$}"),
        };
        let cells: Vec<String> = cells.iter().zip(&widths).enumerate().map(cell).collect();
        cells.join("  ").trim_end().to_owned()
    };
    lines.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(["0", "999", "1,000", "12,345,678"], [0u32, 999, 1000, 12_345_678].map(grouped));
        for (x, text) in [
            (0.0, "0"),
            (2.5, "2.5"),
            (-1234.5678, "-1234.57"),
            (100000.0, "100000"),
            (1234567.8, "1234568"),
            (0.00123, "0.00123"),
            (1e-9, "1.00000e-9"),
        ] {
            assert_eq!(number(x), text);
        }
    }
}
