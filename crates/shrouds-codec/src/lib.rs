//! The compressed `.shroud` file.

mod error;
pub mod coder;
pub mod counter;
pub mod logistic;
pub mod mixer;
pub mod network;
pub mod topology;
mod file;
mod pack;
mod labels;
mod unpack;

pub use error::Error;
pub use file::{Chunk, Content, Header, Kind, Profile};
pub use labels::{LabelMap, pack_labels, unpack_labels};
pub use pack::{Packed, Packer, Planes, Settings, pack, pack_with_planes};
pub use unpack::{Part, Unpacked, read_header, survey, unpack, unpack_layers, unpack_partial};
