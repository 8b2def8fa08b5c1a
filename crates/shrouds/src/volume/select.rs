//! Which values of an array count as inside.

use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// A rule that says which voxel values are inside.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Select {
    /// Every value but 0.
    #[default]
    NonZero,
    /// The values that equal one of these labels.
    Labels(Vec<i128>),
    /// The values strictly above this one.
    Above(f64),
}

/// A type of voxel values: `bool`, any integer or any float.
pub trait Voxel: Copy + Sync {
    /// The value as a float, rounded where it does not fit.
    fn as_f64(self) -> f64;
    /// The value as a label, if it is a whole number.
    fn as_label(self) -> Option<i128>;
}

macro_rules! integer_voxel {
    ($($type:ty),*) => {$(
        impl Voxel for $type {
            fn as_f64(self) -> f64 { self as f64 }
            fn as_label(self) -> Option<i128> { Some(self as i128) }
        }
    )*};
}
integer_voxel!(u8, i8, u16, i16, u32, i32, u64, i64);

impl Voxel for bool {
    fn as_f64(self) -> f64 {
        f64::from(u8::from(self))
    }
    fn as_label(self) -> Option<i128> {
        Some(i128::from(self))
    }
}

macro_rules! float_voxel {
    ($($type:ty),*) => {$(
        impl Voxel for $type {
            fn as_f64(self) -> f64 { self.into() }
            fn as_label(self) -> Option<i128> {
                (self.fract() == 0.0).then_some(self as i128)
            }
        }
    )*};
}
float_voxel!(f32, f64);

impl Occupancy {
    /// The volume of all lattice points whose value `select` chooses.
    ///
    /// `values` holds one value per lattice point, x fastest, then y, then z.
    ///
    /// # Errors
    /// [`Error::Length`] when the number of values does not fit the grid, [`Error::NotANumber`] when
    /// a value is not a number: it would have no side.
    pub fn from_values<T: Voxel>(grid: Grid, values: &[T], select: &Select) -> Result<Self, Error> {
        let is_nan = |value: &T| value.as_f64().is_nan();
        if let Some(first) = values.iter().position(is_nan) {
            let others = values[first + 1..].iter().filter(|v| is_nan(v)).count();
            let [nx, ny, _] = grid.dims();
            let voxel = [first % nx, first / nx % ny, first / nx / ny];
            return Err(Error::NotANumber { voxel, others });
        }
        match select {
            Select::NonZero => Self::from_slice(grid, values, |v| v.as_f64() != 0.0),
            Select::Above(level) => Self::from_slice(grid, values, |v| v.as_f64() > *level),
            Select::Labels(labels) => Self::from_slice(grid, values, |v| {
                v.as_label().is_some_and(|label| labels.contains(&label))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inside<T: Voxel>(values: &[T], select: &Select) -> Result<Vec<bool>, Error> {
        let grid = Grid::new([values.len(), 1, 1], [1.0; 3])?;
        let volume = Occupancy::from_values(grid, values, select)?;
        Ok((0..values.len()).map(|i| volume.get([i, 0, 0])).collect())
    }

    #[test]
    fn every_rule_on_every_kind_of_type() {
        assert_eq!(inside(&[true, false], &Select::NonZero).unwrap(), [true, false]);
        assert_eq!(inside(&[-1i8, 0, 3], &Select::NonZero).unwrap(), [true, false, true]);
        assert_eq!(inside(&[0.5f32, 0.51], &Select::Above(0.5)).unwrap(), [false, true]);
        let big = u64::MAX - 1;
        assert_eq!(
            inside(&[big, u64::MAX, 7], &Select::Labels(vec![i128::from(big), 7])).unwrap(),
            [true, false, true],
            "labels compare exactly, beyond the 53 bits of a float"
        );
        assert_eq!(inside(&[2.0f64, 2.5], &Select::Labels(vec![2])).unwrap(), [true, false]);
    }

    #[test]
    fn nan_has_no_side() {
        let error = inside(&[0.0, f64::NAN, f64::NAN], &Select::Above(0.0)).unwrap_err();
        assert_eq!(error, Error::NotANumber { voxel: [1, 0, 0], others: 1 });
    }
}
