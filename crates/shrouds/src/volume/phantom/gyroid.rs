//! The gyroid, cut by a ball: one connected labyrinth with thin walls and saddles everywhere.

use super::{check_shape, cube, generic_centre, length, position, subtract};
use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// The lattice points of a ball (world units) where sin x cos y + sin y cos z + sin z cos x ≥ 0, with
/// x, y, z measured from its centre and repeating after `period`.
///
/// # Errors
/// [`Error::Setting`] when the centre is not finite, or radius or period not positive and finite.
pub fn gyroid_ball(
    grid: &Grid,
    centre: [f64; 3],
    radius: f64,
    period: f64,
) -> Result<Occupancy, Error> {
    check_shape(centre, "radius and period", &[radius, period])?;
    let frequency = 2.0 * std::f64::consts::PI / period;
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        let q = subtract(position(grid, index), centre);
        if length(q) - radius > 0.0 {
            return false;
        }
        let [x, y, z] = q.map(|c| (c * frequency).sin_cos());
        x.0 * y.1 + y.0 * z.1 + z.0 * x.1 >= 0.0
    }))
}

/// A gyroid of period `n`/8 in a ball of radius 0.46 `n` on a cube of `n`³ lattice points with
/// spacing 1.
///
/// # Errors
/// [`Error::Setting`] when `n` is 0 or above 2048.
pub fn gyroid(n: usize) -> Result<Occupancy, Error> {
    gyroid_ball(&cube(n, [1.0; 3])?, generic_centre(n), 0.46 * n as f64, n as f64 / 8.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::phantom::ball;
    use crate::volume::phantom::test_support::part_sizes;

    #[test]
    fn it_halves_the_ball_into_two_labyrinths() {
        // The gyroid turns into its complement under inversion, so in a centred ball of a whole
        // number of periods it takes half the volume.
        let grid = Grid::new([80; 3], [1.0; 3]).unwrap();
        let (centre, radius) = ([39.6, 39.3, 39.9], 38.0);
        let volume = gyroid_ball(&grid, centre, radius, 19.0).unwrap();
        let whole = ball(&grid, centre, radius).unwrap().count() as f64;
        assert!((volume.count() as f64 / whole - 0.5).abs() < 0.005);
        // Cut ends may stand alone, but nearly everything is one labyrinth.
        let largest = part_sizes(&volume, true).into_iter().max().unwrap_or(0) as f64;
        assert!(largest > 0.98 * volume.count() as f64);
    }

    #[test]
    fn it_repeats_after_its_period() {
        let grid = Grid::new([40; 3], [1.0; 3]).unwrap();
        let volume = gyroid_ball(&grid, [19.63; 3], 1e3, 13.0).unwrap();
        for index in [[0, 0, 0], [3, 9, 20], [11, 26, 4], [26, 26, 26]] {
            for axis in 0..3 {
                let mut next = index;
                next[axis] += 13;
                assert_eq!(volume.get(index), volume.get(next));
            }
        }
    }
}
