//! Bytes of an input file: plain, packed or text, with errors that name it and a report of the progress.

use std::fs::{File, Metadata};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::bufread::{DeflateDecoder, MultiGzDecoder, ZlibDecoder};

use crate::error::Error;
use crate::pick::{Pick, Picked};
use crate::text::{Decimals, Hexadecimals};

/// What is called while a file is read, on the thread that reads it: bytes read so far, bytes of
/// the file (0 if its length is not known).
pub type Progress<'a> = &'a dyn Fn(u64, u64);

/// Bytes between two reports of the progress.
const REPORT_EVERY: u64 = 1 << 22;
/// Bytes that one deflated byte can become at most: those of a block of 258 in two bits.
pub(crate) const EXPANSION: u64 = 1032;
/// Compressed data with more bytes than these after the last element is damaged, or a trap.
const MOST_AFTER: u64 = 1 << 26;

/// An open file, read from front to back.
pub(crate) struct Stream<'a> {
    pub(crate) path: &'a Path,
    reader: Box<dyn BufRead + 'a>,
    /// How the bytes are packed, if they are.
    method: Option<&'static str>,
    remaining: Option<u64>,
    /// Bytes that the stream can still give at most, if that is known.
    most: Option<u64>,
    /// Whether the last line that was read had an end.
    ended: bool,
}

impl<'a> Stream<'a> {
    pub(crate) fn open(path: &'a Path, progress: Option<Progress<'a>>) -> Result<Self, Error> {
        Self::open_part(path, path, progress, None)
    }

    /// Opens `file`, which holds a part of the volume at `path`: errors name the volume. The report
    /// of the progress counts `span`: the bytes of the parts before it, and of all.
    pub(crate) fn open_part(
        path: &'a Path,
        file: &Path,
        progress: Option<Progress<'a>>,
        span: Option<(u64, u64)>,
    ) -> Result<Self, Error> {
        let (file, data) = open_file(file)?;
        let (read, length) = span.unwrap_or((0, data.len()));
        let reader = Counted { file, length, read, reported: read, progress };
        // Pipes have no length to check.
        let remaining = data.is_file().then_some(data.len());
        let reader = Box::new(BufReader::new(reader));
        Ok(Self { path, reader, method: None, remaining, most: remaining, ended: false })
    }

    /// The `length` bytes of a file from `start` on, or what there is of them.
    pub(crate) fn open_range(
        path: &'a Path,
        start: u64,
        length: u64,
        progress: Option<Progress<'a>>,
    ) -> Result<Self, Error> {
        let (mut file, data) = open_file(path)?;
        let sought = file.seek(SeekFrom::Start(start));
        sought.map_err(|cause| Error::open(path, cause))?;
        let remaining = Some(data.len().saturating_sub(start).min(length));
        let reader = Counted { file, length: data.len(), read: start, reported: start, progress };
        let reader = Box::new(BufReader::new(reader.take(length)));
        Ok(Self { path, reader, method: None, remaining, most: remaining, ended: false })
    }

    /// From here on the bytes go through `decode`, which makes at most `most` of them.
    pub(crate) fn through<R: Read + 'a>(
        self,
        method: &'static str,
        most: Option<u64>,
        decode: impl FnOnce(Box<dyn BufRead + 'a>) -> R,
    ) -> Self {
        let reader = Box::new(BufReader::new(decode(self.reader)));
        Self { reader, method: Some(method), remaining: None, most, ..self }
    }

    /// Bytes that the stream can give at most, if each becomes at most so many.
    pub(crate) fn most_times(&self, expansion: u64) -> Option<u64> {
        self.most.map(|bytes| bytes.saturating_mul(expansion))
    }

    /// From here on there are at most `length` bytes.
    pub(crate) fn limited(self, length: u64) -> Self {
        let least = |left: Option<u64>| left.map(|left| left.min(length));
        let (remaining, most) =
            (least(self.remaining), Some(self.most.map_or(length, |most| most.min(length))));
        Self { reader: Box::new(self.reader.take(length)), remaining, most, ..self }
    }

    /// From here on the bytes are gzip.
    pub(crate) fn unpacked(self) -> Self {
        let most = self.most_times(EXPANSION);
        self.through("gzip", most, MultiGzDecoder::new)
    }

    /// From here on the bytes are zlib.
    pub(crate) fn inflated(self) -> Self {
        let most = self.most_times(EXPANSION);
        self.through("zlib", most, ZlibDecoder::new)
    }

    /// From here on there are decimal numbers, each of which becomes the `size` bytes that `encode`
    /// makes of it.
    pub(crate) fn decimals(
        self,
        size: usize,
        encode: impl Fn(&str) -> Option<Vec<u8>> + 'a,
    ) -> Self {
        // A digit and a gap make a number at least.
        let most = self.most.map(|bytes| bytes.div_ceil(2).saturating_mul(size as u64));
        self.through("text", most, |reader| Decimals::new(reader, encode))
    }

    /// From here on there are pairs of hexadecimal digits, each of which becomes a byte.
    pub(crate) fn hexadecimals(self) -> Self {
        let most = self.most.map(|bytes| bytes / 2);
        self.through("text", most, Hexadecimals)
    }

    /// From here on only the bytes that `pick` wants.
    pub(crate) fn picked(self, pick: Pick) -> Self {
        let reader = Box::new(BufReader::new(Picked::new(self.reader, pick)));
        let [remaining, most] = [self.remaining, self.most].map(|left| left.map(|n| pick.count(n)));
        Self { reader, remaining, most, ..self }
    }

    /// From here on the bytes are deflated, without a header of their own.
    pub(crate) fn deflated(self) -> Self {
        let most = self.remaining.map(|bytes| bytes.saturating_mul(EXPANSION));
        let reader = Box::new(BufReader::new(DeflateDecoder::new(self.reader)));
        Self { reader, method: Some("deflate"), remaining: None, most, ..self }
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
        self.took(filled as u64);
        Ok(filled)
    }

    fn took(&mut self, bytes: u64) {
        for left in [&mut self.remaining, &mut self.most].into_iter().flatten() {
            *left = left.saturating_sub(bytes);
        }
    }

    /// Bytes that the stream can still give at most, if that is known.
    pub(crate) fn most(&self) -> Option<u64> {
        self.most
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
        let line = self.last_line(limit)?;
        Ok(line.filter(|_| self.ended))
    }

    /// The same, but the last line of the file need not have an end.
    pub(crate) fn last_line(&mut self, limit: u64) -> Result<Option<String>, Error> {
        let mut line = Vec::new();
        let read = self.reader.by_ref().take(limit).read_until(b'\n', &mut line);
        let count = read.map_err(|error| self.failed(error))?;
        self.took(count as u64);
        self.ended = line.pop_if(|byte| *byte == b'\n').is_some();
        if line.is_empty() && !self.ended {
            return Ok(None);
        }
        line.pop_if(|byte| *byte == b'\r');
        Ok(Some(String::from_utf8_lossy(&line).into_owned()))
    }

    /// Skips a line of any length; whether there was one.
    pub(crate) fn skip_line(&mut self) -> Result<bool, Error> {
        let skipped = self.reader.skip_until(b'\n').map_err(|error| self.failed(error))?;
        self.took(skipped as u64);
        Ok(skipped > 0)
    }

    /// Skips `count` bytes, or what there is; returns how many.
    pub(crate) fn skip(&mut self, count: u64) -> Result<u64, Error> {
        let skipped = io::copy(&mut self.reader.by_ref().take(count), &mut io::sink());
        let skipped = skipped.map_err(|error| self.failed(error))?;
        self.took(skipped);
        Ok(skipped)
    }

    /// Reads compressed data to its end, where its checksum is.
    pub(crate) fn finish(&mut self) -> Result<(), Error> {
        if self.method.is_none() || self.skip(MOST_AFTER)? < MOST_AFTER {
            return Ok(());
        }
        let problem = format!("more than {MOST_AFTER} bytes follow the last voxel");
        Err(Error::header(self.path, problem))
    }

    fn failed(&self, cause: io::Error) -> Error {
        let path = self.path.into();
        if let Some(method) = self.method {
            return Error::Compressed { path, method, cause };
        }
        Error::Io { path, doing: "read it", cause, advice: "check the disk and try again" }
    }
}

/// A file that is no folder, and what the system says of it.
pub(crate) fn open_file(path: &Path) -> Result<(File, Metadata), Error> {
    let file = File::open(path).map_err(|cause| Error::open(path, cause))?;
    let data = file.metadata().map_err(|cause| Error::open(path, cause))?;
    if data.is_dir() {
        return Err(Error::unsupported(path, "a folder", "name one of the files in it"));
    }
    Ok((file, data))
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
