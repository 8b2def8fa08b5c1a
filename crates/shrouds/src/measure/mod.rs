//! Stage 7 of 7, measure: in placed vertices and their network, or any mesh, out what can be said
//! about the surface.
//!
//! Uses: `grid`, `surface`, `network`, `mesh`.

mod contours;
mod curvature;
mod fairness;
mod integrals;
mod planes;

pub use contours::{Contour, contours, network_contours};
pub use curvature::{Curvature, curvatures};
pub use fairness::{Fairness, fairness};
pub use integrals::{Integrals, PrincipalAxes, integrals};
pub use planes::Planes;
