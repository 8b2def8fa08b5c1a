//! Ball, ellipsoid and box in any place and rotation, and blocks of whole voxels.

use super::{Rotation, check_shape, cube, generic_centre, length, position, rotation, subtract};
use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// The lattice points within `radius` of `centre` (world units).
///
/// # Errors
/// [`Error::Setting`] when the centre is not finite or the radius not positive and finite.
pub fn ball(grid: &Grid, centre: [f64; 3], radius: f64) -> Result<Occupancy, Error> {
    check_shape(centre, "radius", &[radius])?;
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        length(subtract(position(grid, index), centre)) - radius <= 0.0
    }))
}

/// A ball of radius 0.4 `n` on a cube of `n`³ lattice points with spacing 1.
///
/// # Errors
/// [`Error::Setting`] when `n` is 0 or above 2048.
pub fn sphere(n: usize) -> Result<Occupancy, Error> {
    ball(&cube(n, [1.0; 3])?, generic_centre(n), 0.4 * n as f64)
}

/// The lattice points of an ellipsoid with these half axes (world units), turned by `turn`.
///
/// # Errors
/// [`Error::Setting`] when the centre is not finite, a half axis not positive and finite, or `turn`
/// no rotation.
pub fn ellipsoid(
    grid: &Grid,
    centre: [f64; 3],
    half_axes: [f64; 3],
    turn: &Rotation,
) -> Result<Occupancy, Error> {
    check_shape(centre, "half axes", &half_axes)?;
    rotation::check(turn)?;
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        let own = rotation::undo(turn, subtract(position(grid, index), centre));
        (0..3).map(|a| (own[a] / half_axes[a]).powi(2)).sum::<f64>() <= 1.0
    }))
}

/// The lattice points of a box with these side lengths (world units), turned by `turn`.
///
/// # Errors
/// [`Error::Setting`] when the centre is not finite, a side not positive and finite, or `turn` no
/// rotation.
pub fn cuboid(
    grid: &Grid,
    centre: [f64; 3],
    sides: [f64; 3],
    turn: &Rotation,
) -> Result<Occupancy, Error> {
    check_shape(centre, "sides", &sides)?;
    rotation::check(turn)?;
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        let own = rotation::undo(turn, subtract(position(grid, index), centre));
        (0..3).all(|a| own[a].abs() <= sides[a] / 2.0)
    }))
}

/// The lattice points from index `first` on, `counts` of them along x, y, z: a single voxel, a rod or
/// a plate where three, two or one of the counts are 1.
///
/// # Errors
/// [`Error::Setting`] when the block does not lie within the grid or has no points.
pub fn block(grid: &Grid, first: [usize; 3], counts: [usize; 3]) -> Result<Occupancy, Error> {
    let dims = grid.dims();
    let fits = |a: usize| {
        counts[a] > 0 && first[a].checked_add(counts[a]).is_some_and(|end| end <= dims[a])
    };
    if !(0..3).all(fits) {
        return Err(Error::Setting {
            name: "block",
            value: format!("{counts:?} points from {first:?} in a grid of {dims:?}"),
            range: "at least one point, and within the grid",
        });
    }
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        (0..3).all(|a| index[a] >= first[a] && index[a] - first[a] < counts[a])
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::phantom::IDENTITY;
    use std::f64::consts::PI;

    /// Four standard deviations of the volume of a digitised body, in voxels: each of the about
    /// `area` voxels on its boundary is in or out with an error spread evenly over ±½.
    fn tolerance(area: f64) -> f64 {
        4.0 * (area / 12.0).sqrt()
    }

    #[test]
    fn a_ball_has_its_volume_at_any_spacing() {
        let radius = 20.0;
        let area = 4.0 * PI * radius * radius;
        for spacing in [[1.0; 3], [1.0, 0.5, 2.0]] {
            let dims = spacing.map(|s: f64| (48.0 / s) as usize);
            let grid = Grid::new(dims, spacing).unwrap();
            let volume = ball(&grid, [23.4, 23.7, 24.2], radius).unwrap();
            let voxel_volume = volume.count() as f64 * grid.voxel_volume();
            assert!((voxel_volume - radius * area / 3.0).abs() < tolerance(area));
        }
    }

    #[test]
    fn a_mirrored_and_sheared_frame_leaves_the_ball_in_place() {
        let affine = [[-1.0, 0.2, 0.0, 30.0], [0.1, 1.1, 0.3, -25.0], [0.0, 0.1, 0.9, -20.0]];
        let grid = Grid::with_affine([60, 50, 50], affine).unwrap();
        let radius = 12.0;
        let volume = ball(&grid, grid.point([30.0, 25.0, 25.0]), radius).unwrap();
        let area = 4.0 * PI * radius * radius;
        let voxel_volume = volume.count() as f64 * grid.voxel_volume();
        assert!((voxel_volume - radius * area / 3.0).abs() < tolerance(area));
    }

    #[test]
    fn box_and_ellipsoid_keep_their_volume_when_turned() {
        let grid = Grid::new([64; 3], [1.0; 3]).unwrap();
        let centre = [31.6, 31.8, 32.1];
        let (sides, half_axes) = ([31.3, 19.7, 12.9], [24.0, 14.0, 9.0]);
        let [a, b, c] = sides;
        let box_area = 2.0 * (a * b + b * c + c * a);
        let ellipsoid_volume = 4.0 / 3.0 * PI * half_axes.iter().product::<f64>();
        // The bounding box of the ellipsoid has more area than the ellipsoid.
        let ellipsoid_area = 8.0 * (24.0 * 14.0 + 14.0 * 9.0 + 9.0 * 24.0);
        for (axis, angle) in [([1.0, 2.0, 3.0], 0.7), ([-1.0, 0.3, 0.2], 2.2), ([1.0; 3], 4.0)] {
            let turn = rotation::rotation(axis, angle).unwrap();
            let count = cuboid(&grid, centre, sides, &turn).unwrap().count() as f64;
            assert!((count - a * b * c).abs() < tolerance(box_area), "box: {count}");
            let count = ellipsoid(&grid, centre, half_axes, &turn).unwrap().count() as f64;
            assert!((count - ellipsoid_volume).abs() < tolerance(ellipsoid_area), "{count}");
        }
    }

    #[test]
    fn a_quarter_turn_swaps_the_sides_of_a_box() {
        let grid = Grid::new([20, 30, 10], [1.0; 3]).unwrap();
        let turn = rotation::rotation([0.0, 0.0, 1.0], PI / 2.0).unwrap();
        let centre = [10.0, 15.0, 5.0];
        let turned = cuboid(&grid, centre, [20.5, 10.5, 4.5], &turn).unwrap();
        assert_eq!(turned, cuboid(&grid, centre, [10.5, 20.5, 4.5], &IDENTITY).unwrap());
        assert_eq!(turned.count(), 11 * 21 * 5);
    }

    #[test]
    fn blocks_have_the_points_asked_for() {
        let grid = Grid::new([70, 5, 6], [1.0; 3]).unwrap();
        let rod = block(&grid, [3, 2, 1], [66, 1, 1]).unwrap();
        assert_eq!(rod.count(), 66);
        assert!(rod.get([3, 2, 1]) && rod.get([68, 2, 1]) && !rod.get([69, 2, 1]));
        assert!(block(&grid, [4, 2, 1], [67, 1, 1]).is_err());
        assert!(block(&grid, [0; 3], [1, 0, 1]).is_err());
        assert!(block(&grid, [usize::MAX; 3], [1; 3]).is_err());
    }
}
