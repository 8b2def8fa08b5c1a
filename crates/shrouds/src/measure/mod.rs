//! Stage 7 of 7, measure: in placed vertices and their network, or any mesh, out what can be said
//! about the surface.
//!
//! Uses: `grid`, `volume` (its border), `surface`, `network`, `mesh`, `tree`.

mod bounds;
mod clip;
mod contours;
mod curvature;
mod curvature_areas;
mod distance;
mod fairness;
mod integrals;
mod nearest;
mod planes;
mod samples;
mod shape_operator;
mod smooth;
mod stars;
mod thickness;
mod uncertainty;

pub use clip::area_within;
pub use contours::{Contour, contours, network_contours};
pub use curvature::{Curvature, curvatures, mesh_curvatures};
pub use curvature_areas::{CurvatureAreas, SignAreas, curvature_areas, flat_threshold};
pub use distance::{Distances, SurfaceDistances, surface_distances};
pub use fairness::{Fairness, fairness};
pub use integrals::{Integrals, PrincipalAxes, integrals};
pub use planes::Planes;
pub use smooth::smooth_integrals;
pub use thickness::{Thickness, thickness};
pub use uncertainty::{Span, Uncertainty, calibrated_error, uncertainty};
