//! Volumes for NumPy.

use std::io::{self, Write};
use std::path::Path;

use shrouds::Occupancy;

/// Writes bytes 0 and 1 with axes z, y, x.
pub(crate) fn write(path: &Path, volume: &Occupancy) -> io::Result<()> {
    let [nx, ny, nz] = volume.grid().dims();
    let text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({nz}, {ny}, {nx})}}");
    // The header is padded to a multiple of 64 bytes, ten of which come before it.
    let header = format!("{text:<width$}\n", width = (text.len() + 11).next_multiple_of(64) - 11);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for k in 0..nz {
        for j in 0..ny {
            bytes.extend((0..nx).map(|i| u8::from(volume.get([i, j, k]))));
        }
    }
    std::fs::File::create(path)?.write_all(&bytes)
}
