//! What one lattice has in common with another, and whether its axes are at right angles.

use crate::error::Error;
use crate::grid::Grid;
use crate::vector::{Vector, dot, length, scale, subtract};

/// How far the points of lattices that count as one may lie apart, in units of the smallest spacing.
const SAME_PLACE: f64 = 1e-4;
/// Largest cosine between axes that count as orthogonal: distances are wrong by no larger a part.
const RIGHT_ANGLE: f64 = 1e-5;

impl Grid {
    /// Checks that `other` has the same lattice points: the same dimensions, and no point farther from
    /// its counterpart than 1e-4 of the smallest spacing.
    ///
    /// # Errors
    /// [`Error::DifferentLattices`] with everything that differs.
    pub fn check_same_lattice(&self, other: &Self) -> Result<(), Error> {
        let tolerance = SAME_PLACE * self.min_spacing().min(other.min_spacing());
        if self.dims == other.dims && self.corners_match(other, tolerance) {
            return Ok(());
        }
        let mut differences = Vec::new();
        let mut note = |differ: bool, what: &str, values: [String; 2]| {
            if differ {
                differences.push(format!("{what} {} and {}", values[0], values[1]));
            }
        };
        let both = [self, other];
        note(self.dims != other.dims, "dimensions", both.map(|g| format!("{:?}", g.dims)));
        // A corner is moved by its origin and, along each axis, by spacing and direction: if all seven
        // stay below a seventh, it stays in place.
        let tolerance = tolerance / 7.0;
        let steps: Vector = std::array::from_fn(|d| (self.dims[d] - 1) as f64);
        let spacing = (0..3)
            .any(|d| (self.spacing[d] - other.spacing[d]).abs() * steps[d].max(1.0) > tolerance);
        note(spacing, "spacing", both.map(|g| format!("{:?}", g.spacing)));
        let turned = |d: usize| length(subtract(self.direction(d), other.direction(d)));
        let orientation =
            (0..3).any(|d| turned(d) * self.spacing[d] * steps[d].max(1.0) > tolerance);
        let directions = |g: &Self| format!("{:?}", [0, 1, 2].map(|d| g.direction(d)));
        note(orientation, "directions of the axes", both.map(directions));
        let origins = both.map(|g| g.point([0.0; 3]));
        let origin = length(subtract(origins[0], origins[1])) > tolerance;
        note(origin, "origin", origins.map(|o| format!("{o:?}")));
        Err(Error::DifferentLattices { differences: differences.join(", ") })
    }

    /// Whether the corners of two lattices of the same dimensions lie in the same places; all points
    /// between them then do.
    fn corners_match(&self, other: &Self, tolerance: f64) -> bool {
        (0..8).all(|corner| {
            let index = std::array::from_fn(|d| ((corner >> d & 1) * (self.dims[d] - 1)) as f64);
            // An axis of one point must still have the same step: it is the voxel's extent.
            length(subtract(self.point(index), other.point(index))) <= tolerance
        }) && (0..3).all(|d| {
            let step = |g: &Self| g.affine.map(|row| row[d]);
            length(subtract(step(self), step(other))) <= tolerance
        })
    }

    /// Unit vector along an axis.
    fn direction(&self, axis: usize) -> Vector {
        scale(self.affine.map(|row| row[axis]), 1.0 / self.spacing[axis])
    }

    /// Checks that the axes are at right angles, so that distances follow from the spacing alone.
    ///
    /// # Errors
    /// [`Error::Sheared`] with the first two axes that are not.
    pub fn check_right_angles(&self) -> Result<(), Error> {
        for (a, b, axes) in [(0, 1, "x and y"), (0, 2, "x and z"), (1, 2, "y and z")] {
            let cosine = dot(self.direction(a), self.direction(b));
            if cosine.abs() > RIGHT_ANGLE {
                return Err(Error::Sheared { axes, degrees: cosine.acos().to_degrees() });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::tests::OBLIQUE;

    fn moved(change: impl Fn(&mut [[f64; 4]; 3])) -> Grid {
        let mut affine = OBLIQUE;
        change(&mut affine);
        Grid::with_affine([101, 9, 1], affine).unwrap()
    }

    fn difference(a: &Grid, b: &Grid) -> String {
        match a.check_same_lattice(b) {
            Ok(()) => String::new(),
            Err(Error::DifferentLattices { differences }) => differences,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn what_differs_is_named_with_both_values() {
        let grid = moved(|_| ());
        let near = moved(|a| (a[0][3], a[1][0]) = (a[0][3] + 4e-5, a[1][0] + 4e-7));
        assert_eq!(difference(&grid, &near), "");
        let shifted = difference(&grid, &moved(|a| a[2][3] += 0.5));
        assert_eq!(shifted, "origin [12.0, -40.0, 7.5] and [12.0, -40.0, 8.0]");
        // Far less than the tolerance a step, more than it at the last point.
        let drifting =
            difference(&grid, &moved(|a| a[0].iter_mut().take(1).for_each(|x| *x -= 2e-6)));
        assert!(drifting.starts_with("spacing [0.927"), "{drifting}");
        let mirrored = difference(&grid, &moved(|a| a.iter_mut().for_each(|row| row[2] = -row[2])));
        assert!(mirrored.starts_with("directions of the axes [["), "{mirrored}");
        let smaller = Grid::with_affine([101, 8, 1], OBLIQUE).unwrap();
        assert_eq!(difference(&grid, &smaller), "dimensions [101, 9, 1] and [101, 8, 1]");
    }

    #[test]
    fn every_difference_has_a_name() {
        let grid = moved(|_| ());
        for n in 0..12 {
            for size in [1e-7, 5e-7, 1e-6, 2e-5, 7e-5, 1e-3] {
                let other = moved(|a| a[n / 4][n % 4] += size);
                let same = grid.check_same_lattice(&other).is_ok();
                assert!(same == difference(&grid, &other).is_empty(), "{n} {size}");
            }
        }
    }

    #[test]
    fn shear_is_found() {
        let c = 0.6_f64;
        let turned = [[c, -0.8, 0.0, 1.0], [0.8, c, 0.0, 2.0], [0.0, 0.0, -3.0, 0.0]];
        Grid::with_affine([2; 3], turned).unwrap().check_right_angles().unwrap();
        let mut sheared = turned;
        sheared[0][2] = 3.0 / 3f64.sqrt() * c;
        sheared[1][2] = 3.0 / 3f64.sqrt() * 0.8;
        let error = Grid::with_affine([2; 3], sheared).unwrap().check_right_angles().unwrap_err();
        let Error::Sheared { axes: "x and z", degrees } = error else { panic!("{error}") };
        assert!((degrees - 60.0).abs() < 1e-9, "{degrees}");
    }
}
