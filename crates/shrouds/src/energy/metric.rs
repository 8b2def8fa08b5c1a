//! Nielson's affinely invariant metric: lengths measured by the inverse covariance of a set of points.

use crate::energy::{Point2, Scalar, chord, cross, dot};

/// Part of the ordinary metric that is mixed in, so that points on a line have a length too.
pub(super) const ORDINARY: f64 = 1e-4;

/// Points as seen from their mean.
#[inline(always)]
pub(super) fn centred<S: Scalar>(points: [Point2<S>; 4]) -> [Point2<S>; 4] {
    let [a, b, c, d] = points;
    let mean = [0, 1].map(|k| S::constant(0.25) * (a[k] + b[k] + c[k] + d[k]));
    points.map(|p| chord(mean, p))
}

/// The length of a vector in the metric of centred points, times a factor that is the same for all
/// vectors.
///
/// The inverse of the covariance times its determinant needs no division, so that it exists on a line
/// as well; as a sum of squares, `Σ (v × p)²`, it loses no digits near one.
#[inline(always)]
pub(super) fn length<S: Scalar>(centred: &[Point2<S>; 4], v: Point2<S>) -> S {
    let sum = |[a, b, c, d]: [S; 4]| (a + b) + (c + d);
    let inverse = sum(centred.map(|p| cross(v, p) * cross(v, p)));
    let size = sum(centred.map(|p| dot(p, p)));
    (inverse + S::constant(ORDINARY) * dot(v, v) * size + S::constant(1e-24)).sqrt()
}
