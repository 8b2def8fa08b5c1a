//! Packed files in: opened, and what their headers mean for the program.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use shrouds_codec::{Error, Header};
use shrouds_io::Frame;

use crate::failure::Failure;
use crate::report::Lattice;

/// Whether the name of a file is that of a packed one.
pub(crate) fn is_packed(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("shroud"))
}

/// Reads a file; failures name it.
pub(crate) fn open<T>(
    path: &Path,
    read: impl FnOnce(BufReader<File>) -> Result<T, Error>,
) -> Result<T, Failure> {
    let fail = |problem: String| Failure::Undone(format!("{}: {problem}", path.display()));
    let file = File::open(path)
        .map_err(|cause| fail(format!("cannot read it ({cause}); check the name of the file")))?;
    read(BufReader::new(file)).map_err(|error| match error {
        Error::Chunk { .. } | Error::Cut { .. } => {
            fail(format!("{error}; --partial takes the layers before"))
        }
        _ => fail(error.to_string()),
    })
}

pub(crate) fn frame(header: &Header) -> Frame {
    Frame { name: header.space.clone(), unit: header.unit.clone(), source: "packed" }
}

pub(crate) fn lattice(header: &Header) -> Lattice {
    Lattice::new(&header.grid, &header.space, &header.unit)
}
