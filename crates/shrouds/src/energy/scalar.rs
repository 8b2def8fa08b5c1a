//! Numbers that carry their derivatives, so that a formula is written once.

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
    fn constant(value: f64) -> Self {
        value
    }
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
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: self.slope.map(|s| s * derivative) }
    }

    fn combine(self, other: Self, value: f64, by_self: f64, by_other: f64) -> Self {
        let slope = std::array::from_fn(|n| self.slope[n] * by_self + other.slope[n] * by_other);
        Self { value, slope }
    }
}

impl Scalar for Slope {
    fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; 3] }
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
}

impl Add for Slope {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}

impl Sub for Slope {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}

impl Mul for Slope {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl Div for Slope {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let ratio = self.value * inverse;
        self.combine(other, ratio, inverse, -ratio * inverse)
    }
}
