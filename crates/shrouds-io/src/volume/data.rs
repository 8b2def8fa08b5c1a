//! The values of a volume as its header describes them: where they are, how they are packed, and how
//! several volumes share them.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::pick::Pick;
use crate::stream::{Progress, Stream};
use crate::volume::decode::{Element, Elements, Endian};
use crate::volume::{Slabs, Values};

/// How elements become bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Raw,
    Gzip,
    Zlib,
    /// Decimal numbers.
    Decimal,
    /// Hexadecimal bytes.
    Hexadecimal,
}

/// Several volumes in one sequence of elements: `inner` elements of the first, of the second, and so
/// on, `outer` times over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layers {
    pub(super) inner: usize,
    pub(super) count: usize,
    pub(super) outer: usize,
    /// The one that is read.
    pub(super) chosen: usize,
}

/// What a header says of the elements.
#[derive(Debug, Clone, Copy)]
pub(super) struct Data {
    pub(super) element: Element,
    pub(super) endian: Endian,
    pub(super) packing: Packing,
    /// Lines before the data, which are passed before it is unpacked.
    pub(super) line_skip: u64,
    /// Bytes before the data, which are passed once it is unpacked; −1 when the data ends with the
    /// file, −2 when one byte follows it, and so on.
    pub(super) byte_skip: i64,
    /// Elements in a row of the volume.
    pub(super) row: usize,
    pub(super) layers: Layers,
}

impl Data {
    /// The values that follow in `stream`.
    ///
    /// # Errors
    /// [`Error::Header`] when they are more than a file can hold; those of the skips.
    pub(super) fn attached<'a>(self, stream: Stream<'a>) -> Result<Box<dyn Slabs + 'a>, Error> {
        self.check_size(stream.path)?;
        Ok(Box::new(self.elements(stream)?))
    }

    /// The values in `files`, an equal part in each; `path` is the header's.
    ///
    /// # Errors
    /// [`Error::DataFile`] when one of them is missing or too short, [`Error::Header`] and [`Error::Unsupported`] when they cannot be equal parts of the volume.
    pub(super) fn detached<'a>(
        self,
        path: &'a Path,
        files: Vec<PathBuf>,
        progress: Option<Progress<'a>>,
    ) -> Result<Box<dyn Slabs + 'a>, Error> {
        self.check_size(path)?;
        let (data, files) = self.parts(path, files)?;
        let mut lengths = Vec::with_capacity(files.len());
        for file in &files {
            let failed = |error: Error| error.in_data_file(path, file);
            let data_of = file.metadata().map_err(|cause| failed(Error::open(file, cause)))?;
            // A pipe would keep the reader waiting.
            if !data_of.is_file() {
                let what = "a folder, a device or a pipe";
                return Err(failed(Error::unsupported(file, what, "name a file")));
            }
            let length = data_of.len();
            let expected = data.total() as u64 * data.element.size() as u64;
            let found = length.saturating_sub(data.byte_skip.max(0) as u64);
            if data.packing == Packing::Raw && found < expected {
                return Err(failed(Error::Truncated { path: file.clone(), expected, found }));
            }
            lengths.push(length);
        }
        let span = (0, lengths.iter().sum());
        Ok(Box::new(Parts { path, data, progress, files, lengths, span, next: 0, current: None }))
    }

    /// Elements of all layers.
    fn total(&self) -> usize {
        self.layers.inner * self.layers.count * self.layers.outer
    }

    fn check_size(&self, path: &Path) -> Result<(), Error> {
        let Layers { inner, count, outer, .. } = self.layers;
        let bytes = [inner, count, outer, self.element.size()]
            .into_iter()
            .try_fold(1usize, |product, n| product.checked_mul(n));
        let fits = bytes.is_some_and(|bytes| i64::try_from(bytes).is_ok());
        let problem = format!("{inner} × {count} × {outer} values are more than a file can hold");
        if fits { Ok(()) } else { Err(Error::header(path, problem)) }
    }

    /// What one of several files holds, and those of them that hold something of the chosen layer.
    fn parts(self, path: &Path, files: Vec<PathBuf>) -> Result<(Self, Vec<PathBuf>), Error> {
        let (total, number) = (self.total(), files.len());
        if number == 0 || !total.is_multiple_of(number) {
            let problem = format!("{number} data files cannot share {total} values equally");
            return Err(Error::header(path, problem));
        }
        let (each, layers) = (total / number, self.layers);
        let period = layers.inner * layers.count;
        let (layers, files) = if each.is_multiple_of(period) {
            (Layers { outer: each / period, ..layers }, files)
        } else if layers.inner.is_multiple_of(each) {
            let of_layer = |n: &usize| n * each / layers.inner % layers.count == layers.chosen;
            let chosen = files.into_iter().enumerate().filter(|(n, _)| of_layer(n));
            let files = chosen.map(|(_, file)| file).collect();
            (Layers { inner: each, count: 1, outer: 1, chosen: 0 }, files)
        } else {
            return Err(unequal(path));
        };
        let values = layers.inner * layers.outer;
        if !values.is_multiple_of(self.row) {
            return Err(unequal(path));
        }
        Ok((Self { layers, ..self }, files))
    }

    fn elements(self, stream: Stream) -> Result<Elements, Error> {
        let size = self.element.size();
        let Layers { inner, count, outer, chosen } = self.layers;
        let stream = self.unpack(stream)?;
        let stream = if count == 1 {
            stream
        } else {
            let layer = (inner * size) as u64;
            let (from, period) = (chosen as u64 * layer, count as u64 * layer);
            stream.picked(Pick { period, from, to: from + layer, periods: outer as u64 })
        };
        let endian = if self.packing == Packing::Decimal { Endian::Little } else { self.endian };
        Ok(Elements::new(stream, self.element, endian, inner * outer, self.row))
    }

    /// The stream from its first element on, unpacked.
    fn unpack<'a>(&self, mut stream: Stream<'a>) -> Result<Stream<'a>, Error> {
        let mut lines = self.line_skip;
        while lines > 0 && stream.skip_line()? {
            lines -= 1;
        }
        let (element, size) = (self.element, self.element.size());
        let mut stream = match self.packing {
            Packing::Raw => stream,
            Packing::Gzip => stream.unpacked(),
            // Some write gzip where zlib is meant, and all read it.
            Packing::Zlib if stream.peek()?.starts_with(&[0x1f, 0x8b]) => stream.unpacked(),
            Packing::Zlib => stream.inflated(),
            Packing::Decimal => stream.decimals(size, move |text| element.parse(text)),
            Packing::Hexadecimal => stream.hexadecimals(),
        };
        let skip = match u64::try_from(self.byte_skip) {
            Ok(skip) => skip,
            Err(_) => self.before_end(&stream)?,
        };
        stream.skip(skip)?;
        Ok(stream)
    }

    /// Bytes before the data, where it lies at the end of the stream.
    fn before_end(&self, stream: &Stream) -> Result<u64, Error> {
        let path = stream.path;
        let Some(length) = stream.remaining() else {
            let what = "packed data counted from the end of its file";
            return Err(Error::unsupported(path, what, "write it again without a skip"));
        };
        let data = self.total() as u64 * self.element.size() as u64;
        let expected = data + (self.byte_skip.unsigned_abs() - 1);
        let truncated = || Error::Truncated { path: path.into(), expected, found: length };
        length.checked_sub(expected).ok_or_else(truncated)
    }
}

fn unequal(path: &Path) -> Error {
    let what = "a volume whose data files hold parts of rows or of several volumes";
    Error::unsupported(path, what, "write it to one file")
}

/// Values in one file after another.
struct Parts<'a> {
    path: &'a Path,
    /// What each of the files holds.
    data: Data,
    progress: Option<Progress<'a>>,
    files: Vec<PathBuf>,
    lengths: Vec<u64>,
    /// Bytes of the files before the next, and of all.
    span: (u64, u64),
    /// The file after the one that is being read.
    next: usize,
    current: Option<Elements<'a>>,
}

impl Slabs for Parts<'_> {
    fn next(&mut self) -> Result<Option<Values>, Error> {
        loop {
            if let Some(elements) = &mut self.current {
                let file = &self.files[self.next - 1];
                let slab = elements.next().map_err(|error| error.in_data_file(self.path, file))?;
                if let Some(slab) = slab {
                    return Ok(Some(slab));
                }
                self.current = None;
            }
            let Some(file) = self.files.get(self.next) else { return Ok(None) };
            let elements = Stream::open_part(self.path, file, self.progress, Some(self.span))
                .and_then(|stream| self.data.elements(stream))
                .map_err(|error| error.in_data_file(self.path, file))?;
            self.current = Some(elements);
            self.span.0 += self.lengths[self.next];
            self.next += 1;
        }
    }

    fn held(&self) -> usize {
        // The lengths of files that are not packed were checked.
        let each = self.data.layers.inner * self.data.layers.outer;
        if self.data.packing == Packing::Raw { each * self.files.len() } else { 0 }
    }
}
