//! Stage 7 of 7, measure: in placed vertices and their network, or any mesh, out what can be said
//! about the surface.
//!
//! Uses: `grid`, `surface`, `network`, `mesh`, `tree`.

mod clip;
mod contours;
mod curvature;
mod distance;
mod fairness;
mod integrals;
mod nearest;
mod planes;
mod samples;
mod thickness;

pub use clip::area_within;
pub use contours::{Contour, contours, network_contours};
pub use curvature::{Curvature, curvatures};
pub use distance::{Distances, SurfaceDistances, surface_distances};
pub use fairness::{Fairness, fairness};
pub use integrals::{Integrals, PrincipalAxes, integrals};
pub use planes::Planes;
pub use thickness::{Thickness, thickness};
