//! The two precisions that the optimisation can work in.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f32x8, f64x8};

use crate::energy::{CurveEnergy, Lanes, Stencil, Term};
use crate::optimize::progress::Values;

/// `f32` or `f64`, with what the solver does with them.
pub(crate) trait Real:
    Copy
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
{
    fn from_f64(value: f64) -> Self;
    fn from_i32(value: i32) -> Self;
    fn to_f64(self) -> f64;
    fn sqrt(self) -> Self;
    fn terms(energy: &dyn CurveEnergy, stencils: &Stencil<Lanes<Self>>) -> Term<Lanes<Self>>;
    /// The weighted sum of the scalar products of vectors in the plane.
    fn weighted_sum(weights: &Lanes<Self>, u: [&Lanes<Self>; 2], v: [&Lanes<Self>; 2]) -> f64;
    fn values(values: &[Self]) -> Values<'_>;
}

impl Real for f32 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        value as Self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn terms(energy: &dyn CurveEnergy, stencils: &Stencil<Lanes<Self>>) -> Term<Lanes<Self>> {
        energy.terms_single(stencils)
    }
    #[inline(always)]
    fn weighted_sum(weights: &Lanes<Self>, u: [&Lanes<Self>; 2], v: [&Lanes<Self>; 2]) -> f64 {
        let ([p, q], [a, b]) = (u.map(|u| f32x8::new(*u)), v.map(|v| f32x8::new(*v)));
        let products = f32x8::new(*weights) * (p * a + q * b);
        products.to_array().into_iter().map(f64::from).sum()
    }
    fn values(values: &[Self]) -> Values<'_> {
        Values::Single(values)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        f64::from(value)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn terms(energy: &dyn CurveEnergy, stencils: &Stencil<Lanes<Self>>) -> Term<Lanes<Self>> {
        energy.terms_double(stencils)
    }
    #[inline(always)]
    fn weighted_sum(weights: &Lanes<Self>, u: [&Lanes<Self>; 2], v: [&Lanes<Self>; 2]) -> f64 {
        let ([p, q], [a, b]) = (u.map(|u| f64x8::new(*u)), v.map(|v| f64x8::new(*v)));
        (f64x8::new(*weights) * (p * a + q * b)).reduce_add()
    }
    fn values(values: &[Self]) -> Values<'_> {
        Values::Double(values)
    }
}
