//! Stage 7 of 7, measure: in placed vertices and their network, out what can be said about the
//! surface.
//!
//! Uses: `network`.

mod curvature;

pub use curvature::{Curvature, curvatures};
