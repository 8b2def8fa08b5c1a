//! Variation: how much the curvature changes along the curve.

use crate::energy::{
    CurveFormula, Point2, Scalar, Stencil, Support, Term, chord, cross, dot, length, scaled,
};

/// `ρ = (κ₁ − κ₀)²·l̄`, κ₀ and κ₁ being the turning per length at a vertex and the next one,
/// `2·θ/(l⁻ + l⁺)`, and l̄ the mean length of the three chords: a discrete `∫(dκ/ds)² ds`, 0 on circles.
///
/// It is multiplied by a length where the difference quotient asks for a division by one: so vertices
/// that crowd together count little. The Meusnier exponent 7 makes the sum over all slices an integral
/// over the surface. Flat valleys and other local minima surround its minimum; start it from that of
/// [`Bending`](crate::energy::Bending).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Variation;

impl CurveFormula for Variation {
    #[inline(always)]
    fn residual<S: Scalar>(&self, [a, b, c, d]: [Point2<S>; 4]) -> [S; 2] {
        let chords = [chord(a, b), chord(b, c), chord(c, d)];
        let [l0, l1, l2] = chords.map(length);
        let turning = |u, v| S::atan2(cross(u, v), dot(u, v));
        let two = S::constant(2.0);
        let before = two * turning(chords[0], chords[1]) / (l0 + l1);
        let after = two * turning(chords[1], chords[2]) / (l1 + l2);
        let mean = (l0 + l1 + l2) * S::constant(1.0 / 3.0);
        [(after - before) * mean.sqrt(), S::constant(0.0)]
    }

    #[inline(always)]
    fn differentiate<S: Scalar>(&self, stencil: Stencil<S>) -> Term<S> {
        let [a, b, c, d] = stencil.points;
        let chords = [chord(a, b), chord(b, c), chord(c, d)];
        let [l0, l1, l2] = chords.map(length);
        let one = S::constant(1.0);
        let inverse = [one / l0, one / l1, one / l2];
        let directions = [0, 1, 2].map(|n| scaled(chords[n], inverse[n]));
        let turning = |u, v| S::atan2(cross(u, v), dot(u, v));
        let two = S::constant(2.0);
        // Curvatures are turnings by these.
        let (by0, by1) = (two / (l0 + l1), two / (l1 + l2));
        let before = turning(directions[0], directions[1]) * by0;
        let after = turning(directions[1], directions[2]) * by1;
        let root = ((l0 + l1 + l2) * S::constant(1.0 / 3.0)).sqrt();
        let residual = (after - before) * root;
        // What the residual gains for each unit that a chord turns, and that it grows.
        let by_turning = [by0 * root, S::constant(0.0) - (by0 + by1) * root, by1 * root];
        let half = S::constant(0.5) * root;
        let (shrink0, shrink1) = (before * by0 * half, after * by1 * half);
        let longer = residual / (S::constant(6.0) * root * root);
        let by_growing = [longer + shrink0, longer + shrink0 - shrink1, longer - shrink1];
        let by_chord = |n: usize, m: Point2<S>| {
            by_turning[n] * cross(directions[n], m) * inverse[n]
                + by_growing[n] * dot(directions[n], m)
        };
        let [m0, m1, m2, m3] = stencil.moves;
        let zero = S::constant(0.0);
        let slope = [
            zero - by_chord(0, m0),
            by_chord(0, m1) - by_chord(1, m1),
            by_chord(1, m2) - by_chord(2, m2),
            by_chord(2, m3),
        ];
        Term { residual: [residual, zero], slope: [slope, [zero; 4]] }
    }

    fn support(&self) -> Support {
        Support::NextTwo
    }

    fn is_blind_to_circles(&self) -> bool {
        true
    }

    fn meusnier_exponent(&self) -> f64 {
        7.0
    }

    fn barrier(&self) -> f64 {
        1.0
    }

    fn name(&self) -> String {
        "variation".into()
    }
}
