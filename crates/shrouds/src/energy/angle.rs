//! The angle at a vertex, whatever the lengths beside it.

use crate::energy::{CurveFormula, Point2, Scalar, chord, cross, dot, length, scaled};

/// ρ of the turning angle θ = π − φ, φ being the angle P₀P₁P₂: the paper's ad hoc schemes.
///
/// They count how much a polygon turns at its vertices and not over what length: a curve cut into more
/// vertices costs less.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Angle {
    /// ρ = θ².
    #[default]
    Squared,
    /// ρ = 1 + cos φ = |T⁺ − T⁻|²/2, T± being the unit directions of the two chords: at most 2, and
    /// half of θ² where the curve turns little.
    Cosine,
}

impl CurveFormula for Angle {
    #[inline]
    fn residual<S: Scalar>(&self, [a, b, c, _]: [Point2<S>; 4]) -> [S; 2] {
        let (before, after) = (chord(a, b), chord(b, c));
        match self {
            Self::Squared => [cross(before, after).atan2(dot(before, after)), S::constant(0.0)],
            Self::Cosine => {
                let root = S::constant(std::f64::consts::FRAC_1_SQRT_2);
                let [u, v] = [before, after].map(|chord| scaled(chord, root / length(chord)));
                chord(u, v)
            }
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Squared => "angle(squared)".into(),
            Self::Cosine => "angle(cosine)".into(),
        }
    }
}
