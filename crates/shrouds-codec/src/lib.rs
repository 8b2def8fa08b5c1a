//! The compressed `.shroud` file: the voxels of a surface in a fraction of a bit per triangle.
//!
//! ```
//! use shrouds::volume::phantom;
//! use shrouds_codec::{Settings, pack, unpack};
//!
//! let volume = phantom::linked_tori(24)?;
//! let mut file = Vec::new();
//! pack(&volume, &Settings::default(), &mut file)?;
//! assert!(file.len() < 300);
//! assert_eq!(unpack(&file[..])?.volume, volume);
//! # Ok::<(), shrouds_codec::Error>(())
//! ```
//!
//! The flow, one way and back:
//!
//! ```text
//! volume ──► topology ──────────────► coder ──► file
//!  bits       scan: runs, or a model   bytes     header, chunks,
//!             of the voxels around               check sums
//! ```
//!
//! [`pack()`] cuts the volume into slabs of layers. [`topology`] walks through their voxels: where all that is
//! known around a voxel agrees it only says whether that goes on, elsewhere a model gives a probability.
//! The model is a table ([`topology::fast`]) or a [`network`] with tables beside it, weighed by a
//! [`mixer`] ([`topology::dense`]). The [`coder`] makes bytes of bits and probabilities, and the decoder runs
//! the very same code. A label map goes the same way ([`pack_labels`]), one question after another.
//! [`geometry`] adds the places of the vertices, bit by bit.
//! What a file holds byte by byte is in `docs/format.md`.
//!
//! Everything that decides a bit is a whole number, so that bytes are the same on every machine.
//! Whatever a file claims, memory grows with its bytes, nothing panics, and a damaged file is an [`Error`]
//! or a coarser model that says so.

mod error;
pub mod coder;
pub mod counter;
pub mod logistic;
pub mod mixer;
pub mod network;
pub mod topology;
pub mod geometry;
mod file;
mod pack;
mod labels;
mod unpack;

pub use error::Error;
pub use file::{Chunk, Content, Header, Kind, Profile};
pub use labels::{LabelMap, pack_labels, unpack_labels};
pub use pack::{Packed, Packer, Planes, Settings, pack, pack_with_planes};
pub use unpack::{Part, Unpacked, read_header, survey, unpack, unpack_layers, unpack_partial};
