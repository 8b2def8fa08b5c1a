//! The directories of a TIFF or BigTIFF file: one per page, each a list of tagged values.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::Error;
use crate::stream::open_file;
use crate::volume::decode::Endian;

/// An open file.
///
/// Directories, tables and data of a sound file do not overlap, so that all of them together are no
/// longer than the file: what exceeds that is refused before any time or memory goes into it.
pub(super) struct TiffFile<'a> {
    pub(super) path: &'a Path,
    file: File,
    pub(super) length: u64,
    pub(super) endian: Endian,
    big: bool,
    /// Where the first directory is.
    first: u64,
    /// Bytes of directories, tables and data met so far.
    spent: u64,
}

/// The tagged values of a page.
pub(super) struct Directory {
    entries: BTreeMap<u16, Entry>,
    /// Its length in the file.
    length: u64,
    /// Where the next one is; 0 after the last.
    pub(super) next: u64,
}

#[derive(Clone, Copy)]
struct Entry {
    kind: u16,
    count: u64,
    /// The values themselves where they fit, else their place.
    field: [u8; 8],
}

impl<'a> TiffFile<'a> {
    pub(super) fn open(path: &'a Path) -> Result<Self, Error> {
        let (file, data) = open_file(path)?;
        let (endian, big, first, spent) = (Endian::Little, false, 0, 0);
        let mut tiff = Self { path, file, length: data.len(), endian, big, first, spent };
        let start = tiff.bytes(0, tiff.length.min(8))?;
        tiff.endian = match start.get(..4) {
            Some([b'I', b'I', ..]) => Endian::Little,
            Some([b'M', b'M', ..]) => Endian::Big,
            _ => return Err(foreign(path)),
        };
        tiff.big = match tiff.number(&start[2..4]) {
            42 => false,
            43 => true,
            _ => return Err(foreign(path)),
        };
        let field = if tiff.big { 8 } else { 4 };
        let first = tiff.bytes(field, field)?;
        tiff.first = tiff.number(&first);
        Ok(tiff)
    }

    /// The places of all directories, in their order.
    pub(super) fn places(&mut self) -> Result<Vec<u64>, Error> {
        let (mut places, mut known) = (Vec::new(), BTreeSet::new());
        let mut next = self.first;
        while next != 0 {
            if !known.insert(next) {
                return Err(Error::header(self.path, "its pages go round in a circle"));
            }
            places.push(next);
            let directory = self.directory(next)?;
            self.spend(directory.length)?;
            next = directory.next;
        }
        if places.is_empty() {
            return Err(Error::header(self.path, "it has no pages"));
        }
        Ok(places)
    }

    pub(super) fn directory(&mut self, place: u64) -> Result<Directory, Error> {
        let (field, size) = if self.big { (8, 20) } else { (4, 12) };
        let head = if self.big { 8 } else { 2 };
        let count = self.bytes(place, head)?;
        let count = self.number(&count);
        let start = place.saturating_add(head);
        let bytes = self.bytes(start, count.saturating_mul(size).saturating_add(field))?;
        let (entries, next) = bytes.split_at(bytes.len() - field as usize);
        let entries = entries.chunks_exact(size as usize).map(|entry| {
            let (kind, rest) = (self.number(&entry[2..4]) as u16, &entry[4..]);
            let (count, value) = rest.split_at(field as usize);
            let mut field = [0; 8];
            field[..value.len()].copy_from_slice(value);
            (self.number(&entry[..2]) as u16, Entry { kind, count: self.number(count), field })
        });
        let (length, next) = (entries.len() as u64 * size, self.number(next));
        Ok(Directory { entries: entries.collect(), length, next })
    }

    /// The first `most` whole numbers of a tag; `None` if it is not there or of another kind.
    pub(super) fn numbers(
        &mut self,
        directory: &Directory,
        tag: u16,
        most: usize,
    ) -> Result<Option<Vec<u64>>, Error> {
        let Some(entry) = directory.entries.get(&tag).copied() else { return Ok(None) };
        let size = match entry.kind {
            1 => 1,
            3 => 2,
            4 | 13 => 4,
            16 | 18 => 8,
            _ => return Ok(None),
        };
        let bytes = self.value(entry, size, most as u64)?;
        Ok(Some(bytes.chunks_exact(size as usize).map(|bytes| self.number(bytes)).collect()))
    }

    /// The one number of a tag.
    pub(super) fn number_of(
        &mut self,
        directory: &Directory,
        tag: u16,
    ) -> Result<Option<u64>, Error> {
        Ok(self.numbers(directory, tag, 1)?.and_then(|numbers| numbers.first().copied()))
    }

    /// The fraction of a tag.
    pub(super) fn ratio(&mut self, directory: &Directory, tag: u16) -> Result<Option<f64>, Error> {
        let entry = directory.entries.get(&tag).filter(|entry| entry.kind == 5 && entry.count > 0);
        let Some(entry) = entry.copied() else { return Ok(None) };
        let bytes = self.value(entry, 8, 1)?;
        Ok(Some(self.number(&bytes[..4]) as f64 / self.number(&bytes[4..]) as f64))
    }

    /// The text of a tag, without the zero byte at its end.
    pub(super) fn text(&mut self, directory: &Directory, tag: u16) -> Result<String, Error> {
        let entry = directory.entries.get(&tag).filter(|entry| entry.kind == 2);
        let Some(entry) = entry.copied() else { return Ok(String::new()) };
        let bytes = self.value(entry, 1, entry.count)?;
        Ok(String::from_utf8_lossy(&bytes).trim_end_matches('\0').into())
    }

    /// The bytes of the first `most` values of an entry.
    fn value(&mut self, entry: Entry, size: u64, most: u64) -> Result<Vec<u8>, Error> {
        let here = if self.big { 8 } else { 4 };
        let wanted = entry.count.min(most).saturating_mul(size);
        if entry.count.saturating_mul(size) <= here {
            return Ok(entry.field[..wanted as usize].into());
        }
        let place = self.number(&entry.field[..here as usize]);
        self.bytes(place, wanted)
    }

    /// The bytes at a place, all of which must be there.
    pub(super) fn bytes(&mut self, place: u64, length: u64) -> Result<Vec<u8>, Error> {
        if place.checked_add(length).is_none_or(|end| end > self.length) {
            return Err(Error::header(self.path, "the file ends inside it, or before its data"));
        }
        let mut bytes = vec![0; length as usize];
        let read = self.file.seek(SeekFrom::Start(place));
        read.and_then(|_| self.file.read_exact(&mut bytes)).map_err(|cause| self.failed(cause))?;
        Ok(bytes)
    }

    fn failed(&self, cause: io::Error) -> Error {
        let advice = "check the disk and try again";
        Error::Io { path: self.path.into(), doing: "read it", cause, advice }
    }

    /// Counts bytes that a page takes.
    pub(super) fn spend(&mut self, bytes: u64) -> Result<(), Error> {
        self.spent = self.spent.saturating_add(bytes);
        if self.spent <= self.length {
            return Ok(());
        }
        let problem = "its parts overlap: together they are longer than the file";
        Err(Error::header(self.path, problem))
    }

    fn number(&self, bytes: &[u8]) -> u64 {
        let add = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        match self.endian {
            Endian::Little => bytes.iter().rev().fold(0, add),
            Endian::Big => bytes.iter().fold(0, add),
        }
    }
}

fn foreign(path: &Path) -> Error {
    let advice = "check the extension, or write it again as .tif";
    Error::Content { path: path.into(), expected: "a TIFF image", advice }
}
