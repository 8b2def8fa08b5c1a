//! The topology: one bit per lattice point, in raster order.
//!
//! Where all of a voxel's neighbours that are already known agree, it goes into a run that stays as it
//! is but for a rare surprise ([`scan`]). Everywhere else a [`Model`] gives it a probability from the
//! voxels around it ([`Window`]): one table ([`fast`]) or a small network with tables beside it
//! ([`dense`]).

mod contexts;
pub mod dense;
pub mod fast;
mod layers;
pub mod scan;
pub(crate) mod slab;
pub mod window;

pub use window::{Model, Window};
