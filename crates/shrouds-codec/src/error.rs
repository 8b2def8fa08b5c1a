//! The one error type of the crate.

use std::io;

/// What can be wrong with a `.shroud` file or with what is to be packed. Messages do not name the
/// file: who opened it does.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The bytes are not those of a `.shroud` file.
    #[error("this is no .shroud file: it does not begin like one; check the name of the file")]
    NotShroud,
    /// The file is of a version that is not known.
    #[error(
        "the file has version {found} of the format, and only version {known} is known; take a newer program"
    )]
    Version {
        /// The version of the file.
        found: u8,
        /// The version that is known.
        known: u8,
    },
    /// The header is damaged.
    #[error("the header is damaged: {0}; get the file again")]
    Header(String),
    /// A chunk is damaged, and nothing before it is a whole model.
    #[error("{what} is damaged: {problem}; get the file again")]
    Chunk {
        /// Which part of the file.
        what: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The file ends early, and what is there is no whole model.
    #[error("the file ends after {layers} of {all} layers; get it again")]
    Cut {
        /// Whole layers that are there.
        layers: usize,
        /// Layers that there should be.
        all: usize,
    },
    /// Bytes follow the last chunk.
    #[error("the file goes on after its end; get it again")]
    Trailing,
    /// The file holds something else than was asked for.
    #[error("the file holds {found}, not {wanted}")]
    Content {
        /// What it holds.
        found: &'static str,
        /// What was asked for.
        wanted: &'static str,
    },
    /// A setting is outside its range, or the values do not fit the lattice.
    #[error("{name} is {value}, but must be {range}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: String,
        /// What is allowed.
        range: String,
    },
    /// There is not enough memory for the volume.
    #[error("{0} bytes are needed, more memory than there is; unpack fewer layers at a time")]
    Memory(u64),
    /// The lattice is none.
    #[error(transparent)]
    Grid(#[from] shrouds::Error),
    /// Reading or writing failed.
    #[error("reading or writing failed ({0})")]
    Io(#[from] io::Error),
}
