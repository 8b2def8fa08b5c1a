//! NumPy archives, `.npz`: a zip file with one `.npy` file per array, stored or deflated.

use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use flate2::{Crc, bufread::DeflateDecoder};
use zip::{CompressionMethod, ZipArchive, result::ZipError};

use crate::error::Error;
use crate::stream::{EXPANSION, Stream, open_file};
use crate::volume::{Unread, VolumeOptions, npy};

/// An array of the archive, and where its bytes are.
struct Entry {
    name: String,
    start: u64,
    length: u64,
    deflated: bool,
    checksum: u32,
}

pub(super) fn open<'a>(path: &'a Path, options: &VolumeOptions<'a>) -> Result<Unread<'a>, Error> {
    let mut entries = entries(path)?;
    let mut volumes = Vec::new();
    for (n, entry) in entries.iter().enumerate() {
        let header = npy::read_header(&mut entry.stream(path, &VolumeOptions::default())?);
        if header.is_ok_and(|header| header.shape.len() == 3) {
            volumes.push(n);
        }
    }
    let arrays: Vec<String> = volumes.iter().map(|n| entries[*n].name.clone()).collect();
    let chosen = match (options.array, volumes.as_slice(), entries.len()) {
        (Some(name), ..) => {
            let wanted = name.strip_suffix(".npy").unwrap_or(name);
            entries.iter().position(|entry| entry.name == wanted)
        }
        (None, [only], _) => Some(*only),
        // Says what the one array there is lacks.
        (None, [], 1) => Some(0),
        (None, [], _) => {
            let what = "an archive without any array of three dimensions";
            return Err(Error::unsupported(path, what, "save the volume with numpy.savez"));
        }
        _ => None,
    };
    let Some(chosen) = chosen else {
        let choices = format!("the arrays {}", arrays.join(", "));
        return Err(Error::Choice { path: path.into(), choices });
    };
    let entry = entries.swap_remove(chosen);
    let mut unread = npy::open(entry.stream(path, options)?, options)?;
    if arrays.len() > 1 {
        unread.contents.arrays = arrays;
    }
    Ok(unread)
}

/// The arrays of the archive in its order, without the extension that NumPy appends to their names.
fn entries(path: &Path) -> Result<Vec<Entry>, Error> {
    let (file, _) = open_file(path)?;
    let damaged = |cause: ZipError| match cause {
        ZipError::Io(cause) => Error::Compressed { path: path.into(), method: "zip", cause },
        _ => Error::Content {
            path: path.into(),
            expected: "a sound zip archive of NumPy arrays",
            advice: "check the extension, or copy or write it again with numpy.savez",
        },
    };
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(damaged)?;
    let mut entries = Vec::new();
    for n in 0..archive.len() {
        let entry = archive.by_index_raw(n).map_err(damaged)?;
        let name = entry.name().map_err(damaged)?;
        let Some(name) = name.strip_suffix(".npy") else { continue };
        let deflated = match entry.compression() {
            _ if entry.encrypted() => None,
            CompressionMethod::Stored => Some(false),
            CompressionMethod::Deflated => Some(true),
            _ => None,
        };
        let (Some(deflated), Some(start)) = (deflated, entry.data_start()) else {
            let what = format!("the array {name:.80}, encrypted or compressed in an unusual way,");
            let advice = "write it again with numpy.savez_compressed";
            return Err(Error::unsupported(path, what, advice));
        };
        let (length, checksum) = (entry.compressed_size(), entry.crc32());
        entries.push(Entry { name: name.into(), start, length, deflated, checksum });
    }
    Ok(entries)
}

impl Entry {
    fn stream<'a>(&self, path: &'a Path, options: &VolumeOptions<'a>) -> Result<Stream<'a>, Error> {
        let (sum, crc) = (self.checksum, Crc::new());
        let stream = Stream::open_range(path, self.start, self.length, options.progress)?;
        Ok(if self.deflated {
            let decode = move |reader| Checked { reader: DeflateDecoder::new(reader), sum, crc };
            let most = stream.most_times(EXPANSION);
            stream.through("zip", most, decode)
        } else {
            let most = stream.most();
            stream.through("zip", most, move |reader: Box<dyn BufRead + 'a>| Checked {
                reader,
                sum,
                crc,
            })
        })
    }
}

/// Bytes whose checksum is compared at their end.
struct Checked<R> {
    reader: R,
    sum: u32,
    crc: Crc,
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.crc.update(&buffer[..count]);
        if count == 0 && !buffer.is_empty() && self.crc.sum() != self.sum {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "the checksum is wrong"));
        }
        Ok(count)
    }
}
