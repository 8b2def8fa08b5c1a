//! The file: a header and chunks, each with check sums, so that every whole prefix is a model.
//!
//! `docs/format.md` has it byte by byte.

mod chunk;
mod header;
mod number;

pub(crate) use chunk::Damage;
pub use chunk::{Chunk, Kind};
pub use header::{Content, Header, Profile};
