//! Where on [0, 1] the middle vertex of a parametric quadratic lies.

use std::fmt;

use crate::energy::{Point2, Scalar, Support, chord, cross, dot, length, metric};

/// How the parameter t of the middle one of three vertices is chosen; the others are at 0 and 1
/// (paper, after equation 7, which leaves the choice open).
///
/// All but [`Parameter::Affine`] choose the same t for a curve and its reflected, turned and scaled
/// images, and 1 − t for the curve traversed the other way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Parameter {
    /// t = ½.
    Uniform,
    /// t divides [0, 1] like the lengths of the two chords.
    #[default]
    Chord,
    /// t divides [0, 1] like the square roots of those lengths.
    Centripetal,
    /// t divides [0, 1] like the lengths of the chords in Nielson's metric, the inverse of the
    /// covariance of the points: the same for every affine image of them, so for every spacing.
    ///
    /// All triangles are affine images of each other, so three vertices alone would leave only
    /// t = ½. The covariance here is that of the vertex, its neighbours and the vertex after the
    /// next; traversed the other way a curve has another t. Points that a strip a hundred times as
    /// long as wide could hold have no usable covariance: the flatter they are beyond that, the more
    /// t is that of [`Parameter::Chord`], which on a straight line is affinely invariant too.
    Affine,
    /// t divides [0, 1] like the lengths of the chords, each made longer where the curve turns: Foley
    /// and Nielson's knots for a polygon of three vertices, with lengths and angle as seen. Between
    /// [`Parameter::Chord`] on straight lines and nearly [`Parameter::Uniform`] at sharp corners.
    Foley,
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Parameter {
    /// Every one of them.
    pub const ALL: [Self; 5] =
        [Self::Uniform, Self::Chord, Self::Centripetal, Self::Affine, Self::Foley];

    /// What the text of an [`Energy`](crate::energy::Energy) calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Chord => "chord",
            Self::Centripetal => "centripetal",
            Self::Affine => "affine",
            Self::Foley => "foley",
        }
    }

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// The parameter of the second of four successive vertices, the first being at 0 and the third at
    /// 1. Only [`Parameter::Affine`] looks at the fourth.
    ///
    /// Where both chords are much shorter than 1e-12 it is ½.
    #[inline]
    pub fn of_middle<S: Scalar>(self, points: [Point2<S>; 4]) -> S {
        self.shares(points)[0]
    }

    /// The parameter and what remains to 1, each with all its digits.
    #[inline]
    fn shares<S: Scalar>(self, points: [Point2<S>; 4]) -> [S; 2] {
        let (before, after) = (chord(points[0], points[1]), chord(points[1], points[2]));
        let of = |a: S, b: S| [a / (a + b), b / (a + b)];
        match self {
            Self::Uniform => [S::constant(0.5); 2],
            Self::Chord => of(length(before), length(after)),
            Self::Centripetal => of(length(before).sqrt(), length(after).sqrt()),
            Self::Affine => {
                let centred = metric::centred(points);
                of(metric::length(&centred, before), metric::length(&centred, after))
            }
            Self::Foley => {
                let (l0, l1) = (length(before), length(after));
                let angle = bounded_turning(before, after);
                of(l0 + l0 * lengthening(angle, l0, l1), l1 + l1 * lengthening(angle, l1, l0))
            }
        }
    }

    /// Which vertices the parameter depends on.
    #[inline]
    pub(super) fn support(self) -> Support {
        match self {
            Self::Affine => Support::NextTwo,
            _ => Support::Neighbours,
        }
    }

    /// First and second derivative at the second of four successive vertices of the quadratic through
    /// the first three.
    ///
    /// With divided differences `a = (P₁ − P₀)/t` and `b = (P₂ − P₁)/(1 − t)` they are
    /// `(1 − t)·a + t·b` and `2·(b − a)`.
    #[inline]
    pub(super) fn derivatives<S: Scalar>(self, points: [Point2<S>; 4]) -> [Point2<S>; 2] {
        let (before, after) = (chord(points[0], points[1]), chord(points[1], points[2]));
        let [t, rest] = self.shares(points);
        let first = [0, 1].map(|k| before[k] / t * rest + after[k] / rest * t);
        let second = [0, 1].map(|k| S::constant(2.0) * (after[k] / rest - before[k] / t));
        [first, second]
    }
}

/// The turning angle between two chords without its sign, at most a right angle: Foley's θ̂.
#[inline(always)]
pub(super) fn bounded_turning<S: Scalar>(before: Point2<S>, after: Point2<S>) -> S {
    let turning = cross(before, after).atan2(dot(before, after));
    let angle = turning * turning.sign();
    // The smaller of two numbers.
    let excess = angle - S::constant(std::f64::consts::FRAC_PI_2);
    angle - S::constant(0.5) * (excess + excess * excess.sign())
}

/// What part of its length `l` a chord gains in Foley's knots where the curve turns by `angle` to one
/// of length `beside`.
#[inline(always)]
pub(super) fn lengthening<S: Scalar>(angle: S, l: S, beside: S) -> S {
    S::constant(1.5) * angle * beside / (l + beside)
}
