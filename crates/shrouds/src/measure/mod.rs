//! Stage 7 of 7, measure: in placed vertices and their network, out what can be said about the
//! surface.
//!
//! Uses: `network`, `mesh`.

mod curvature;
mod integrals;

pub use curvature::{Curvature, curvatures};
pub use integrals::{Integrals, PrincipalAxes, integrals};
