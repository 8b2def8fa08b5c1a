//! Bending: a discrete ∫κ² ds that straight lines leave at 0 however their vertices are spaced.

use crate::energy::{CurveFormula, Point2, Scalar, chord, length, scaled};

/// ρ = |T⁺ − T⁻|² / ((l⁻ + l⁺)/2), T± being the unit directions and l± the lengths of the two chords:
/// the default energy.
///
/// The vector form has fewer local minima than one in the turning angle. The Meusnier exponent 5
/// makes the sum over all slices an integral over the surface; the weak barrier keeps thin parts
/// alive and vertices off the lattice points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Bending;

impl CurveFormula for Bending {
    #[inline]
    fn residual<S: Scalar>(&self, points: [Point2<S>; 3]) -> [S; 2] {
        let (before, after) = (chord(points[0], points[1]), chord(points[1], points[2]));
        let (l0, l1) = (length(before), length(after));
        let one = S::constant(1.0);
        let (u0, u1) = (scaled(before, one / l0), scaled(after, one / l1));
        let root = (S::constant(2.0) / (l0 + l1)).sqrt();
        scaled(chord(u0, u1), root)
    }

    fn meusnier_exponent(&self) -> f64 {
        5.0
    }

    fn barrier(&self) -> f64 {
        0.1
    }
}
