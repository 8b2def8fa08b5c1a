//! Stage 1 of 7, volume: in values on a lattice, out one bit per lattice point.
//!
//! The paper calls the set of inside lattice points an *enumerated volume* and its bits the
//! *occupancy array* (section 4.3). Operations on such volumes come after it: Boolean ones, offsets,
//! connected components and what follows from them, other lattices. Uses: `grid`.

mod convention;
mod fill;
mod occupancy;
mod pack;
mod runs;
pub mod phantom;
mod select;
mod combine;
mod window;
mod flips;
mod reach;
mod offset;
mod components;
mod clean;
mod resample;
mod halve;

pub use clean::Cleaned;
pub use combine::Operation;
pub use components::Components;
pub use convention::{Border, FaceRule};
pub use fill::Filler;
pub(crate) use flips::Flips;
pub use occupancy::Occupancy;
pub use resample::Interpolation;
pub use select::{Select, Voxel};
