//! Volumes from values that come in pieces.

use crate::error::Error;
use crate::grid::Grid;
use crate::parallel;
use crate::volume::pack::{pack_row, reverse_axes};
use crate::volume::{Occupancy, Select, Voxel};

/// Values per block of work, at least.
const BLOCK: usize = 1 << 16;

/// A volume that is filled row after row, so that its values need not all be in memory at once.
///
/// Memory grows with the rows that arrive, not with the grid.
#[derive(Debug, Clone)]
pub struct Filler {
    grid: Grid,
    select: Select,
    z_fastest: bool,
    words: Vec<u64>,
    /// Values taken so far.
    count: usize,
    /// The first value by z, y, x that is no number, and how many there are.
    odd: ([usize; 3], usize),
}

impl Filler {
    /// Will be the volume of all lattice points whose value `select` chooses. Rows run along x and
    /// come by y, then z.
    pub fn new(grid: Grid, select: Select) -> Self {
        let odd = ([usize::MAX; 3], 0);
        Self { grid, select, z_fastest: false, words: Vec::new(), count: 0, odd }
    }

    /// The same for rows that run along z and come by y, then x.
    pub fn z_fastest(grid: Grid, select: Select) -> Self {
        Self { z_fastest: true, ..Self::new(grid, select) }
    }

    /// Number of values in a row.
    pub fn row_length(&self) -> usize {
        self.grid.dims()[if self.z_fastest { 2 } else { 0 }]
    }

    /// Takes the values of the next rows.
    ///
    /// # Panics
    /// When the values do not make up whole rows, or more rows than are left.
    pub fn push_rows<T: Voxel>(&mut self, values: &[T]) {
        let (length, words_per_row) = (self.row_length(), self.row_length().div_ceil(64));
        let rows = values.len() / length;
        assert!(rows * length == values.len(), "{} values in rows of {length}", values.len());
        assert!(values.len() <= self.grid.point_count() - self.count, "{rows} rows are too many");
        let mut words = vec![0; rows * words_per_row];
        let block = BLOCK.div_ceil(length);
        let ends = (0..rows.div_ceil(block)).map(|n| rows.min((n + 1) * block) * words_per_row);
        let chosen = Chosen::new(&self.select);
        // Rows of whole words follow each other like one.
        let whole = length % 64 == 0;
        let odd = parallel::pieces(&mut words, ends, |n, words| {
            let values = &values[n * block * length..];
            let (length, words_per_row) =
                if whole { (64 * words.len(), words.len()) } else { (length, words_per_row) };
            let rows = words.chunks_exact_mut(words_per_row).zip(values.chunks_exact(length));
            rows.fold(false, |odd, (words, row)| {
                chosen.pack_row(row, words);
                row.iter().fold(odd, |odd, value| odd | value.is_nan())
            })
        });
        if odd.contains(&true) {
            self.list_odd(values);
        }
        self.count += values.len();
        if self.words.is_empty() {
            self.words = words;
        } else {
            self.words.extend(words);
        }
    }

    fn list_odd<T: Voxel>(&mut self, values: &[T]) {
        let [nx, ny, nz] = self.grid.dims();
        for (n, _) in values.iter().enumerate().filter(|(_, value)| value.is_nan()) {
            let n = self.count + n;
            let place = if self.z_fastest {
                [n % nz, n / nz % ny, n / nz / ny]
            } else {
                [n / nx / ny, n / nx % ny, n % nx]
            };
            self.odd = (self.odd.0.min(place), self.odd.1 + 1);
        }
    }

    /// The volume.
    ///
    /// # Errors
    /// [`Error::Length`] when rows are missing, [`Error::NotANumber`] when a value is not a number:
    /// it would have no side.
    pub fn finish(self) -> Result<Occupancy, Error> {
        self.grid.check_length(self.count)?;
        let dims = self.grid.dims();
        if let ([k, j, i], count @ 1..) = self.odd {
            return Err(Error::NotANumber { voxel: [i, j, k], others: count - 1 });
        }
        let words = if self.z_fastest { reverse_axes(&self.words, dims) } else { self.words };
        Ok(Occupancy::of_words(self.grid, words))
    }
}

/// A selection in terms of one type of values.
enum Chosen<T> {
    AllBut(T),
    AtLeast(T),
    Above(f64),
    AnyOf(Vec<T>),
}

impl<T: Voxel> Chosen<T> {
    fn new(select: &Select) -> Self {
        match select {
            Select::NonZero => Self::AllBut(T::ZERO),
            Select::Above(level) => {
                T::least_above(*level).map_or(Self::Above(*level), Self::AtLeast)
            }
            Select::Labels(labels) => {
                Self::AnyOf(labels.iter().filter_map(|&label| T::from_label(label)).collect())
            }
        }
    }

    fn pack_row(&self, row: &[T], words: &mut [u64]) {
        match self {
            Self::AllBut(zero) => pack_row(row, words, |v, flags| mark(v, flags, |v| v != *zero)),
            Self::AtLeast(least) => {
                pack_row(row, words, |v, flags| mark(v, flags, |v| v >= *least))
            }
            Self::Above(level) => {
                pack_row(row, words, |v, flags| mark(v, flags, |v| v.as_f64() > *level));
            }
            Self::AnyOf(labels) => pack_row(row, words, |values, flags| {
                flags.fill(false);
                for label in labels {
                    for (flag, value) in flags.iter_mut().zip(values) {
                        *flag |= value == label;
                    }
                }
            }),
        }
    }
}

#[inline]
fn mark<T: Copy>(values: &[T; 64], flags: &mut [bool; 64], inside: impl Fn(T) -> bool) {
    for (flag, &value) in flags.iter_mut().zip(values) {
        *flag = inside(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values 0 to 9 in a pattern with no period of its own along any axis.
    fn value([i, j, k]: [usize; 3]) -> i16 {
        ((i * 7 + j * 5 + k * 3 + i * j + j * k * k) % 10) as i16
    }

    fn selects() -> [Select; 4] {
        let labels = vec![3, 7, -1, 1 << 40];
        [Select::NonZero, Select::Above(4.5), Select::Above(-1.0), Select::Labels(labels)]
    }

    fn chosen(select: &Select, value: i16) -> bool {
        match select {
            Select::NonZero => value != 0,
            Select::Above(level) => f64::from(value) > *level,
            Select::Labels(labels) => labels.contains(&i128::from(value)),
        }
    }

    fn grid(dims: [usize; 3]) -> Grid {
        Grid::new(dims, [1.0; 3]).unwrap()
    }

    #[test]
    fn rows_of_any_length_in_pieces_of_any_size_along_either_axis() {
        for nx in (1..=70).chain([127, 128, 129]) {
            let dims @ [nx, ny, nz] = [nx, 3, 1 + nx * 5 % 67];
            let x_fastest: Vec<i16> =
                (0..nx * ny * nz).map(|n| value([n % nx, n / nx % ny, n / nx / ny])).collect();
            let z_fastest: Vec<i16> =
                (0..nx * ny * nz).map(|n| value([n / nz / ny, n / nz % ny, n % nz])).collect();
            for select in selects() {
                let expected = Occupancy::from_fn(grid(dims), |p| chosen(&select, value(p)));
                let whole = Occupancy::from_values(grid(dims), &x_fastest, &select).unwrap();
                assert_eq!(whole, expected, "{dims:?} {select:?}");
                let mut filler = Filler::new(grid(dims), select.clone());
                x_fastest.chunks(nx * 2).for_each(|rows| filler.push_rows(rows));
                assert_eq!(filler.finish().unwrap(), expected);
                let mut filler = Filler::z_fastest(grid(dims), select.clone());
                z_fastest.chunks(nz * 5).for_each(|rows| filler.push_rows(rows));
                assert_eq!(filler.finish().unwrap(), expected, "{dims:?} {select:?}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_counted_over_all_pieces_and_named_in_scan_order() {
        let mut values = [1.0f32; 24];
        values[7] = f32::NAN;
        values[14] = f32::NAN;
        let mut filler = Filler::new(grid([2, 3, 4]), Select::NonZero);
        values.chunks(4).for_each(|rows| filler.push_rows(rows));
        let expected = Error::NotANumber { voxel: [1, 0, 1], others: 1 };
        assert_eq!(filler.finish().unwrap_err(), expected);
        // As x, y, z: 7 is [0, 1, 3] and 14 is [1, 0, 2], which has the smaller z.
        let mut filler = Filler::z_fastest(grid([2, 3, 4]), Select::NonZero);
        values.chunks(4).for_each(|rows| filler.push_rows(rows));
        let expected = Error::NotANumber { voxel: [1, 0, 2], others: 1 };
        assert_eq!(filler.finish().unwrap_err(), expected);
    }

    #[test]
    fn missing_rows_are_refused() {
        let mut filler = Filler::new(grid([2, 3, 4]), Select::NonZero);
        filler.push_rows(&[1u8; 6]);
        assert!(matches!(filler.finish(), Err(Error::Length { values: 6, points: 24, .. })));
    }
}
