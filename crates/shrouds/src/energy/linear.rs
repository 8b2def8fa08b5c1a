//! Squared second derivative of the local quadratic: equation 7.

use crate::energy::{CurveFormula, Parameter, Point2, Scalar, Support};

/// ρ = ẍ² + ÿ² of the parametric quadratic through three vertices (equation 7), the linearised
/// curvature of splines.
///
/// With a uniform parameter, the default, it is `16·|P₀ − 2·P₁ + P₂|²`: a convex function of δ whose
/// minimum is unique, but one that does not leave unevenly spaced vertices on a line in peace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Linear {
    /// How the quadratic is parametrised.
    pub parameter: Parameter,
}

impl Default for Linear {
    fn default() -> Self {
        Self { parameter: Parameter::Uniform }
    }
}

impl CurveFormula for Linear {
    #[inline]
    fn residual<S: Scalar>(&self, points: [Point2<S>; 4]) -> [S; 2] {
        let [_, second] = self.parameter.derivatives(points);
        second
    }

    fn support(&self) -> Support {
        self.parameter.support()
    }

    fn name(&self) -> String {
        format!("linear({})", self.parameter)
    }

    fn is_convex(&self) -> bool {
        self.parameter == Parameter::Uniform
    }
}
