//! Stage 4 of 7, energy: local measures of smoothness of a planar polygon.
//!
//! The energy of a polygon is the sum of ρ over its vertices (equation 5), ρ at a vertex depending
//! on that vertex, its two neighbours and, if a measure wants it, the vertex after the next. Any such
//! measure can be plugged in: implement [`CurveFormula`], and value and exact derivatives follow from
//! the one formula. An [`Energy`] is a weighted sum of measures; those that go by a name, see
//! [`catalogue`], can be written as text.
//!
//! Uses: nothing.

mod angle;
mod bending;
mod catalogue;
mod curvature;
mod custom;
mod knots;
mod length;
mod linear;
mod measures;
mod metric;
mod parameter;
mod scalar;
mod spline;
mod stretch;
mod sum;
mod syntax;
mod variation;

pub use angle::Angle;
pub use bending::Bending;
pub use catalogue::{Entry, catalogue};
pub use curvature::Curvature;
pub use custom::Custom;
pub use length::Length;
pub use linear::Linear;
pub use measures::{measures, with_parameter};
pub use parameter::Parameter;
pub use scalar::{Scalar, Slope};
pub use spline::{SplineEnergy, spline_energy};
pub use stretch::{Stretch, tension};
pub use sum::{Energy, Part};
pub use variation::Variation;

use wide::{f32x8, f64x8};

/// A point in the plane of a curve.
pub type Point2<S = f64> = [S; 2];

/// Numbers of several stencils side by side, for arithmetic on all of them at once.
pub type Lanes<R> = [R; LANES];

/// How many numbers make [`Lanes`].
pub const LANES: usize = 8;

/// Four successive vertices of a planar polygon, each free to move along a line: one stencil, or
/// with `T =` [`Lanes`] eight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stencil<T = f64> {
    /// The previous vertex, the vertex that ρ belongs to, the next one, and the one after that.
    pub points: [Point2<T>; 4],
    /// How each of them moves as its unknown grows.
    pub moves: [Point2<T>; 4],
}

/// Which vertices besides its own a measure looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Support {
    /// The previous and the next one.
    Neighbours,
    /// The previous one and the next two.
    NextTwo,
}

/// ρ at a vertex as a sum of squares, and how it changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term<T = f64> {
    /// `ρ = residual[0]² + residual[1]²`.
    pub residual: [T; 2],
    /// Derivative of each residual with respect to the unknowns of the four vertices.
    pub slope: [[T; 4]; 2],
}

/// A measure ρ of how far a polygon is from smooth at one of its vertices, written as a formula.
///
/// Lengths are in units of the smallest spacing of the volume.
pub trait CurveFormula: Send + Sync {
    /// Two numbers the sum of whose squares is ρ at the second of four successive vertices.
    fn residual<S: Scalar>(&self, points: [Point2<S>; 4]) -> [S; 2];

    /// Which of the four vertices ρ depends on.
    fn support(&self) -> Support {
        Support::Neighbours
    }

    /// What the text of an [`Energy`] calls it, arguments included.
    fn name(&self) -> String {
        "custom".into()
    }

    /// ρ as a sum of squares and its derivatives, each vertex moving along its `moves`.
    ///
    /// The default carries derivatives through [`CurveFormula::residual`]; a formula that has them in
    /// closed form may save time with its own.
    #[inline(always)]
    fn differentiate<S: Scalar>(&self, stencil: Stencil<S>) -> Term<S> {
        let residual = self.residual(stencil.with_slopes());
        Term { residual: residual.map(|r| r.value), slope: residual.map(|r| r.slope) }
    }

    /// Whether ρ is a convex function of the positions: then there is one minimum, and how far off it
    /// is can be told.
    fn is_convex(&self) -> bool {
        false
    }

    /// Whether ρ is 0 on circles of all sizes: then it says nothing of how thick a part one voxel thin is to
    /// be, and there [`Bending`] takes its place.
    fn is_blind_to_circles(&self) -> bool {
        false
    }

    /// The exponent A of the Meusnier weight `(1 − n_p²)^(A/2)`, `n` being the surface normal at the
    /// vertex and `p` the normal of the curve's plane; 0 for none.
    ///
    /// A slice nearly tangent to the surface cuts a strongly curved curve out of a flat surface and
    /// must not count in full. An integrand κᵐ ds weighted with A = 2·m + 1 sums to an integral over
    /// the surface.
    fn meusnier_exponent(&self) -> f64 {
        0.0
    }

    /// The strength c of the barrier `−Σ μ log(4 δ (1 − δ))`, with `μ = min(c·E/N, 0.01)` for energy E
    /// and N vertices, all of them or, on the way to convergence, those around; and more where parts are
    /// thin or faces along the grid flat; 0 for none at all.
    fn barrier(&self) -> f64 {
        0.0
    }
}

/// A [`CurveFormula`] whose type is not known: what the optimisation works with.
pub trait CurveEnergy: Send + Sync {
    /// ρ and its derivatives.
    fn term(&self, stencil: &Stencil) -> Term;
    /// ρ at the second of four successive vertices.
    fn rho(&self, points: &[Point2; 4]) -> f64;
    /// See [`CurveFormula::support`].
    fn support(&self) -> Support;
    /// See [`CurveFormula::name`].
    fn name(&self) -> String;
    /// [`CurveEnergy::term`] of several stencils in single precision.
    fn terms_single(&self, stencils: &Stencil<Lanes<f32>>) -> Term<Lanes<f32>>;
    /// [`CurveEnergy::term`] of several stencils in double precision.
    fn terms_double(&self, stencils: &Stencil<Lanes<f64>>) -> Term<Lanes<f64>>;
    /// See [`CurveFormula::is_convex`].
    fn is_convex(&self) -> bool;
    /// See [`CurveFormula::is_blind_to_circles`].
    fn is_blind_to_circles(&self) -> bool {
        false
    }
    /// See [`CurveFormula::meusnier_exponent`].
    fn meusnier_exponent(&self) -> f64;
    /// See [`CurveFormula::barrier`].
    fn barrier(&self) -> f64;
}

impl<F: CurveFormula> CurveEnergy for F {
    fn term(&self, stencil: &Stencil) -> Term {
        self.differentiate(*stencil)
    }

    fn rho(&self, points: &[Point2; 4]) -> f64 {
        let [a, b] = self.residual(*points);
        a * a + b * b
    }

    fn support(&self) -> Support {
        CurveFormula::support(self)
    }

    fn name(&self) -> String {
        CurveFormula::name(self)
    }

    fn terms_single(&self, stencils: &Stencil<Lanes<f32>>) -> Term<Lanes<f32>> {
        self.differentiate(stencils.map(f32x8::new)).map(|wide| wide.to_array())
    }

    fn terms_double(&self, stencils: &Stencil<Lanes<f64>>) -> Term<Lanes<f64>> {
        self.differentiate(stencils.map(f64x8::new)).map(|wide| wide.to_array())
    }

    fn is_convex(&self) -> bool {
        CurveFormula::is_convex(self)
    }

    fn is_blind_to_circles(&self) -> bool {
        CurveFormula::is_blind_to_circles(self)
    }

    fn meusnier_exponent(&self) -> f64 {
        CurveFormula::meusnier_exponent(self)
    }

    fn barrier(&self) -> f64 {
        CurveFormula::barrier(self)
    }
}

impl<T: Copy> Stencil<T> {
    #[inline(always)]
    fn map<U>(&self, f: impl Fn(T) -> U) -> Stencil<U> {
        let two = |[u, v]: Point2<T>| [f(u), f(v)];
        let four = |[a, b, c, d]: [Point2<T>; 4]| [two(a), two(b), two(c), two(d)];
        Stencil { points: four(self.points), moves: four(self.moves) }
    }
}

impl<S: Scalar> Stencil<S> {
    /// Its points as numbers that carry their derivatives with respect to the four unknowns.
    #[inline(always)]
    fn with_slopes(self) -> [Point2<Slope<S>>; 4] {
        let unknown = |n: usize, k: usize| {
            let mut slope = [S::constant(0.0); 4];
            slope[n] = self.moves[n][k];
            Slope { value: self.points[n][k], slope }
        };
        [0, 1, 2, 3].map(|n| [0, 1].map(|k| unknown(n, k)))
    }
}

impl<T: Copy> Term<T> {
    #[inline(always)]
    fn map<U>(&self, f: impl Fn(T) -> U) -> Term<U> {
        let four = |[a, b, c, d]: [T; 4]| [f(a), f(b), f(c), f(d)];
        let ([p, q], [a, b]) = (self.residual, self.slope);
        Term { residual: [f(p), f(q)], slope: [four(a), four(b)] }
    }
}

/// The vector from `a` to `b`.
#[inline(always)]
fn chord<S: Scalar>(a: Point2<S>, b: Point2<S>) -> Point2<S> {
    [b[0] - a[0], b[1] - a[1]]
}

/// The length of a vector, and 1e-12 instead of 0: then directions and derivatives are finite where
/// vertices coincide. At the lengths that the margin of δ allows it changes no bit.
#[inline(always)]
fn length<S: Scalar>(v: Point2<S>) -> S {
    (v[0] * v[0] + v[1] * v[1] + S::constant(1e-24)).sqrt()
}

#[inline(always)]
fn scaled<S: Scalar>(v: Point2<S>, factor: S) -> Point2<S> {
    [v[0] * factor, v[1] * factor]
}

#[inline(always)]
fn cross<S: Scalar>(a: Point2<S>, b: Point2<S>) -> S {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn dot<S: Scalar>(a: Point2<S>, b: Point2<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}
