//! Meshes as Neuroglancer's precomputed format has them, of several resolutions, coded by Draco.
//!
//! A mesh is cut at the borders of cubes, finer ones first; the fragment of each cube has its positions
//! as whole numbers of 10 or 16 bits within the cube. The *stored model* space of the format is that of
//! the indices of the finest lattice here, in which cubes and offsets are exact; `transform` in the
//! `info` leads from there to the world. Nothing is ever cut in two: triangles lie within cells of their
//! lattice, and all borders of cubes are planes of it.

mod draco;
mod fragment;
mod info;
mod manifest;

pub(crate) use fragment::fragments;
pub use info::write_layer_info;
pub(crate) use manifest::{Manifest, Node};

/// Bits of each coordinate of a vertex within its fragment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VertexBits {
    /// 10 bits: an eighth of a voxel in chunks of 128.
    Ten,
    /// 16 bits: a five-hundredth of a voxel in chunks of 128.
    #[default]
    Sixteen,
}

impl VertexBits {
    /// How many.
    pub fn count(self) -> u32 {
        match self {
            Self::Ten => 10,
            Self::Sixteen => 16,
        }
    }

    /// So many, if the format knows them.
    pub fn of_count(count: u32) -> Option<Self> {
        [Self::Ten, Self::Sixteen].into_iter().find(|bits| bits.count() == count)
    }

    /// The largest coordinate.
    pub(crate) fn largest(self) -> u32 {
        (1 << self.count()) - 1
    }
}
