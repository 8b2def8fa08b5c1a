//! Surfaces of volumes that no memory holds, chunk by chunk: in pieces of a volume and what was found
//! for the chunks beside each, out pieces of one seamless surface.
//!
//! Everything here is a pure function of what is handed in, so it can run anywhere, in any order and
//! twice. A vertex is named by its grid edge: it belongs to the chunk that has the low end, a cell and
//! its triangles to the one that has the lowest corner. Positions are found in passes over tiles that are the
//! same in every chunking ([`Layout`]), each from what was known before the pass; so the result does not
//! depend on the chunks. For a surface that is large enough to be worked on in tiles it is that of
//! [`shroud`](crate::shroud), bit for bit.
//!
//! The order of the work, for each chunk unless it says otherwise:
//!
//! 1. [`Chunk::new`] from the voxels around it, [`Chunk::rows`], [`Chunk::shared_rows`] and [`Chunk::start`];
//! 2. for every one of [`Passes`]: positions from [`Chunk::start`] or, by [`Chunk::add`] and
//!    [`Chunk::positions`], from the shares that the pass before found for all chunks [`Layout::beside`];
//!    [`Chunk::relax`]; for all chunks together the mean energy;
//! 3. numbers of vertices, all chunks one after another; [`Chunk::mesh`].
//!
//! Uses: `grid`, `volume`, `surface`, `optimize`, `mesh`.

mod chunk;
mod coarser;
mod layout;
mod mesh;

pub use chunk::{Chunk, Passes, Relaxed};
pub use layout::Layout;
pub use mesh::ChunkMesh;
