//! Stage 0: the lattice and its place in the world.
//!
//! A voxel *is* its lattice point: index `(i, j, k)` means the centre of that voxel, and there is no
//! half-voxel shift anywhere. This module is the only owner of coordinates.

mod compare;
mod window;

use crate::error::Error;

/// Dimensions, spacing and world frame of a lattice.
///
/// `affine` maps an index `(i, j, k)` to world coordinates: row `r` gives
/// `a[r][0]·i + a[r][1]·j + a[r][2]·k + a[r][3]`. The spacing along an axis is the length of that
/// axis' column. Lengths in the energies come from the spacing, as if the axes were orthogonal;
/// positions come from the whole affine, shear included.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    dims: [usize; 3],
    spacing: [f64; 3],
    affine: [[f64; 4]; 3],
}

impl Grid {
    /// Largest number of lattice points along one axis (a crossing packs its index into 64 bits).
    pub const MAX_DIM: usize = (1 << 20) - 2;

    /// A lattice of `dims` points (x, y, z) with the first point at the origin and the axes along
    /// those of the world.
    ///
    /// # Errors
    /// [`Error::Dimensions`] when a dimension is 0 or above [`Grid::MAX_DIM`]; [`Error::Frame`] when
    /// a spacing is not positive and finite.
    pub fn new(dims: [usize; 3], spacing: [f64; 3]) -> Result<Self, Error> {
        let affine =
            std::array::from_fn(|r| std::array::from_fn(|c| if r == c { spacing[r] } else { 0.0 }));
        if spacing.iter().any(|s| *s <= 0.0) {
            return Err(Error::Frame(format!("with spacing {spacing:?}")));
        }
        Self::with_affine(dims, affine)
    }

    /// A lattice of `dims` points whose index-to-world map is `affine`.
    ///
    /// # Errors
    /// [`Error::Dimensions`] as for [`Grid::new`]; [`Error::Frame`] when the affine is not finite or
    /// its axes are not independent.
    pub fn with_affine(dims: [usize; 3], affine: [[f64; 4]; 3]) -> Result<Self, Error> {
        if dims.iter().any(|&n| n == 0 || n > Self::MAX_DIM)
            || dims.iter().try_fold(1usize, |a, &n| a.checked_mul(n)).is_none()
        {
            return Err(Error::Dimensions { dims, limit: Self::MAX_DIM });
        }
        let spacing: [f64; 3] = std::array::from_fn(|c| {
            (0..3).map(|r| affine[r][c] * affine[r][c]).sum::<f64>().sqrt()
        });
        let grid = Self { dims, spacing, affine };
        let relative_volume = grid.determinant() / spacing.iter().product::<f64>();
        let usable = affine.iter().flatten().all(|x| x.is_finite())
            && spacing.iter().all(|s| *s > 0.0)
            && relative_volume.abs() > 1e-6;
        if usable { Ok(grid) } else { Err(Error::Frame(format!("{affine:?}"))) }
    }

    /// Lattice points along x, y, z.
    #[inline]
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Distance between neighbouring lattice points along x, y, z, in world units.
    pub fn spacing(&self) -> [f64; 3] {
        self.spacing
    }

    /// The smallest of the three spacings: the unit of length inside the energies.
    pub fn min_spacing(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Index-to-world map, three rows of four.
    pub fn affine(&self) -> [[f64; 4]; 3] {
        self.affine
    }

    /// Number of lattice points.
    pub fn point_count(&self) -> usize {
        self.dims.iter().product()
    }

    /// Checks that there is one value per lattice point.
    pub(crate) fn check_length(&self, values: usize) -> Result<(), Error> {
        let (dims, points) = (self.dims, self.point_count());
        if values == points { Ok(()) } else { Err(Error::Length { values, dims, points }) }
    }

    /// Volume of one voxel in cubic world units.
    pub fn voxel_volume(&self) -> f64 {
        self.determinant().abs()
    }

    /// Whether the index axes form a left-handed frame in the world, so that winding must flip.
    pub fn is_mirrored(&self) -> bool {
        self.determinant() < 0.0
    }

    /// World position of an index, which need not be whole.
    #[inline]
    pub fn point(&self, index: [f64; 3]) -> [f64; 3] {
        let a = &self.affine;
        std::array::from_fn(|r| {
            a[r][0] * index[0] + a[r][1] * index[1] + a[r][2] * index[2] + a[r][3]
        })
    }

    /// World vector of an index difference.
    pub fn vector(&self, step: [f64; 3]) -> [f64; 3] {
        let a = &self.affine;
        std::array::from_fn(|r| a[r][0] * step[0] + a[r][1] * step[1] + a[r][2] * step[2])
    }

    /// The map from world positions to indices: the inverse of [`Grid::point`], three rows of four.
    pub fn inverse_affine(&self) -> [[f64; 4]; 3] {
        let a = &self.affine;
        let det = self.determinant();
        // Row r of the inverse is the cross product of the other two columns over the determinant.
        std::array::from_fn(|r| {
            let (u, v) = ((r + 1) % 3, (r + 2) % 3);
            let cross: [f64; 3] = std::array::from_fn(|k| {
                let (x, y) = ((k + 1) % 3, (k + 2) % 3);
                (a[x][u] * a[y][v] - a[y][u] * a[x][v]) / det
            });
            let shift = -(0..3).map(|k| cross[k] * a[k][3]).sum::<f64>();
            [cross[0], cross[1], cross[2], shift]
        })
    }

    fn determinant(&self) -> f64 {
        let a = &self.affine;
        a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
            - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
            + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const OBLIQUE: [[f64; 4]; 3] =
        [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];

    #[test]
    fn a_voxel_is_its_lattice_point() {
        let grid = Grid::new([4, 5, 6], [1.0, 2.0, 5.0]).unwrap();
        assert_eq!(grid.point([1.0, 1.0, 1.0]), [1.0, 2.0, 5.0]);
        assert_eq!(grid.spacing(), [1.0, 2.0, 5.0]);
        assert_eq!(grid.voxel_volume(), 10.0);
        assert!(!grid.is_mirrored());
    }

    #[test]
    fn the_inverse_brings_points_back() {
        let grid = Grid::with_affine([9, 9, 9], OBLIQUE).unwrap();
        assert!(grid.is_mirrored());
        let inverse = grid.inverse_affine();
        let world = grid.point([3.0, 7.5, 1.25]);
        for (row, expected) in inverse.iter().zip([3.0, 7.5, 1.25]) {
            let index = row[0] * world[0] + row[1] * world[1] + row[2] * world[2] + row[3];
            assert!((index - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn unusable_frames_are_refused() {
        assert!(matches!(Grid::new([0, 1, 1], [1.0; 3]), Err(Error::Dimensions { .. })));
        assert!(matches!(Grid::new([1 << 21, 1, 1], [1.0; 3]), Err(Error::Dimensions { .. })));
        for spacing in [[0.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, f64::NAN, 1.0]] {
            assert!(matches!(Grid::new([2; 3], spacing), Err(Error::Frame(_))));
        }
        let mut flat = OBLIQUE;
        for row in &mut flat {
            row[2] = row[1];
        }
        assert!(matches!(Grid::with_affine([2; 3], flat), Err(Error::Frame(_))));
    }
}
