//! Stage 7 of 7, measure: in placed vertices and their network, or any mesh, out what can be said
//! about the surface.
//!
//! Uses: `grid`, `volume` (its border), `surface`, `network`, `mesh`.

mod bounds;
mod contours;
mod curvature;
mod curvature_areas;
mod fairness;
mod integrals;
mod planes;
mod shape_operator;
mod smooth;
mod stars;
mod uncertainty;

pub use contours::{Contour, contours, network_contours};
pub use curvature::{Curvature, curvatures, mesh_curvatures};
pub use curvature_areas::{CurvatureAreas, SignAreas, curvature_areas, flat_threshold};
pub use fairness::{Fairness, fairness};
pub use integrals::{Integrals, PrincipalAxes, integrals};
pub use planes::Planes;
pub use smooth::smooth_integrals;
pub use uncertainty::{Span, Uncertainty, calibrated_error, uncertainty};
