//! Length of the curve.

use crate::energy::{CurveFormula, Point2, Scalar, chord, length, scaled};

/// ρ = |P₂ − P₁|, the chord after the vertex: the sum is the length of the polygon.
///
/// The residual is the chord over the root of its length. As a vector it knows that a chord resists
/// turning, and its Gauss–Newton model lies above the energy. With the Meusnier exponent 1 the sum over
/// all slices is twice the area of the surface. Nothing holds a thin part against it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Length;

impl CurveFormula for Length {
    #[inline]
    fn residual<S: Scalar>(&self, [_, b, c, _]: [Point2<S>; 4]) -> [S; 2] {
        let after = chord(b, c);
        scaled(after, S::constant(1.0) / length(after).sqrt())
    }

    fn meusnier_exponent(&self) -> f64 {
        1.0
    }

    fn name(&self) -> String {
        "length".into()
    }

    fn is_convex(&self) -> bool {
        true
    }
}
