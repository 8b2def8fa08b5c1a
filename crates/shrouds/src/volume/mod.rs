//! Stage 1 of 7, volume: in values on a lattice, out one bit per lattice point.
//!
//! The paper calls the set of inside lattice points an *enumerated volume* and its bits the
//! *occupancy array* (section 4.3). Uses: `grid`.

mod convention;
mod fill;
mod occupancy;
mod pack;
pub mod phantom;
mod select;

pub use convention::{Border, FaceRule};
pub use fill::Filler;
pub use occupancy::Occupancy;
pub use select::{Select, Voxel};
