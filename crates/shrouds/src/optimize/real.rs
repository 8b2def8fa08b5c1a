//! The two precisions that the optimisation can work in.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::energy::{CurveEnergy, Lanes, Stencil, Term};

/// `f32` or `f64`, with what the solver does with them.
pub(super) trait Real:
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
}
