//! Files with what was found for a chunk: some numbers that sum it up, then arrays.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use flate2::Crc;

use crate::atomic::write_atomically;
use crate::error::Error;

const MAGIC: &[u8; 16] = b"shrouds chunk 2\n";
const NUMBERS: usize = 3;
/// Magic bytes, numbers, bytes of the arrays, their checksum and that of all before.
const HEADER: usize = 16 + 8 * NUMBERS + 8 + 4 + 4;

/// What a file sums up.
pub(super) type Summary = [u64; NUMBERS];

/// A number as its bytes.
pub(super) trait Plain<const SIZE: usize>: Copy {
    fn bytes(self) -> [u8; SIZE];
    fn number(bytes: [u8; SIZE]) -> Self;
}

macro_rules! plain {
    ($($type:ty, $size:literal);*) => {$(
        impl Plain<$size> for $type {
            fn bytes(self) -> [u8; $size] {
                self.to_le_bytes()
            }
            fn number(bytes: [u8; $size]) -> Self {
                Self::from_le_bytes(bytes)
            }
        }
    )*};
}

plain!(u8, 1; u32, 4; f32, 4; u64, 8);

/// A file that is to be, or that was read.
#[derive(Default)]
pub(super) struct Artefact {
    path: PathBuf,
    pub(super) summary: Summary,
    bytes: Vec<u8>,
    /// Bytes read so far.
    read: usize,
}

impl Artefact {
    pub(super) fn new(summary: Summary) -> Self {
        Self { summary, ..Self::default() }
    }

    /// Appends an array.
    pub(super) fn push<const SIZE: usize, T: Plain<SIZE>>(
        mut self,
        values: impl ExactSizeIterator<Item = T>,
    ) -> Self {
        self.bytes.extend((values.len() as u64).to_le_bytes());
        values.for_each(|value| self.bytes.extend(value.bytes()));
        self
    }

    /// The next array.
    pub(super) fn next<const SIZE: usize, T: Plain<SIZE>>(&mut self) -> Result<Vec<T>, Error> {
        let Some(rest) = self.bytes.get(self.read..) else { return Err(self.damaged()) };
        let Some((count, rest)) = rest.split_first_chunk() else { return Err(self.damaged()) };
        let count = u64::from_le_bytes(*count) as usize;
        let bytes = count.checked_mul(SIZE).and_then(|size| rest.get(..size));
        let Some(bytes) = bytes else { return Err(self.damaged()) };
        self.read += 8 + bytes.len();
        Ok(bytes.as_chunks().0.iter().map(|bytes| T::number(*bytes)).collect())
    }

    /// Whether there are no arrays.
    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    fn damaged(&self) -> Error {
        Error::Artefact { path: self.path.clone() }
    }

    /// Writes the file, which appears whole or not at all.
    pub(super) fn write(&self, path: &Path) -> Result<(), Error> {
        let mut header = Vec::with_capacity(HEADER);
        header.extend(MAGIC);
        self.summary.iter().for_each(|number| header.extend(number.to_le_bytes()));
        header.extend((self.bytes.len() as u64).to_le_bytes());
        header.extend(checksum(&self.bytes).to_le_bytes());
        header.extend(checksum(&header).to_le_bytes());
        write_atomically(path, |writer| {
            writer.write_all(&header)?;
            writer.write_all(&self.bytes)
        })
    }

    /// Reads the whole file.
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let damaged = || Error::Artefact { path: path.into() };
        let mut file = File::open(path).map_err(|cause| Error::open(path, cause))?;
        let Header { summary, length, checksum: expected } =
            Header::read(&mut file).ok_or_else(damaged)?;
        let mut bytes = Vec::new();
        // A byte more than there should be, to see whether there are any.
        let read = file.take(length.saturating_add(1)).read_to_end(&mut bytes);
        read.map_err(|cause| Error::open(path, cause))?;
        if bytes.len() as u64 != length || checksum(&bytes) != expected {
            return Err(damaged());
        }
        Ok(Self { path: path.into(), summary, bytes, read: 0 })
    }

    /// What a file sums up; nothing if there is none, or not all of it.
    pub(super) fn summary(path: &Path) -> Result<Option<Summary>, Error> {
        let mut file = match File::open(path) {
            Ok(file) => file,
            Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
            Err(cause) => return Err(Error::open(path, cause)),
        };
        let length = file.metadata().map_err(|cause| Error::open(path, cause))?.len();
        let header = Header::read(&mut file);
        let whole =
            header.filter(|header| header.length.checked_add(HEADER as u64) == Some(length));
        Ok(whole.map(|header| header.summary))
    }
}

struct Header {
    summary: Summary,
    length: u64,
    checksum: u32,
}

impl Header {
    fn read(file: &mut File) -> Option<Self> {
        let mut bytes = [0; HEADER];
        file.read_exact(&mut bytes).ok()?;
        let (checked, own) = bytes.split_last_chunk()?;
        if checksum(checked) != u32::from_le_bytes(*own) {
            return None;
        }
        let (magic, numbers) = checked.split_first_chunk()?;
        let (numbers, expected) = numbers.split_last_chunk()?;
        let mut numbers = numbers.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes));
        let mut next = || numbers.next().unwrap_or_default();
        let summary = std::array::from_fn(|_| next());
        let length = next();
        (magic == MAGIC).then_some(Self {
            summary,
            length,
            checksum: u32::from_le_bytes(*expected),
        })
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_written_comes_back_and_every_damage_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.chunk");
        assert_eq!(Artefact::summary(&path).unwrap(), None);
        let (numbers, places) = ([1u32, 2, u32::MAX], [0.5f32, -1.0]);
        let artefact = Artefact::new([7, 8, 9]).push(numbers.into_iter()).push(places.into_iter());
        artefact.write(&path).unwrap();
        assert_eq!(Artefact::summary(&path).unwrap(), Some([7, 8, 9]));
        let mut back = Artefact::read(&path).unwrap();
        assert_eq!(back.summary, [7, 8, 9]);
        assert_eq!(back.next::<4, u32>().unwrap(), numbers);
        assert_eq!(back.next::<4, f32>().unwrap(), places);
        assert!(matches!(back.next::<1, u8>(), Err(Error::Artefact { .. })));
        let whole = fs::read(&path).unwrap();
        for n in 0..whole.len() {
            fs::write(&path, &whole[..n]).unwrap();
            assert!(Artefact::read(&path).is_err());
            assert_eq!(Artefact::summary(&path).unwrap(), None);
            let mut changed = whole.clone();
            changed[n] ^= 1;
            fs::write(&path, &changed).unwrap();
            assert!(Artefact::read(&path).is_err(), "byte {n}");
        }
        fs::write(&path, [&whole[..], &[0]].concat()).unwrap();
        assert!(Artefact::read(&path).is_err() && Artefact::summary(&path).unwrap().is_none());
    }
}
