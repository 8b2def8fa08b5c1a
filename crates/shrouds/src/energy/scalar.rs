//! Numbers that carry their derivatives, so that a formula is written once.
//!
//! The operations are a few instructions each and must melt into the formula that uses them; left
//! to itself the compiler makes calls of some of them, and a whole run takes a quarter longer.

use std::ops::{Add, Div, Mul, Sub};

use wide::{f32x8, f64x8};

/// What a formula may do with a number.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// A number that does not depend on the vertices.
    fn constant(value: f64) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The angle of the vector (x, self), in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// −1 below 0, else 1.
    fn sign(self) -> Self;
}

impl Scalar for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        // As in the lanes below, and not as the platform rounds it.
        f64x8::splat(self).atan2(f64x8::splat(x)).to_array()[0]
    }
    #[inline(always)]
    fn sign(self) -> Self {
        if self < 0.0 { -1.0 } else { 1.0 }
    }
}

/// Eight numbers at a time, each rounded as it would be alone.
impl Scalar for f64x8 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::splat(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64x8::sqrt(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        f64x8::atan2(self, x)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.simd_lt(Self::ZERO).select(-Self::ONE, Self::ONE)
    }
}

impl Scalar for f32x8 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::splat(value as f32)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32x8::sqrt(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        f32x8::atan2(self, x)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.simd_lt(Self::ZERO).select(-Self::ONE, Self::ONE)
    }
}

/// A value with its derivatives with respect to four unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope<S = f64> {
    /// The value.
    pub value: S,
    /// The four derivatives.
    pub slope: [S; 4],
}

impl<S: Scalar> Slope<S> {
    #[inline(always)]
    fn chain(self, value: S, derivative: S) -> Self {
        Self { value, slope: self.slope.map(|s| s * derivative) }
    }

    #[inline(always)]
    fn combine(self, other: Self, value: S, slope: impl Fn(S, S) -> S) -> Self {
        Self { value, slope: std::array::from_fn(|n| slope(self.slope[n], other.slope[n])) }
    }
}

impl<S: Scalar> Scalar for Slope<S> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value: S::constant(value), slope: [S::constant(0.0); 4] }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, S::constant(0.5) / root)
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        let (y, x) = (self.value, other.value);
        // Finite where both are 0, and elsewhere too little to matter.
        let inverse = S::constant(1.0) / (x * x + y * y + S::constant(1e-36));
        self.combine(other, y.atan2(x), |a, b| (x * a - y * b) * inverse)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        Self { value: self.value.sign(), slope: [S::constant(0.0); 4] }
    }
}

impl<S: Scalar> Add for Slope<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, |a, b| a + b)
    }
}

impl<S: Scalar> Sub for Slope<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, |a, b| a - b)
    }
}

impl<S: Scalar> Mul for Slope<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        self.combine(other, x * y, |a, b| product_rule(x, y, a, b))
    }
}

impl<S: Scalar> Div for Slope<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = S::constant(1.0) / other.value;
        let ratio = self.value * inverse;
        self.combine(other, ratio, |a, b| (a - ratio * b) * inverse)
    }
}

/// The derivative of `x·y` where those of the factors are `a` and `b`.
#[inline(always)]
fn product_rule<S: Scalar>(x: S, y: S, a: S, b: S) -> S {
    a * y + b * x
}
