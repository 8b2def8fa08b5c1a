//! Where a NIfTI header places its voxels: the three methods of the standard.

use std::path::Path;

use crate::error::Error;
use crate::volume::{Frame, affine_of, diagonal};

/// The fields of a header that place the lattice in the world.
pub(super) struct Placement {
    /// Number of dimensions of the file; the spacing of further axes means nothing.
    pub(super) dimensions: i64,
    /// The sign of axis z, then the spacings.
    pub(super) pixdim: [f64; 8],
    pub(super) qform_code: i32,
    pub(super) sform_code: i32,
    /// b, c, d of the unit quaternion a + bi + cj + dk.
    pub(super) quaternion: [f64; 3],
    pub(super) offset: [f64; 3],
    /// The three rows of the affine of method 3.
    pub(super) rows: [[f64; 4]; 3],
}

impl Placement {
    /// Index-to-world map and its frame: the sform if there is one (method 3), else the qform
    /// (method 2), else the bare spacings with the first voxel at the origin (method 1).
    ///
    /// Method 1 is the standard's, for files that know no orientation; nibabel then centres the
    /// volume and mirrors x, which the standard does not ask for.
    pub(super) fn affine(&self, dims: [usize; 3], unit: &str) -> ([[f64; 4]; 3], Frame) {
        if self.sform_code > 0 {
            (self.rows, Frame::new("RAS", unit, "sform"))
        } else if self.qform_code > 0 {
            (self.qform(dims), Frame::new("RAS", unit, "qform"))
        } else {
            let affine = affine_of(diagonal(self.spacing(dims)), [0.0; 3]);
            (affine, Frame::new("index", unit, "pixdim"))
        }
    }

    /// Spacings, where they are used, must be positive: mirroring is the business of `pixdim[0]`.
    pub(super) fn check(&self, path: &Path, dims: [usize; 3]) -> Result<(), Error> {
        let spacing = self.spacing(dims);
        if self.sform_code > 0 || spacing.iter().all(|s| *s > 0.0) {
            return Ok(());
        }
        let cause = shrouds::Error::Frame(format!("with spacing {spacing:?}"));
        Err(Error::Lattice { path: path.into(), cause })
    }

    /// Spacings of the lattice: 1 along an axis that the file does not have, or of which it has one
    /// point and no spacing.
    fn spacing(&self, dims: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| match self.pixdim[axis + 1] {
            _ if axis as i64 >= self.dimensions => 1.0,
            0.0 if dims[axis] == 1 => 1.0,
            spacing => spacing,
        })
    }

    /// Rotation of the unit quaternion, columns scaled by the spacing, z turned around when
    /// `pixdim[0]` is negative.
    pub(super) fn qform(&self, dims: [usize; 3]) -> [[f64; 4]; 3] {
        let [b, c, d] = self.quaternion;
        // Rounding may leave a vector part a little longer than 1: then it is a half turn.
        let squares = b * b + c * c + d * d;
        let a = (1.0 - squares).max(0.0).sqrt();
        let norm = (a * a + squares).sqrt();
        let [a, b, c, d] = [a, b, c, d].map(|x| x / norm);
        let columns = [
            [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
            [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
            [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c],
        ];
        let mut scale = self.spacing(dims);
        if self.pixdim[0] < 0.0 {
            scale[2] = -scale[2];
        }
        let columns = std::array::from_fn(|axis| columns[axis].map(|x| x * scale[axis]));
        affine_of(columns, self.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMS: [usize; 3] = [4, 3, 2];

    fn placement(quaternion: [f64; 3], sign: f64) -> Placement {
        Placement {
            dimensions: 3,
            pixdim: [sign, 2.0, 3.0, 5.0, 0.0, 0.0, 0.0, 0.0],
            qform_code: 1,
            sform_code: 0,
            quaternion,
            offset: [10.0, 20.0, 30.0],
            rows: [[0.5, 0.0, 0.0, 1.0], [0.0, 0.0, 0.5, 2.0], [0.0, 0.5, 0.0, 3.0]],
        }
    }

    fn assert_near(left: [[f64; 4]; 3], right: [[f64; 4]; 3]) {
        for (l, r) in left.iter().flatten().zip(right.iter().flatten()) {
            assert!((l - r).abs() < 1e-12, "{left:?} {right:?}");
        }
    }

    #[test]
    fn the_qform_turns_by_hand_worked_angles() {
        let half = 0.5f64.sqrt();
        let cases = [
            ([0.0; 3], [[2.0, 0.0, 0.0, 10.0], [0.0, 3.0, 0.0, 20.0], [0.0, 0.0, 5.0, 30.0]]),
            // A quarter turn about z brings x to y and y to -x.
            (
                [0.0, 0.0, half],
                [[0.0, -3.0, 0.0, 10.0], [2.0, 0.0, 0.0, 20.0], [0.0, 0.0, 5.0, 30.0]],
            ),
            // A quarter turn about x brings y to z and z to -y.
            (
                [half, 0.0, 0.0],
                [[2.0, 0.0, 0.0, 10.0], [0.0, 0.0, -5.0, 20.0], [0.0, 3.0, 0.0, 30.0]],
            ),
            // A half turn about y, with the vector part a little too long.
            (
                [0.0, 1.000_000_1, 0.0],
                [[-2.0, 0.0, 0.0, 10.0], [0.0, 3.0, 0.0, 20.0], [0.0, 0.0, -5.0, 30.0]],
            ),
            // A third of a turn about (1, 1, 1) brings x to y, y to z, z to x.
            ([0.5; 3], [[0.0, 0.0, 5.0, 10.0], [2.0, 0.0, 0.0, 20.0], [0.0, 3.0, 0.0, 30.0]]),
        ];
        for (quaternion, expected) in cases {
            assert_near(placement(quaternion, 1.0).affine(DIMS, "mm").0, expected);
            // A sign of 0 counts as 1, one of -1 turns the third column around.
            assert_near(placement(quaternion, 0.0).affine(DIMS, "mm").0, expected);
            let mirrored = expected.map(|[x, y, z, shift]| [x, y, -z, shift]);
            assert_near(placement(quaternion, -1.0).affine(DIMS, "mm").0, mirrored);
        }
    }

    #[test]
    fn the_sform_goes_before_the_qform_and_that_before_the_spacings() {
        let mut file = placement([0.0; 3], -1.0);
        assert_eq!(file.affine(DIMS, "mm").1, Frame::new("RAS", "mm", "qform"));
        file.sform_code = 2;
        assert_eq!(file.affine(DIMS, "um"), (file.rows, Frame::new("RAS", "um", "sform")));
        (file.sform_code, file.qform_code) = (0, 0);
        let bare = [[2.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 5.0, 0.0]];
        assert_eq!(file.affine(DIMS, "mm"), (bare, Frame::new("index", "mm", "pixdim")));
        (file.dimensions, file.pixdim[3]) = (2, 0.0);
        assert_eq!(file.affine(DIMS, "mm").0[2], [0.0, 0.0, 1.0, 0.0]);
    }
}
