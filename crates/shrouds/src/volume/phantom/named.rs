//! Phantoms by name, each on a cube of lattice points, with what is known about them.

use std::f64::consts::PI;

use super::letters::text_width;
use super::tori::radii;
use super::{
    ball, block, cells, cube, cuboid, ellipsoid, generic_centre, gyroid, letters, linked_tori,
    noise, rotation,
};
use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// The names that [`named`] knows. `letters` may be followed by a text of its own: `letters:HELLO`.
pub const NAMES: [&str; 11] = [
    "tori",
    "ball",
    "ellipsoid",
    "box",
    "gyroid",
    "letters",
    "point",
    "rod",
    "plate",
    "noise",
    "cells",
];
/// How many cells `cells` has, and where their sites come from.
const CELLS: (u8, u64) = (12, 5);

/// A volume made from a formula, and what the formula says about its body.
#[derive(Debug, Clone, PartialEq)]
pub struct Phantom {
    /// Name, one of [`NAMES`].
    pub name: &'static str,
    /// The body, sampled at lattice points of spacing 1.
    pub volume: Occupancy,
    /// Which part of the body each lattice point belongs to, x fastest, 0 outside; of `cells` alone.
    pub labels: Option<Vec<u8>>,
    /// Volume of the body in cubic world units, where a formula gives it.
    pub true_volume: Option<f64>,
    /// Area of its boundary in square world units, where a formula gives it.
    pub true_area: Option<f64>,
}

/// The phantom of this name on a cube of `size`³ lattice points with spacing 1.
///
/// # Errors
/// [`Error::UnknownPhantom`] with the known names when `name` is not one of [`NAMES`];
/// [`Error::Setting`] when `size` is 0 or above 2048, or a text has other characters than letters,
/// digits and spaces.
pub fn named(name: &str, size: usize) -> Result<Phantom, Error> {
    let (name, text) = match name.split_once(':') {
        Some(("letters", text)) => ("letters", text),
        _ => (name, "ASU"),
    };
    let Some(&name) = NAMES.iter().find(|known| **known == name) else {
        let known = NAMES.join(", ");
        return Err(Error::UnknownPhantom { name: name.into(), known });
    };
    let grid = cube(size, [1.0; 3])?;
    if name == "cells" {
        return ball_of_cells(name, grid, size);
    }
    let (volume, truth) = body(name, text, &grid, size)?;
    let (true_volume, true_area) = truth;
    Ok(Phantom { name, volume, labels: None, true_volume, true_area })
}

/// True volume and area, where formulas give them.
type Truth = (Option<f64>, Option<f64>);

fn body(name: &str, text: &str, grid: &Grid, size: usize) -> Result<(Occupancy, Truth), Error> {
    const UNKNOWN: Truth = (None, None);
    let n = size as f64;
    let centre = generic_centre(size);
    let turn = rotation([1.0, 2.0, 3.0], 0.7)?;
    Ok(match name {
        "tori" => {
            let (ring, tube) = radii(size);
            let truth = (4.0 * PI * PI * ring * tube * tube, 8.0 * PI * PI * ring * tube);
            (linked_tori(size)?, (Some(truth.0), Some(truth.1)))
        }
        "ball" => {
            let radius = 0.4 * n;
            let area = 4.0 * PI * radius * radius;
            (ball(grid, centre, radius)?, (Some(area * radius / 3.0), Some(area)))
        }
        "ellipsoid" => {
            let half_axes = [0.44 * n, 0.28 * n, 0.18 * n];
            let volume = 4.0 / 3.0 * PI * half_axes.iter().product::<f64>();
            (ellipsoid(grid, centre, half_axes, &turn)?, (Some(volume), None))
        }
        "box" => {
            let [a, b, c] = [0.62 * n, 0.42 * n, 0.28 * n];
            let area = 2.0 * (a * b + b * c + c * a);
            (cuboid(grid, centre, [a, b, c], &turn)?, (Some(a * b * c), Some(area)))
        }
        "gyroid" => (gyroid(size)?, UNKNOWN),
        "letters" => (line_of_letters(grid, text, centre, n)?, UNKNOWN),
        "point" => (middle_block(grid, [1, 1, 1])?, UNKNOWN),
        "rod" => (middle_block(grid, [size.div_ceil(2), 1, 1])?, UNKNOWN),
        "plate" => (middle_block(grid, [size.div_ceil(2), size.div_ceil(2), 1])?, UNKNOWN),
        _ => (noise(grid, 0.5, 1)?, UNKNOWN),
    })
}

fn ball_of_cells(name: &'static str, grid: Grid, size: usize) -> Result<Phantom, Error> {
    let (count, seed) = CELLS;
    let labels = cells(&grid, generic_centre(size), 0.42 * size as f64, count, seed)?;
    let volume = Occupancy::from_slice(grid, &labels, |label| label > 0)?;
    Ok(Phantom { name, volume, labels: Some(labels), true_volume: None, true_area: None })
}

/// As large as fits into nine tenths of the cube, and two strokes deep.
fn line_of_letters(grid: &Grid, text: &str, centre: [f64; 3], n: f64) -> Result<Occupancy, Error> {
    let count = text.chars().count().max(1);
    let height = 0.9 * n / text_width(count, 1.0).max(1.0);
    letters(grid, text, centre, height, 2.0 / 7.0 * height)
}

fn middle_block(grid: &Grid, counts: [usize; 3]) -> Result<Occupancy, Error> {
    let dims = grid.dims();
    block(grid, std::array::from_fn(|a| (dims[a] - counts[a]) / 2), counts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::phantom::test_support::part_sizes;

    #[test]
    fn every_name_gives_a_volume_that_keeps_off_the_border() {
        for name in NAMES {
            for size in [24, 64] {
                let phantom = named(name, size).unwrap();
                assert_eq!(phantom.name, name);
                assert_eq!(phantom.volume.grid().dims(), [size; 3]);
                assert!(phantom.volume.count() > 0, "{name}");
                let at_border = |p: [usize; 3]| p.iter().any(|&i| i == 0 || i == size - 1);
                let border = Occupancy::from_fn(phantom.volume.grid().clone(), |p| {
                    at_border(p) && phantom.volume.get(p)
                });
                assert!(border.count() == 0 || name == "noise", "{name}");
            }
        }
    }

    #[test]
    fn the_truth_is_that_of_the_volume() {
        let mut known = 0;
        for name in NAMES {
            let phantom = named(name, 96).unwrap();
            if let Some(volume) = phantom.true_volume {
                let error = phantom.volume.count() as f64 / volume - 1.0;
                // What `tori` tolerates is 1 % here, and more than what `solids` does.
                assert!(error.abs() < 0.01, "{name}: {error}");
                known += 1;
            }
        }
        assert_eq!(known, 4);
        // The area is the derivative of the volume by the distance outwards.
        let (small, large) = (named("ball", 100).unwrap(), named("ball", 101).unwrap());
        let growth = large.true_volume.unwrap() - small.true_volume.unwrap();
        let area = (large.true_area.unwrap() + small.true_area.unwrap()) / 2.0;
        assert!((growth / (0.4 * area) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn one_voxel_parts_are_one_voxel_thick() {
        let count = |name| named(name, 25).unwrap().volume.count();
        assert_eq!([count("point"), count("rod"), count("plate")], [1, 13, 169]);
        named("plate", 1).unwrap();
    }

    #[test]
    fn letters_take_a_text() {
        let parts = |name| part_sizes(&named(name, 96).unwrap().volume, true).len();
        assert_eq!(parts("letters"), 3);
        assert_eq!(parts("letters:BE"), 2);
        assert!(matches!(named("letters:-", 96), Err(Error::Setting { name: "text", .. })));
        assert!(matches!(named("letters:", 96), Err(Error::Setting { name: "text", .. })));
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = named("torus", 24).unwrap_err();
        assert!(matches!(&error, Error::UnknownPhantom { name, .. } if name == "torus"));
        let message = error.to_string();
        assert!(NAMES.iter().all(|name| message.contains(name)), "{message}");
        assert!(named("ball:X", 24).is_err());
    }
}
