//! After the stages: where a target can be, from what a towed array has heard of it (section 4.5).
//!
//! In: a [`Scene`], the sea on a lattice with its floor and its speed of sound, the way of the array, and
//! what was heard when. Out: for every [`Contact`] a [`Step`] with the region that the target cannot have
//! left. Between two contacts the region grows by the way the target can have gone; then it loses
//! what does not agree with the new contact. Uses: `grid`, `volume`.
//!
//! Lengths are in metres, times in seconds, angles in degrees. The axes of the world are x east, y
//! north, z up, with z = 0 at the surface of the sea; a *depth* is −z. A *course* is counted from north
//! over east. The *bearing* of a contact is the angle between the array's axis and the direction from
//! which sound arrives: an array of hydrophones in a line hears that angle and nothing else, so that the
//! target lies on a cone around the axis, or, as the angle has an error, between two.
//!
//! Sound travels in vertical planes (each sees the floor below it, and its slope along the plane; what
//! slopes across the plane turns nothing). In water of constant speed over a level floor its ways are straight
//! lines, and those of a bottom bounce come straight from the mirror image of the target; then regions are
//! those of formulas. Everywhere else rays are traced from the array, see `fan`.

mod annulus;
mod cells;
mod contact;
mod fan;
mod floor;
mod ray;
mod scene;
mod sea;
mod sound;
mod step;
mod straight;
mod stretches;
mod terrain;
mod track;

pub use contact::{Contact, Path};
pub use floor::{Depths, Floor};
pub use scene::Scene;
pub use sea::Sea;
pub use sound::SoundSpeed;
pub use step::{Extent, Membership, Step, Steps};
pub use terrain::Terrain;
pub use track::{Array, Track, Waypoint};
