//! The files of an array: what they hold of the voxels that are wanted, unpacked.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::volume::decode::Endian;
use crate::volume::zarr::codec::{Packing, unpack};
use crate::volume::zarr::metadata::{Array, Index};

/// Largest chunk that is unpacked, in bytes; whatever more a chunk file itself has.
const MAX_CHUNK: usize = 1 << 30;
/// Bytes of an entry in the index of a shard: offset and length.
const ENTRY: u64 = 16;

/// The elements of a chunk, as stored but unpacked.
#[derive(Debug)]
pub(super) enum Piece {
    /// All alike: nothing, mostly.
    Uniform(Vec<u8>),
    Whole(Vec<u8>),
}

/// What is known of the files without opening them.
#[derive(Debug, Default)]
pub(super) struct Presence {
    pub(super) files: usize,
    pub(super) bytes: u64,
}

/// A file of chunks.
pub(super) struct ChunkFile<'a> {
    array: &'a Array,
    path: PathBuf,
    file: File,
    length: u64,
    /// Offset and length of each chunk; none where the file is one chunk.
    index: Option<Vec<(u64, u64)>>,
}

impl<'a> ChunkFile<'a> {
    /// The file with this number along each axis, if there is one.
    pub(super) fn open(array: &'a Array, numbers: &[usize]) -> Result<Option<Self>, Error> {
        let path = array.folder.join(array.keys.file(numbers));
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
            Err(cause) => return Err(Error::open(&path, cause)),
        };
        let data = file.metadata().map_err(|cause| Error::open(&path, cause))?;
        let mut chunks = Self { array, path, file, length: data.len(), index: None };
        if !data.is_file() {
            return Err(chunks.damaged("it is no file"));
        }
        if let Some(index) = &array.index {
            chunks.index = Some(chunks.read_index(index)?);
        }
        Ok(Some(chunks))
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// The chunk with this number along each axis within the file; none if it is not stored.
    pub(super) fn chunk(&mut self, numbers: &[usize]) -> Result<Option<Piece>, Error> {
        let Some(index) = &self.index else { return self.piece(0, self.length).map(Some) };
        let array = self.array;
        let counts = array.stored.iter().zip(&array.chunk.shape).map(|(all, one)| all / one);
        let place = counts.zip(numbers).fold(0, |place, (count, number)| place * count + number);
        match index[place] {
            (u64::MAX, u64::MAX) => Ok(None),
            (offset, length) => self.piece(offset, length).map(Some),
        }
    }

    fn piece(&mut self, offset: u64, length: u64) -> Result<Piece, Error> {
        let element = self.array.element.size();
        let voxels = self.array.chunk.shape.iter().try_fold(element, |all, n| all.checked_mul(*n));
        let bytes = voxels.filter(|bytes| *bytes as u64 <= length.max(MAX_CHUNK as u64));
        let Some(bytes) = bytes else {
            let what = format!("chunks of shape {:?}", self.array.chunk.shape);
            let advice = "write the array again in chunks of at most a gigabyte";
            return Err(Error::unsupported(&self.array.file, what, advice));
        };
        let packed = self.bytes(offset, length)?;
        let unpacked = unpack(packed, &self.array.chunk.packing, bytes);
        let unpacked = unpacked.map_err(|problem| self.damaged(problem))?;
        let first = &unpacked[..element];
        let uniform = unpacked.chunks_exact(element).all(|value| value == first);
        Ok(if uniform { Piece::Uniform(first.into()) } else { Piece::Whole(unpacked) })
    }

    fn bytes(&mut self, offset: u64, length: u64) -> Result<Vec<u8>, Error> {
        if offset.checked_add(length).is_none_or(|end| end > self.length) {
            return Err(self.damaged(format!("it ends after {} bytes", self.length)));
        }
        let mut bytes = Vec::new();
        let read = self
            .file
            .seek(SeekFrom::Start(offset))
            .and_then(|_| self.file.by_ref().take(length).read_to_end(&mut bytes));
        let read = read.map_err(|cause| Error::open(&self.path, cause))?;
        if (read as u64) < length {
            return Err(self.damaged(format!("it ends after {read} bytes")));
        }
        Ok(bytes)
    }

    fn read_index(&mut self, index: &Index) -> Result<Vec<(u64, u64)>, Error> {
        let array = self.array;
        let chunks = array.stored.iter().zip(&array.chunk.shape).map(|(all, one)| all / one);
        let chunks = chunks.map(|count| count as u64).try_fold(ENTRY, u64::checked_mul);
        let whole = chunks.and_then(|bytes| bytes.checked_add(if index.checksum { 4 } else { 0 }));
        let Some((bytes, whole)) = chunks.zip(whole).filter(|(_, whole)| *whole <= self.length)
        else {
            return Err(self.damaged("it is shorter than its index"));
        };
        let stored = self.bytes(if index.at_start { 0 } else { self.length - whole }, whole)?;
        let steps = if index.checksum { &[Packing::Crc32c][..] } else { &[] };
        let entries = unpack(stored, steps, bytes as usize);
        let entries =
            entries.map_err(|problem| self.damaged(format!("in its index, {problem}")))?;
        let number = |bytes: [u8; 8]| match index.endian {
            Endian::Little => u64::from_le_bytes(bytes),
            Endian::Big => u64::from_be_bytes(bytes),
        };
        let numbers: Vec<u64> = entries.as_chunks().0.iter().map(|bytes| number(*bytes)).collect();
        Ok(numbers.as_chunks().0.iter().map(|[offset, length]| (*offset, *length)).collect())
    }

    fn damaged(&self, problem: impl Into<String>) -> Error {
        Error::Chunk { path: self.path.clone(), problem: problem.into() }
    }
}

impl Presence {
    /// Of the files of an array.
    pub(super) fn of(array: &Array) -> Result<Self, Error> {
        let mut presence = Self::default();
        presence.add(&array.folder, array.shape.len() + 1)?;
        Ok(presence)
    }

    fn add(&mut self, folder: &Path, depth: usize) -> Result<(), Error> {
        let failed = |cause| Error::open(folder, cause);
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let kind = entry.file_type().map_err(failed)?;
            let name = entry.file_name();
            if kind.is_dir() && depth > 0 {
                self.add(&entry.path(), depth - 1)?;
            } else if !kind.is_dir()
                && name != "zarr.json"
                && !name.as_encoded_bytes().starts_with(b".")
            {
                self.files += 1;
                self.bytes += entry.metadata().map_err(failed)?.len();
            }
        }
        Ok(())
    }
}
