//! Squared curvature of the local quadratic: equation 6.

use crate::energy::{CurveFormula, Parameter, Point2, Scalar, Support, cross, dot};

/// ρ = κ² of the parametric quadratic through three vertices (equation 6; the power of the
/// denominator is a misprint there: it is (ẋ² + ẏ²)^(3/2), the whole squared).
///
/// With a uniform parameter a third of the vertices end at their bounds; chord length is the default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Curvature {
    /// How the quadratic is parametrised.
    pub parameter: Parameter,
}

impl CurveFormula for Curvature {
    #[inline]
    fn residual<S: Scalar>(&self, points: [Point2<S>; 4]) -> [S; 2] {
        let [first, second] = self.parameter.derivatives(points);
        // Where a curve turns back onto itself it has no speed; there ρ stays finite.
        let speed_squared = dot(first, first) + S::constant(1e-15);
        [cross(first, second) / (speed_squared * speed_squared.sqrt()), S::constant(0.0)]
    }

    fn support(&self) -> Support {
        self.parameter.support()
    }

    fn name(&self) -> String {
        format!("curvature({})", self.parameter)
    }
}
