//! Numbers written as text, to the bytes they would have been.

use std::io::{self, BufRead, Read};

/// The longest number that is read.
const MAX_TOKEN: usize = 400;

/// Decimal numbers between white space or commas, each to the bytes that `encode` gives it.
pub(crate) struct Decimals<R, E> {
    inner: R,
    encode: E,
    token: Vec<u8>,
    /// Bytes of the last number that did not fit the buffer, last byte first.
    rest: Vec<u8>,
}

impl<R: BufRead, E: Fn(&str) -> Option<Vec<u8>>> Decimals<R, E> {
    pub(crate) fn new(inner: R, encode: E) -> Self {
        Self { inner, encode, token: Vec::new(), rest: Vec::new() }
    }

    /// Reads the next number into `rest`; `false` at the end.
    fn next_number(&mut self) -> io::Result<bool> {
        self.token.clear();
        loop {
            let bytes = self.inner.fill_buf()?;
            if bytes.is_empty() {
                break;
            }
            let gap = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
            let start = if self.token.is_empty() {
                bytes.iter().position(|byte| !gap(byte)).unwrap_or(bytes.len())
            } else {
                0
            };
            let end = bytes[start..].iter().position(gap).map(|length| start + length);
            self.token.extend(&bytes[start..end.unwrap_or(bytes.len())]);
            let used = end.unwrap_or(bytes.len());
            self.inner.consume(used);
            if (end.is_some() && !self.token.is_empty()) || self.token.len() > MAX_TOKEN {
                break;
            }
        }
        if self.token.is_empty() {
            return Ok(false);
        }
        let text = str::from_utf8(&self.token).ok();
        let Some(bytes) = text.and_then(&self.encode) else {
            let text = String::from_utf8_lossy(&self.token);
            let problem = format!("'{text:.40}' is no number of the type of the volume");
            return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
        };
        self.rest.extend(bytes.iter().rev());
        Ok(true)
    }
}

impl<R: BufRead, E: Fn(&str) -> Option<Vec<u8>>> Read for Decimals<R, E> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        for byte in out {
            if self.rest.is_empty() && !self.next_number()? {
                break;
            }
            let Some(next) = self.rest.pop() else { break };
            *byte = next;
            filled += 1;
        }
        Ok(filled)
    }
}

/// Pairs of hexadecimal digits, with white space anywhere, each to its byte.
pub(crate) struct Hexadecimals<R>(pub(crate) R);

impl<R: BufRead> Hexadecimals<R> {
    fn digit(&mut self) -> io::Result<Option<u8>> {
        loop {
            let Some(byte) = self.0.fill_buf()?.first().copied() else { return Ok(None) };
            self.0.consume(1);
            if byte.is_ascii_whitespace() {
                continue;
            }
            let digit = char::from(byte).to_digit(16).ok_or_else(|| {
                let problem = format!("'{}' is no hexadecimal digit", byte.escape_ascii());
                io::Error::new(io::ErrorKind::InvalidData, problem)
            })?;
            return Ok(Some(digit as u8));
        }
    }
}

impl<R: BufRead> Read for Hexadecimals<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        for byte in out {
            let (Some(high), Some(low)) = (self.digit()?, self.digit()?) else { break };
            *byte = high << 4 | low;
            filled += 1;
        }
        Ok(filled)
    }
}
