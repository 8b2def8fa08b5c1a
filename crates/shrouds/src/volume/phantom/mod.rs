//! Phantoms: volumes made from formulas, for demonstrations and tests.
//!
//! Shapes are given in world units on a [`Grid`] and sampled at its lattice points: a point is
//! inside when the formula says so, its boundary included. [`named`] places each shape on a cube of
//! lattice points and says what is known about it; [`sphere`], [`linked_tori`] and [`gyroid`] are
//! the volumes that the accuracy of surfaces is measured on.

mod cells;
mod font;
mod gyroid;
mod letters;
mod named;
mod noise;
mod rotation;
mod solids;
mod tori;

pub use cells::cells;
pub use gyroid::{gyroid, gyroid_ball};
pub use letters::letters;
pub use named::{NAMES, Phantom, named};
pub use noise::noise;
pub use rotation::{IDENTITY, Rotation, rotation};
pub use solids::{ball, block, cuboid, ellipsoid, sphere};
pub use tori::{linked_tori, linked_tori_with_spacing, tori};

use crate::error::Error;
use crate::grid::Grid;

/// Largest side of a phantom on a cube of lattice points: 2048³ bits are a gigabyte.
const MAX_SIZE: usize = 2048;

/// A grid that covers a cube of side `size` in world units, from the origin on.
fn cube(size: usize, spacing: [f64; 3]) -> Result<Grid, Error> {
    if !(1..=MAX_SIZE).contains(&size) {
        return Err(Error::Setting {
            name: "phantom size",
            value: size.to_string(),
            range: "between 1 and 2048 lattice points",
        });
    }
    if spacing.iter().any(|s| !(s.is_finite() && *s >= 1.0)) {
        return Err(Error::Setting {
            name: "phantom spacing",
            value: format!("{spacing:?}"),
            range: "at least 1 along each axis",
        });
    }
    Grid::new(spacing.map(|s| (size as f64 / s).ceil() as usize), spacing)
}

/// The middle of a cube of side `size`, moved off every symmetry of the lattice, so that no lattice
/// point lies on a surface by accident and no two parts are alike.
fn generic_centre(size: usize) -> [f64; 3] {
    [0.137, 0.071, -0.093].map(|offset| (size as f64 - 1.0) / 2.0 + offset)
}

/// Refuses sizes that are not positive and finite, and places that are not finite.
fn check_shape(centre: [f64; 3], name: &'static str, sizes: &[f64]) -> Result<(), Error> {
    if centre.iter().any(|x| !x.is_finite()) {
        let value = format!("{centre:?}");
        return Err(Error::Setting { name: "centre", value, range: "finite" });
    }
    if sizes.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        let value = format!("{sizes:?}");
        return Err(Error::Setting { name, value, range: "positive and finite" });
    }
    Ok(())
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Length, summed in the order x, y, z.
fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// World position of a whole index.
fn position(grid: &Grid, index: [usize; 3]) -> [f64; 3] {
    grid.point(index.map(|i| i as f64))
}

#[cfg(test)]
pub(super) mod test_support {
    use crate::volume::Occupancy;

    /// Sizes of the 6-connected parts of the points whose bit is `inside`, in order of their first
    /// point.
    pub(crate) fn part_sizes(volume: &Occupancy, inside: bool) -> Vec<usize> {
        let dims = volume.grid().dims();
        let [nx, ny, nz] = dims;
        let mut seen = vec![false; nx * ny * nz];
        let mut sizes = Vec::new();
        for start in 0..seen.len() {
            let mut stack = vec![[start % nx, start / nx % ny, start / nx / ny]];
            let mut size = 0;
            while let Some(p) = stack.pop() {
                let slot = &mut seen[(p[2] * ny + p[1]) * nx + p[0]];
                if *slot || volume.get(p) != inside {
                    continue;
                }
                *slot = true;
                size += 1;
                for axis in 0..3 {
                    for step in [p[axis].wrapping_sub(1), p[axis] + 1] {
                        if step < dims[axis] {
                            let mut q = p;
                            q[axis] = step;
                            stack.push(q);
                        }
                    }
                }
            }
            if size > 0 {
                sizes.push(size);
            }
        }
        sizes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_spacings_out_of_range_are_refused() {
        for n in [0, 2049, usize::MAX] {
            assert!(matches!(linked_tori(n), Err(Error::Setting { name: "phantom size", .. })));
        }
        for spacing in [[1.0, 1.0, 0.0], [1.0, f64::NAN, 1.0], [f64::INFINITY; 3], [1e-9; 3]] {
            assert!(linked_tori_with_spacing(24, spacing).is_err());
        }
    }

    #[test]
    fn the_measured_volumes_are_the_ones_that_were_measured() {
        // Counted by NumPy (tests/python/test_accuracy.py); one point more
        // or less would move every published accuracy.
        assert_eq!(linked_tori(24).unwrap().count(), 799);
        assert_eq!(linked_tori(128).unwrap().count(), 116_216);
        assert_eq!(linked_tori_with_spacing(128, [1.0, 1.0, 3.0]).unwrap().count(), 39_073);
        assert_eq!(sphere(32).unwrap().count(), 8_783);
        assert_eq!(sphere(128).unwrap().count(), 562_276);
        assert_eq!(gyroid(128).unwrap().count(), 427_151);
    }

    #[test]
    fn shapes_that_are_no_shapes_are_refused() {
        let grid = Grid::new([4; 3], [1.0; 3]).unwrap();
        assert!(ball(&grid, [0.0, f64::NAN, 0.0], 1.0).is_err());
        assert!(ball(&grid, [0.0; 3], -1.0).is_err());
        assert!(ellipsoid(&grid, [0.0; 3], [1.0, 0.0, 1.0], &IDENTITY).is_err());
        assert!(tori(&grid, [[0.0; 3]; 2], 1.0, f64::INFINITY).is_err());
        assert!(gyroid_ball(&grid, [0.0; 3], 1.0, 0.0).is_err());
        assert!(letters(&grid, "A", [0.0; 3], 7.0, -1.0).is_err());
    }
}
