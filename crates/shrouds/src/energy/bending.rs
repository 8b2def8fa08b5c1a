//! Bending: a discrete ∫κ² ds that straight lines leave at 0 however their vertices are spaced.

use crate::energy::{CurveFormula, Point2, Scalar, Stencil, Term, chord, length, scaled};

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
    fn residual<S: Scalar>(&self, [a, b, c, _]: [Point2<S>; 4]) -> [S; 2] {
        let (before, after) = (chord(a, b), chord(b, c));
        let (l0, l1) = (length(before), length(after));
        let one = S::constant(1.0);
        let (u0, u1) = (scaled(before, one / l0), scaled(after, one / l1));
        let root = (S::constant(2.0) / (l0 + l1)).sqrt();
        scaled(chord(u0, u1), root)
    }

    #[inline(always)]
    fn differentiate<S: Scalar>(&self, stencil: Stencil<S>) -> Term<S> {
        let [a, b, c, _] = stencil.points;
        let (before, after) = (chord(a, b), chord(b, c));
        let one = S::constant(1.0);
        let (l0, l1) = (length(before), length(after));
        let (inverse0, inverse1, mean) = (one / l0, one / l1, S::constant(2.0) / (l0 + l1));
        let (u0, u1) = (scaled(before, inverse0), scaled(after, inverse1));
        let root = mean.sqrt();
        let residual = scaled(chord(u0, u1), root);
        // When a chord with direction u and length l changes by m, u changes by (m − (u·m)·u)/l and
        // the root by −(u·m)·mean/4 of itself.
        let quarter = S::constant(0.25) * mean;
        let turn = |u: Point2<S>, inverse: S, m: Point2<S>| {
            let stretch = u[0] * m[0] + u[1] * m[1];
            let factor = root * inverse;
            ([0, 1].map(|k| (m[k] - stretch * u[k]) * factor), stretch * quarter)
        };
        let by_before = |m| {
            let (turned, shrunk) = turn(u0, inverse0, m);
            [0, 1].map(|k| turned[k] + residual[k] * shrunk)
        };
        let by_after = |m| {
            let (turned, shrunk) = turn(u1, inverse1, m);
            [0, 1].map(|k| turned[k] - residual[k] * shrunk)
        };
        let [m0, m1, m2, _] = stencil.moves;
        let (first, last) = (by_before(m0), by_after(m2));
        let (back, forth) = (by_before(m1), by_after(m1));
        let zero = S::constant(0.0);
        let slope = [0, 1].map(|k| [first[k], zero - back[k] - forth[k], last[k], zero]);
        Term { residual, slope }
    }

    fn meusnier_exponent(&self) -> f64 {
        5.0
    }

    fn barrier(&self) -> f64 {
        0.1
    }

    fn name(&self) -> String {
        "bending".into()
    }
}
