//! Which values of an array count as inside.

use crate::error::Error;
use crate::grid::Grid;
use crate::volume::{Filler, Occupancy};

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
pub trait Voxel: Copy + PartialOrd + Send + Sync {
    /// No, or nothing.
    const ZERO: Self;
    /// The value as a float, rounded where it does not fit.
    fn as_f64(self) -> f64;
    /// The value as a label, if it is a whole number.
    fn as_label(self) -> Option<i128>;
    /// The value that is this label, if there is one.
    fn from_label(label: i128) -> Option<Self>;
    /// The value such that those from it on are those whose [`as_f64`](Self::as_f64) is above
    /// `level`, if the type has one that is quicker to compare with.
    fn least_above(level: f64) -> Option<Self>;
    /// Whether the value is not a number.
    fn is_nan(self) -> bool {
        false
    }
}

macro_rules! integer_voxel {
    ($exact:expr; $($type:ty),*) => {$(
        impl Voxel for $type {
            const ZERO: Self = 0;
            fn as_f64(self) -> f64 { self as f64 }
            fn as_label(self) -> Option<i128> { Some(self as i128) }
            fn from_label(label: i128) -> Option<Self> { label.try_into().ok() }
            fn least_above(level: f64) -> Option<Self> {
                // Casts saturate: a level below the type gives its smallest value.
                let least = (level.floor() + 1.0) as Self;
                ($exact && !level.is_nan() && least.as_f64() > level).then_some(least)
            }
        }
    )*};
}
integer_voxel!(true; u8, i8, u16, i16, u32, i32);
// Floats do not hold all of these.
integer_voxel!(false; u64, i64);

impl Voxel for bool {
    const ZERO: Self = false;
    fn as_f64(self) -> f64 {
        f64::from(u8::from(self))
    }
    fn as_label(self) -> Option<i128> {
        Some(i128::from(self))
    }
    fn from_label(label: i128) -> Option<Self> {
        u8::from_label(label).filter(|&label| label < 2).map(|label| label == 1)
    }
    fn least_above(_: f64) -> Option<Self> {
        None
    }
}

macro_rules! float_voxel {
    ($($type:ty),*) => {$(
        impl Voxel for $type {
            const ZERO: Self = 0.0;
            fn as_f64(self) -> f64 { self.into() }
            fn as_label(self) -> Option<i128> {
                (self.fract() == 0.0).then_some(self as i128)
            }
            fn from_label(label: i128) -> Option<Self> {
                let value = label as Self;
                (value as i128 == label).then_some(value)
            }
            fn least_above(_: f64) -> Option<Self> { None }
            fn is_nan(self) -> bool { self != self }
        }
    )*};
}
float_voxel!(f32, f64);

impl Occupancy {
    /// The volume of all lattice points whose value `select` chooses.
    ///
    /// `values` holds one value per lattice point, x fastest, then y, then z. Values that come in
    /// pieces go into a [`Filler`].
    ///
    /// # Errors
    /// [`Error::Length`] when the number of values does not fit the grid, [`Error::NotANumber`] when
    /// a value is not a number: it would have no side.
    pub fn from_values<T: Voxel>(grid: Grid, values: &[T], select: &Select) -> Result<Self, Error> {
        grid.check_length(values.len())?;
        let mut filler = Filler::new(grid, select.clone());
        filler.push_rows(values);
        filler.finish()
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
        let labels = Select::Labels(vec![0, 1, 2]);
        assert_eq!(inside(&[true, false], &labels).unwrap(), [true, true]);
        assert_eq!(inside(&[-0.0f32, 3.0], &labels).unwrap(), [true, false]);
    }

    fn check_levels<T: Voxel>(values: &[T]) {
        let ends = [i32::MIN, -32_768, -129, -128, 0, 127, 128, 255, 256, 65_535, i32::MAX];
        let levels =
            ends.into_iter().flat_map(|end| [-1.0, -0.5, 0.0, 0.5].map(|d| f64::from(end) + d));
        let levels = levels.chain([4_294_967_295.0, 1e300, -1e300, f64::NAN]);
        for level in levels.chain([f64::INFINITY, f64::NEG_INFINITY]) {
            let expected: Vec<bool> = values.iter().map(|v| v.as_f64() > level).collect();
            assert_eq!(inside(values, &Select::Above(level)).unwrap(), expected, "{level}");
        }
    }

    #[test]
    fn levels_within_and_beyond_every_type() {
        check_levels(&[false, true]);
        check_levels(&(0..=255).collect::<Vec<u8>>());
        check_levels(&(-128..=127).collect::<Vec<i8>>());
        check_levels(&[0, 127, 128, 255, 256, u16::MAX]);
        check_levels(&[i16::MIN, -129, -1, 0, 1, i16::MAX]);
        check_levels(&[0, 1, 65_535, 65_536, u32::MAX - 1, u32::MAX]);
        check_levels(&[i32::MIN, i32::MIN + 1, -1, 0, i32::MAX - 1, i32::MAX]);
        check_levels(&[0, 1 << 53, (1 << 53) + 1, u64::MAX]);
        check_levels(&[i64::MIN, -1, 0, i64::MAX]);
        check_levels(&[-0.5f32, 0.0, 255.5]);
    }

    #[test]
    fn nan_has_no_side() {
        let error = inside(&[0.0, f64::NAN, f64::NAN], &Select::Above(0.0)).unwrap_err();
        assert_eq!(error, Error::NotANumber { voxel: [1, 0, 0], others: 1 });
    }
}
