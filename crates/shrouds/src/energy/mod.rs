//! Stage 4 of 7, energy: local measures of smoothness of a planar polygon.
//!
//! The energy of a polygon is the sum of ρ over its vertices (equation 5), ρ at a vertex depending
//! on that vertex and its two neighbours. Any such measure can be plugged in: implement
//! [`CurveFormula`], and value and exact derivatives follow from the one formula.
//!
//! Uses: nothing.

mod bending;
mod curvature;
mod linear;
mod parameter;
mod scalar;

pub use bending::Bending;
pub use curvature::Curvature;
pub use linear::Linear;
pub use parameter::Parameter;
pub use scalar::{Scalar, Slope};

use wide::f64x4;

/// A point in the plane of a curve.
pub type Point2<S = f64> = [S; 2];

/// Numbers of several stencils side by side, for arithmetic on all of them at once.
pub type Lanes = [f64; 4];

/// Three successive vertices of a planar polygon, each free to move along a line: one stencil, or
/// with `T =` [`Lanes`] four.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stencil<T = f64> {
    /// The previous vertex, the vertex that ρ belongs to, and the next one.
    pub points: [Point2<T>; 3],
    /// How each of them moves as its unknown grows.
    pub moves: [Point2<T>; 3],
}

/// ρ at a vertex as a sum of squares, and how it changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term<T = f64> {
    /// `ρ = residual[0]² + residual[1]²`.
    pub residual: [T; 2],
    /// Derivative of each residual with respect to the unknowns of the three vertices.
    pub slope: [[T; 3]; 2],
}

/// A measure ρ of how far a polygon is from smooth at one of its vertices, written as a formula.
///
/// Lengths are in units of the smallest spacing of the volume.
pub trait CurveFormula: Send + Sync {
    /// Two numbers the sum of whose squares is ρ at the middle one of three successive vertices.
    fn residual<S: Scalar>(&self, points: [Point2<S>; 3]) -> [S; 2];

    /// The exponent A of the Meusnier weight `(1 − n_p²)^(A/2)`, `n` being the surface normal at the
    /// vertex and `p` the normal of the curve's plane; 0 for none.
    ///
    /// A slice nearly tangent to the surface cuts a strongly curved curve out of a flat surface and
    /// must not count in full. An integrand κᵐ ds weighted with A = 2·m + 1 sums to an integral over
    /// the surface.
    fn meusnier_exponent(&self) -> f64 {
        0.0
    }

    /// The strength c of the barrier `−μ Σ log(4 δ (1 − δ))`, with `μ = min(c·E/N, 0.01)` for energy
    /// E and N vertices; 0 for none.
    fn barrier(&self) -> f64 {
        0.0
    }
}

/// A [`CurveFormula`] whose type is not known: what the optimisation works with.
pub trait CurveEnergy: Send + Sync {
    /// ρ and its derivatives.
    fn term(&self, stencil: &Stencil) -> Term;
    /// ρ and its derivatives at four stencils.
    fn terms(&self, stencils: &Stencil<Lanes>) -> Term<Lanes>;
    /// ρ at the middle one of three successive vertices.
    fn rho(&self, points: &[Point2; 3]) -> f64;
    /// ρ at four stencils.
    fn rhos(&self, points: &[Point2<Lanes>; 3]) -> Lanes;
    /// See [`CurveFormula::meusnier_exponent`].
    fn meusnier_exponent(&self) -> f64;
    /// See [`CurveFormula::barrier`].
    fn barrier(&self) -> f64;
}

impl<F: CurveFormula> CurveEnergy for F {
    fn term(&self, stencil: &Stencil) -> Term {
        differentiate(self, stencil.points, stencil.moves)
    }

    fn terms(&self, stencils: &Stencil<Lanes>) -> Term<Lanes> {
        let load = |points: [Point2<Lanes>; 3]| points.map(|p| p.map(f64x4::from));
        let term = differentiate(self, load(stencils.points), load(stencils.moves));
        Term {
            residual: term.residual.map(f64x4::to_array),
            slope: term.slope.map(|slopes| slopes.map(f64x4::to_array)),
        }
    }

    fn rho(&self, points: &[Point2; 3]) -> f64 {
        sum_of_squares(self.residual(*points))
    }

    fn rhos(&self, points: &[Point2<Lanes>; 3]) -> Lanes {
        sum_of_squares(self.residual(points.map(|p| p.map(f64x4::from)))).to_array()
    }

    fn meusnier_exponent(&self) -> f64 {
        CurveFormula::meusnier_exponent(self)
    }

    fn barrier(&self) -> f64 {
        CurveFormula::barrier(self)
    }
}

/// The residuals of three vertices with their derivatives along the vertices' moves.
#[inline(always)]
fn differentiate<S: Scalar>(
    formula: &impl CurveFormula,
    points: [Point2<S>; 3],
    moves: [Point2<S>; 3],
) -> Term<S> {
    let unknown = |n: usize, k: usize| {
        let mut slope = [S::constant(0.0); 3];
        slope[n] = moves[n][k];
        Slope { value: points[n][k], slope }
    };
    let residual = formula.residual([0, 1, 2].map(|n| [0, 1].map(|k| unknown(n, k))));
    Term { residual: residual.map(|r| r.value), slope: residual.map(|r| r.slope) }
}

#[inline(always)]
fn sum_of_squares<S: Scalar>([a, b]: [S; 2]) -> S {
    a * a + b * b
}

/// The vector from `a` to `b`.
#[inline(always)]
fn chord<S: Scalar>(a: Point2<S>, b: Point2<S>) -> Point2<S> {
    [b[0] - a[0], b[1] - a[1]]
}

#[inline(always)]
fn length<S: Scalar>(v: Point2<S>) -> S {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

#[inline(always)]
fn scaled<S: Scalar>(v: Point2<S>, factor: S) -> Point2<S> {
    [v[0] * factor, v[1] * factor]
}

#[inline(always)]
fn cross<S: Scalar>(a: Point2<S>, b: Point2<S>) -> S {
    a[0] * b[1] - a[1] * b[0]
}
