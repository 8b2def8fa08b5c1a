//! Numbers that carry their derivatives, so that a formula is written once.
//!
//! The operations are a few instructions each and must melt into the formula that uses them; left
//! to itself the compiler makes calls of some of them, and a whole run takes a quarter longer.

use std::ops::{Add, Div, Mul, Sub};

/// What a formula may do with a number.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// A number that does not depend on the vertices.
    fn constant(value: f64) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
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
}

/// A value with its derivatives with respect to three unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// The value.
    pub value: f64,
    /// The three derivatives.
    pub slope: [f64; 3],
}

impl Slope {
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: self.slope.map(|s| s * derivative) }
    }

    #[inline(always)]
    fn combine(self, other: Self, value: f64, by_self: f64, by_other: f64) -> Self {
        let slope = std::array::from_fn(|n| self.slope[n] * by_self + other.slope[n] * by_other);
        Self { value, slope }
    }
}

impl Scalar for Slope {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; 3] }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
}

impl Add for Slope {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}

impl Sub for Slope {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}

impl Mul for Slope {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl Div for Slope {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let ratio = self.value * inverse;
        self.combine(other, ratio, inverse, -ratio * inverse)
    }
}
