//! Bytes of an input file: plain or gzip, with errors that name it and a report of the progress.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::error::Error;

/// What is called while a file is read, on the thread that reads it: bytes read so far, bytes of
/// the file (0 if its length is not known).
pub type Progress<'a> = &'a dyn Fn(u64, u64);

/// Bytes between two reports of the progress.
const REPORT_EVERY: u64 = 1 << 22;

/// An open file, read from front to back.
pub(crate) struct Stream<'a> {
    pub(crate) path: &'a Path,
    reader: Box<dyn BufRead + 'a>,
    gzip: bool,
    remaining: Option<u64>,
}

impl<'a> Stream<'a> {
    pub(crate) fn open(path: &'a Path, progress: Option<Progress<'a>>) -> Result<Self, Error> {
        let file = File::open(path).map_err(|cause| Error::open(path, cause))?;
        let data = file.metadata().map_err(|cause| Error::open(path, cause))?;
        if data.is_dir() {
            return Err(Error::unsupported(path, "a folder", "name one of the files in it"));
        }
        let reader = Counted { file, length: data.len(), read: 0, reported: 0, progress };
        // Pipes have no length to check.
        let remaining = data.is_file().then_some(data.len());
        Ok(Self { path, reader: Box::new(BufReader::new(reader)), gzip: false, remaining })
    }

    /// From here on the bytes are gzip.
    pub(crate) fn unpacked(self) -> Self {
        let decoder = BufReader::new(MultiGzDecoder::new(self.reader));
        Self { reader: Box::new(decoder), gzip: true, remaining: None, ..self }
    }

    /// Bytes left in an uncompressed file, if its length is known.
    pub(crate) fn remaining(&self) -> Option<u64> {
        self.remaining
    }

    /// Reads until the buffer is full or the file ends; returns the number of bytes read.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, Error> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.reader.read(&mut buffer[filled..]) {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(self.failed(error)),
            }
        }
        self.remaining = self.remaining.map(|left| left.saturating_sub(filled as u64));
        Ok(filled)
    }

    /// The first bytes of the stream, which stay in it; all there are, up to the buffer's size.
    pub(crate) fn peek(&mut self) -> Result<&[u8], Error> {
        // Two calls, because the borrow of a returned slice would outlive the error branch.
        if let Err(error) = self.reader.fill_buf() {
            return Err(self.failed(error));
        }
        Ok(self.reader.fill_buf().unwrap_or_default())
    }

    /// The next line without its end, at most `limit` bytes of it; `None` at the end of the file.
    pub(crate) fn line(&mut self, limit: u64) -> Result<Option<String>, Error> {
        let mut line = Vec::new();
        let read = self.reader.by_ref().take(limit).read_until(b'\n', &mut line);
        let count = read.map_err(|error| self.failed(error))?;
        self.remaining = self.remaining.map(|left| left.saturating_sub(count as u64));
        if line.pop_if(|byte| *byte == b'\n').is_none() {
            return Ok(None);
        }
        line.pop_if(|byte| *byte == b'\r');
        Ok(Some(String::from_utf8_lossy(&line).into_owned()))
    }

    /// Skips `count` bytes, or what there is.
    pub(crate) fn skip(&mut self, count: u64) -> Result<(), Error> {
        let skipped = io::copy(&mut self.reader.by_ref().take(count), &mut io::sink());
        let skipped = skipped.map_err(|error| self.failed(error))?;
        self.remaining = self.remaining.map(|left| left.saturating_sub(skipped));
        Ok(())
    }

    /// Reads compressed data to its end, where its checksum is.
    pub(crate) fn finish(&mut self) -> Result<(), Error> {
        if self.gzip { self.skip(u64::MAX) } else { Ok(()) }
    }

    fn failed(&self, cause: io::Error) -> Error {
        let path = self.path.into();
        if self.gzip {
            return Error::Gzip { path, cause };
        }
        Error::Io { path, doing: "read it", cause, advice: "check the disk and try again" }
    }
}

/// A file that reports how far it has been read.
struct Counted<'a> {
    file: File,
    length: u64,
    read: u64,
    reported: u64,
    progress: Option<Progress<'a>>,
}

impl Read for Counted<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.read += count as u64;
        if let Some(progress) = self.progress
            && (count == 0 || self.read - self.reported >= REPORT_EVERY)
        {
            self.reported = self.read;
            progress(self.read, self.length);
        }
        Ok(count)
    }
}
