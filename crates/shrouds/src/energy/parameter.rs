//! Where on [0, 1] the middle vertex of a parametric quadratic lies.

use std::fmt;

use crate::energy::{Point2, Scalar, chord, length};

/// How the parameter t of the middle one of three vertices is chosen; the others are at 0 and 1
/// (paper, after equation 7, which leaves the choice open).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Parameter {
    /// t = ½.
    Uniform,
    /// t divides [0, 1] like the lengths of the two chords.
    #[default]
    Chord,
    /// t divides [0, 1] like the square roots of those lengths.
    Centripetal,
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Parameter {
    /// Every one of them.
    pub const ALL: [Self; 3] = [Self::Uniform, Self::Chord, Self::Centripetal];

    /// What the text of an [`Energy`](crate::energy::Energy) calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Chord => "chord",
            Self::Centripetal => "centripetal",
        }
    }

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    #[inline]
    fn of_middle<S: Scalar>(self, before: Point2<S>, after: Point2<S>) -> S {
        let share = |a: S, b: S| a / (a + b);
        match self {
            Self::Uniform => S::constant(0.5),
            Self::Chord => share(length(before), length(after)),
            Self::Centripetal => share(length(before).sqrt(), length(after).sqrt()),
        }
    }

    /// First and second derivative at the middle vertex of the quadratic through three vertices.
    ///
    /// With divided differences `a = (P₁ − P₀)/t` and `b = (P₂ − P₁)/(1 − t)` they are
    /// `(1 − t)·a + t·b` and `2·(b − a)`.
    #[inline]
    pub(super) fn derivatives<S: Scalar>(self, points: [Point2<S>; 3]) -> [Point2<S>; 2] {
        let (before, after) = (chord(points[0], points[1]), chord(points[1], points[2]));
        let t = self.of_middle(before, after);
        let rest = S::constant(1.0) - t;
        let first = [0, 1].map(|k| before[k] / t * rest + after[k] / rest * t);
        let second = [0, 1].map(|k| S::constant(2.0) * (after[k] / rest - before[k] / t));
        [first, second]
    }
}
