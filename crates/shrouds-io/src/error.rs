//! The one error type of the crate.

use std::io;
use std::path::{Path, PathBuf};

/// What can be wrong with a file. Every message names the file, says what is wrong and what to do.
///
/// Causes are part of the message, so they are fields and not [`std::error::Error::source`], which
/// would make callers print them twice.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused.
    #[error("{}: cannot {doing} ({cause}); {advice}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        cause: io::Error,
        /// What to do.
        advice: &'static str,
    },
    /// The name does not end in an extension of a known format.
    #[error("{}: not a known kind of {kind} by its name; {known}", .path.display())]
    Extension {
        /// The file.
        path: PathBuf,
        /// `volume` or `mesh`.
        kind: &'static str,
        /// The extensions that are known.
        known: &'static str,
    },
    /// The file does not hold what its extension promises.
    #[error("{}: the content is not {expected}; {advice}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What the extension promises.
        expected: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// The header cannot be understood.
    #[error("{}: the header is damaged: {problem}; write the file again", .path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// Which field, and how.
        problem: String,
    },
    /// The file is sound, but holds something that is not read here.
    #[error("{}: {what} cannot be read; {advice}", .path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What the file holds.
        what: String,
        /// What to do.
        advice: &'static str,
    },
    /// The file holds several volumes, and none of them was chosen, or one that is not there.
    #[error("{}: it holds {choices}; name one of them", .path.display())]
    Choice {
        /// The file.
        path: PathBuf,
        /// What there is to choose from.
        choices: String,
    },
    /// Nothing says how to read the file, or what is said does not fit.
    #[error("{}: {problem}", .path.display())]
    Layout {
        /// The file.
        path: PathBuf,
        /// What is missing or does not fit, and what to do.
        problem: String,
    },
    /// There are fewer bytes than the header promises.
    #[error(
        "{}: expected {expected} bytes of voxel data, found {found}: the file is truncated; copy or write it again",
        .path.display()
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Bytes that the header promises.
        expected: u64,
        /// Bytes that are there.
        found: u64,
    },
    /// The header is sound, but not a file that it names for its data.
    #[error("{}: its data file cannot be read: {cause}", .path.display())]
    DataFile {
        /// The file with the header.
        path: PathBuf,
        /// What is wrong with the other.
        cause: Box<Error>,
    },
    /// The compressed data does not unpack, or the numbers in a text are none.
    #[error(
        "{}: the {method} data is truncated or damaged ({cause}); copy or write the file again",
        .path.display()
    )]
    Compressed {
        /// The file.
        path: PathBuf,
        /// How it is packed: `gzip`, `zlib`, `text`.
        method: &'static str,
        /// What the decoder said.
        cause: io::Error,
    },
    /// A file with a part of the voxels does not give them.
    #[error("{}: this chunk of voxels is damaged: {problem}; copy or write it again", .path.display())]
    Chunk {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// A file with what was found for a chunk of a surface is damaged.
    #[error("{}: damaged; remove it and call again", .path.display())]
    Artefact {
        /// The file.
        path: PathBuf,
    },
    /// What was found for chunks of a surface does not go together.
    #[error("{}: {cause}", .path.display())]
    Chunks {
        /// The folder.
        path: PathBuf,
        /// What is wrong.
        cause: shrouds::Error,
    },
    /// The dimensions or the frame of the file make no lattice.
    #[error("{}: {cause}", .path.display())]
    Lattice {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        cause: shrouds::Error,
    },
    /// A value of the file has no side.
    #[error("{}: {cause}", .path.display())]
    Values {
        /// The file.
        path: PathBuf,
        /// Which one.
        cause: shrouds::Error,
    },
    /// The mesh has a damaged part, or the file ends inside it.
    #[error("{}: the mesh is damaged: {problem}; write the file again", .path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// Which vertex or face, and how.
        problem: String,
    },
    /// The mesh cannot be written as asked.
    #[error("{}: the mesh cannot be written: {problem}", .path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What stands in the way, and what to do.
        problem: String,
    },
    /// The volume cannot be written in this format.
    #[error("{}: the volume cannot be written: {problem}", .path.display())]
    UnwritableVolume {
        /// The file.
        path: PathBuf,
        /// What stands in the way, and what to do.
        problem: String,
    },
    /// The output path cannot become a file.
    #[error("{}: cannot be written: {problem}; {advice}", .path.display())]
    Target {
        /// The file.
        path: PathBuf,
        /// What the path is.
        problem: &'static str,
        /// What to do.
        advice: &'static str,
    },
}

impl Error {
    pub(crate) fn open(path: &Path, cause: io::Error) -> Self {
        let advice = match cause.kind() {
            io::ErrorKind::NotFound => "check the path",
            io::ErrorKind::PermissionDenied => "ask for permission to read it",
            _ => "check that it is a readable file",
        };
        Self::Io { path: path.into(), doing: "open it", cause, advice }
    }

    /// The same about `file`, which holds the data of the header at `path`.
    pub(crate) fn in_data_file(mut self, path: &Path, file: &Path) -> Self {
        if let Self::Header { path, .. }
        | Self::Unsupported { path, .. }
        | Self::Truncated { path, .. }
        | Self::Compressed { path, .. } = &mut self
        {
            *path = file.into();
        }
        Self::DataFile { path: path.into(), cause: Box::new(self) }
    }

    pub(crate) fn header(path: &Path, problem: impl Into<String>) -> Self {
        Self::Header { path: path.into(), problem: problem.into() }
    }

    pub(crate) fn unsupported(path: &Path, what: impl Into<String>, advice: &'static str) -> Self {
        Self::Unsupported { path: path.into(), what: what.into(), advice }
    }

    pub(crate) fn mesh(path: &Path, problem: impl Into<String>) -> Self {
        Self::Mesh { path: path.into(), problem: problem.into() }
    }
}
