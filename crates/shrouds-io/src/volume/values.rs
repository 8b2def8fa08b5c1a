//! The values of a volume, in the type the file stores them in.

use std::collections::BTreeMap;
use std::ops::Range;

use shrouds::surface::Surface;
use shrouds::volume::{Filler, Voxel};
use shrouds::{Grid, Occupancy, Select};

/// Labels counted in a table: those of every 8-bit and 16-bit type.
const TABLE: Range<i128> = -(1 << 15)..1 << 16;
/// Most distinct labels that are listed.
const MAX_LABELS: usize = 1 << 16;
/// Edge of the squares in which axes are swapped: a row fills at least half a cache line, and a
/// square of the widest type fits the first cache.
const TILE: usize = 32;

/// One value per lattice point, x fastest, in one of the types that files hold.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // Each variant is named after its type.
pub enum Values {
    Bool(Vec<bool>),
    U8(Vec<u8>),
    I8(Vec<i8>),
    U16(Vec<u16>),
    I16(Vec<i16>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    U64(Vec<u64>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// `$body` with `$slice` bound to the vector inside, whatever its type.
macro_rules! with_values {
    ($values:expr, $slice:ident => $body:expr) => {
        match $values {
            Values::Bool($slice) => $body,
            Values::U8($slice) => $body,
            Values::I8($slice) => $body,
            Values::U16($slice) => $body,
            Values::I16($slice) => $body,
            Values::U32($slice) => $body,
            Values::I32($slice) => $body,
            Values::U64($slice) => $body,
            Values::I64($slice) => $body,
            Values::F32($slice) => $body,
            Values::F64($slice) => $body,
        }
    };
}

macro_rules! from_lists {
    ($($variant:ident $type:ty),*) => {$(
        impl From<Vec<$type>> for Values {
            fn from(values: Vec<$type>) -> Self {
                Self::$variant(values)
            }
        }
    )*};
}
from_lists!(Bool bool, U8 u8, I8 i8, U16 u16, I16 i16, U32 u32, I32 i32, U64 u64, I64 i64);
from_lists!(F32 f32, F64 f64);

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        with_values!(self, v => v.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Name of the type: `bool`, `u8` … `i64`, `f32`, `f64`.
    pub fn type_name(&self) -> &'static str {
        fn name<T>(_: &[T]) -> &'static str {
            std::any::type_name::<T>()
        }
        with_values!(self, v => name(v))
    }

    /// The smallest and the largest value as floats, leaving out what is not a number; `None` when
    /// nothing is left.
    pub fn range(&self) -> Option<(f64, f64)> {
        fn range<T: Voxel>(values: &[T]) -> (f64, f64) {
            let all = (f64::INFINITY, f64::NEG_INFINITY);
            values.iter().fold(all, |(low, high), v| (low.min(v.as_f64()), high.max(v.as_f64())))
        }
        let (low, high) = with_values!(self, v => range(v));
        (low <= high).then_some((low, high))
    }

    /// Every distinct value with its number of lattice points, ascending; `None` when some value is
    /// not a whole number or there are more than 65 536 distinct ones: then they are no labels.
    pub fn labels(&self) -> Option<Vec<(i128, u64)>> {
        with_values!(self, v => count_labels(v))
    }

    /// Every distinct value, ascending, and for each lattice point the place of its value among them;
    /// `None` as for [`labels`](Self::labels). Two bytes a lattice point, whatever the type.
    pub fn numbered(&self) -> Option<(Vec<i128>, Vec<u16>)> {
        with_values!(self, v => number_labels(v))
    }

    /// Every value as a whole number; `None` when some value is none, or does not fit into 64 bits.
    pub fn whole(&self) -> Option<Vec<i64>> {
        fn whole<T: Voxel>(values: &[T]) -> Option<Vec<i64>> {
            values.iter().map(|value| value.as_label()?.try_into().ok()).collect()
        }
        with_values!(self, v => whole(v))
    }

    /// The values at these places as floats.
    ///
    /// # Panics
    /// When there is no such place.
    pub fn at(&self, places: impl Iterator<Item = usize>) -> Vec<f64> {
        with_values!(self, v => places.map(|place| v[place].as_f64()).collect())
    }

    /// Every value as a float.
    pub fn to_f64(&self) -> Vec<f64> {
        with_values!(self, v => v.iter().map(|value| value.as_f64()).collect())
    }

    /// The volume of all lattice points of `grid` whose value `select` chooses.
    ///
    /// # Errors
    /// [`shrouds::Error::Length`] when the number of values does not fit the grid,
    /// [`shrouds::Error::NotANumber`] when a value is not a number.
    pub fn occupancy(&self, grid: Grid, select: &Select) -> Result<Occupancy, shrouds::Error> {
        with_values!(self, v => Occupancy::from_values(grid, v, select))
    }

    /// δ of every vertex of the surface of the values above `level` where their linear interpolation
    /// along its grid edge passes through it: [`Surface::isosurface_deltas`].
    ///
    /// # Errors
    /// [`shrouds::Error::Length`] when the surface is that of another lattice.
    pub fn isosurface_deltas(
        &self,
        surface: &Surface,
        level: f64,
    ) -> Result<Vec<f64>, shrouds::Error> {
        with_values!(self, v => surface.isosurface_deltas(v, level))
    }

    /// Appends values of the same type.
    ///
    /// # Panics
    /// When the types differ.
    pub(super) fn append(&mut self, more: Self) {
        macro_rules! append_same {
            ($($variant:ident),*) => {
                match (self, more) {
                    $((Self::$variant(values), Self::$variant(more)) => values.extend(more),)*
                    (values, more) => {
                        panic!("{} after {}", more.type_name(), values.type_name())
                    }
                }
            };
        }
        append_same!(Bool, U8, I8, U16, I16, U32, I32, U64, I64, F32, F64);
    }

    /// Makes room for `count` more values; whether there is room.
    pub(super) fn reserve(&mut self, count: usize) -> bool {
        with_values!(self, v => v.try_reserve_exact(count).is_ok())
    }

    /// Hands the values to `filler`.
    pub(super) fn push_to(&self, filler: &mut Filler) {
        with_values!(self, v => filler.push_rows(v));
    }

    /// Hands some of the values to a filler; they must be whole rows.
    pub(super) fn push_some_to(&self, filler: &mut Filler, range: Range<usize>) {
        with_values!(self, v => filler.push_rows(&v[range]));
    }

    /// `slope · value + shift` for every value.
    pub(super) fn scaled(&self, slope: f64, shift: f64) -> Self {
        with_values!(self, v => Self::F64(v.iter().map(|v| v.as_f64() * slope + shift).collect()))
    }

    /// The same values x fastest, given z fastest; `dims` are x, y, z.
    pub(super) fn with_axes_reversed(self, dims: [usize; 3]) -> Self {
        with_values!(self, v => Self::from(reverse_axes(&v, dims)))
    }
}

fn reverse_axes<T: Copy + Default>(values: &[T], [nx, ny, nz]: [usize; 3]) -> Vec<T> {
    let mut reversed = vec![T::default(); values.len()];
    // Through a tile, so that memory is read and written in whole cache lines: strides that are
    // powers of two would throw a line out before its next value is used.
    let mut tile = [[T::default(); TILE]; TILE];
    let corners = (0..nx).step_by(TILE).flat_map(|i| (0..nz).step_by(TILE).map(move |k| (i, k)));
    for (i0, k0, j) in corners.flat_map(|(i0, k0)| (0..ny).map(move |j| (i0, k0, j))) {
        let (across, along) = (TILE.min(nx - i0), TILE.min(nz - k0));
        for (i, row) in tile[..across].iter_mut().enumerate() {
            let start = ((i0 + i) * ny + j) * nz + k0;
            row[..along].copy_from_slice(&values[start..start + along]);
        }
        for k in 0..along {
            let start = ((k0 + k) * ny + j) * nx + i0;
            for (value, row) in reversed[start..start + across].iter_mut().zip(&tile) {
                *value = row[k];
            }
        }
    }
    reversed
}

fn count_labels<T: Voxel>(values: &[T]) -> Option<Vec<(i128, u64)>> {
    let mut table = vec![0u64; (TABLE.end - TABLE.start) as usize];
    let mut others = BTreeMap::new();
    for value in values {
        let label = value.as_label()?;
        if TABLE.contains(&label) {
            table[(label - TABLE.start) as usize] += 1;
        } else {
            *others.entry(label).or_insert(0u64) += 1;
            if others.len() > MAX_LABELS {
                return None;
            }
        }
    }
    let mut labels: Vec<(i128, u64)> =
        (TABLE.zip(table).filter(|&(_, count)| count > 0)).chain(others).collect();
    labels.sort_unstable();
    (labels.len() <= MAX_LABELS).then_some(labels)
}

fn number_labels<T: Voxel>(values: &[T]) -> Option<(Vec<i128>, Vec<u16>)> {
    let labels: Vec<i128> = count_labels(values)?.into_iter().map(|(label, _)| label).collect();
    let mut last = None;
    let number = |value: &T| {
        let label = value.as_label()?;
        if let Some((known, place)) = last
            && known == label
        {
            return Some(place);
        }
        let place = u16::try_from(labels.binary_search(&label).ok()?).ok()?;
        last = Some((label, place));
        Some(place)
    };
    let numbers = values.iter().map(number).collect::<Option<_>>()?;
    Some((labels, numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_counted_over_the_whole_range() {
        let values = Values::I64(vec![5, -40_000, 5, i64::MAX, 70_000, -1, i64::MIN]);
        let expected = [
            (i128::from(i64::MIN), 1),
            (-40_000, 1),
            (-1, 1),
            (5, 2),
            (70_000, 1),
            (i128::from(i64::MAX), 1),
        ];
        assert_eq!(values.labels().unwrap(), expected);
        assert_eq!(values.range(), Some((i64::MIN as f64, i64::MAX as f64)));
        assert_eq!(Values::Bool(vec![true, true]).labels().unwrap(), [(1, 2)]);
        let (labels, numbers) = values.numbered().unwrap();
        let back: Vec<i128> = numbers.iter().map(|&n| labels[usize::from(n)]).collect();
        assert_eq!(back, values.whole().unwrap().into_iter().map(i128::from).collect::<Vec<_>>());
    }

    #[test]
    fn floats_are_labels_only_when_whole() {
        assert_eq!(Values::F32(vec![2.0, -0.0, 2.0]).labels().unwrap(), [(0, 1), (2, 2)]);
        for odd in [0.5, f64::NAN, f64::INFINITY] {
            assert_eq!(Values::F64(vec![1.0, odd]).labels(), None);
            assert_eq!(Values::F64(vec![1.0, odd]).numbered(), None);
        }
        assert_eq!(Values::F64(vec![f64::NAN, 2.0, -3.0]).range(), Some((-3.0, 2.0)));
        assert_eq!(Values::F64(vec![f64::NAN]).range(), None);
    }

    #[test]
    fn too_many_values_are_no_labels() {
        let ramp = |count: u32| Values::U32((0..count).map(|n| n * 3).collect());
        assert_eq!(ramp(1 << 16).labels().map(|labels| labels.len()), Some(1 << 16));
        assert_eq!(ramp((1 << 16) + 1).labels(), None);
    }

    #[test]
    fn axes_are_reversed_across_tiles() {
        let dims = [67, 3, 40];
        let at = |i: usize, j: usize, k: usize| (i * 10_000 + j * 100 + k) as u32;
        let z_fastest = (0..67 * 120).map(|n| at(n / 120, n / 40 % 3, n % 40)).collect();
        let x_fastest = (0..67 * 120).map(|n| at(n % 67, n / 67 % 3, n / 201)).collect();
        assert_eq!(Values::U32(z_fastest).with_axes_reversed(dims), Values::U32(x_fastest));
    }
}
