//! Records of fixed size and lines of text, gathered in one buffer before they are written.

use std::io::{self, Write};

/// Bytes written at a time.
const BUFFER: usize = 1 << 16;
/// Room for the last line of text.
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

/// Writes a line of text for each item; `encode` appends it to the buffer.
pub(super) fn write_text<T>(
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
