//! Records of fixed size, lines of text and the like, gathered in one buffer before they are written.

use std::io::{self, Write};

/// Bytes written at a time.
const BUFFER: usize = 1 << 16;
/// Room for what the last item appends.
const LINE: usize = 1 << 8;

/// Writes records of `SIZE` bytes, one for each item.
pub(super) fn write_fixed<T, const SIZE: usize>(
    writer: &mut dyn Write,
    mut items: impl ExactSizeIterator<Item = T>,
    encode: impl Fn(T, &mut [u8; SIZE]),
) -> io::Result<()> {
    let mut buffer = vec![0; BUFFER / SIZE * SIZE];
    while items.len() > 0 {
        let mut filled = 0;
        for (record, item) in buffer.as_chunks_mut().0.iter_mut().zip(items.by_ref()) {
            encode(item, record);
            filled += SIZE;
        }
        writer.write_all(&buffer[..filled])?;
    }
    Ok(())
}

/// Writes records of `size` bytes, one for each item.
pub(super) fn write_records<T>(
    writer: &mut dyn Write,
    size: usize,
    mut items: impl ExactSizeIterator<Item = T>,
    encode: impl Fn(T, &mut [u8]),
) -> io::Result<()> {
    let mut buffer = vec![0; BUFFER.next_multiple_of(size)];
    while items.len() > 0 {
        let mut filled = 0;
        for (record, item) in buffer.chunks_exact_mut(size).zip(items.by_ref()) {
            encode(item, record);
            filled += size;
        }
        writer.write_all(&buffer[..filled])?;
    }
    Ok(())
}

/// Puts bytes at the beginning of a record; what follows them.
pub(super) fn put<'r>(record: &'r mut [u8], bytes: &[u8]) -> &'r mut [u8] {
    let (start, rest) = record.split_at_mut(bytes.len());
    start.copy_from_slice(bytes);
    rest
}

/// Writes what `encode` appends to a buffer for each item: a few hundred bytes at most.
pub(super) fn write_gathered<T>(
    writer: &mut dyn Write,
    items: impl Iterator<Item = T>,
    encode: impl Fn(T, &mut Vec<u8>),
) -> io::Result<()> {
    let mut buffer = Vec::with_capacity(BUFFER + LINE);
    for item in items {
        encode(item, &mut buffer);
        if buffer.len() >= BUFFER {
            writer.write_all(&buffer)?;
            buffer.clear();
        }
    }
    writer.write_all(&buffer)
}
