//! Lattices made from others: padded, cropped, sliced, with another spacing.

use std::ops::Range;

use crate::error::Error;
use crate::grid::Grid;
use crate::vector::{cross, length, scale};

impl Grid {
    /// The same lattice with `margin` more points on all six sides; the points keep their places in
    /// the world, so their indices grow by `margin`.
    ///
    /// # Errors
    /// [`Error::Dimensions`] when the padded lattice is too large.
    pub fn padded(&self, margin: usize) -> Result<Self, Error> {
        self.padded_by([[margin; 2]; 3])
    }

    /// The same lattice with more points beyond the first and the last one along x, y, z; the points
    /// keep their places in the world.
    ///
    /// # Errors
    /// [`Error::Dimensions`] when the padded lattice is too large.
    pub fn padded_by(&self, margins: [[usize; 2]; 3]) -> Result<Self, Error> {
        let dims = std::array::from_fn(|d| {
            margins[d].iter().fold(self.dims[d], |n, &margin| n.saturating_add(margin))
        });
        // A closed border may exceed MAX_DIM by its layers: packing leaves room for them.
        if dims.iter().any(|&n| n > Self::MAX_DIM + 2) {
            return Err(Error::Dimensions { dims, limit: Self::MAX_DIM });
        }
        Ok(self.window(margins.map(|[before, _]| -(before as isize)), dims))
    }

    /// The lattice points whose indices along x, y, z lie in `ranges`, in their places in the world.
    ///
    /// # Errors
    /// [`Error::NoSuchPoints`] when a range is empty or leaves the lattice.
    pub fn crop(&self, ranges: [Range<usize>; 3]) -> Result<Self, Error> {
        for (axis, (range, &points)) in ranges.iter().zip(&self.dims).enumerate() {
            if range.is_empty() || range.end > points {
                let (axis, Range { start, end }) = (['x', 'y', 'z'][axis], range.clone());
                return Err(Error::NoSuchPoints { axis, start, end, points });
            }
        }
        Ok(self.window(ranges.each_ref().map(|r| r.start as isize), ranges.map(|r| r.len())))
    }

    /// The lattice of `dims` points whose first one has the index `first` here, in its place in the
    /// world.
    pub(crate) fn window(&self, first: [isize; 3], dims: [usize; 3]) -> Self {
        let mut affine = self.affine;
        let corner = self.point(first.map(|x| x as f64));
        for (row, x) in affine.iter_mut().zip(corner) {
            row[3] = x;
        }
        Self { dims, spacing: self.spacing, affine }
    }

    /// A lattice of another spacing in the same frame: its first point is the first point of this one,
    /// its axes point the same way, and there are as many points as it takes to reach the last one
    /// along each axis or to pass it by less than a step. Extents are those between points, that is
    /// between the centres of voxels.
    ///
    /// # Errors
    /// [`Error::Frame`] when a spacing is not positive and finite; [`Error::Dimensions`] when there
    /// would be more than [`Grid::MAX_DIM`] points along an axis.
    pub fn with_spacing(&self, spacing: [f64; 3]) -> Result<Self, Error> {
        if spacing.iter().any(|h| !(h.is_finite() && *h > 0.0)) {
            return Err(Error::Frame(format!("with spacing {spacing:?}")));
        }
        // A step that falls short by rounding is whole.
        let dims = std::array::from_fn(|d| {
            let steps = (self.dims[d] - 1) as f64 * self.spacing[d] / spacing[d];
            ((steps - 1e-6).ceil().max(0.0) as usize).saturating_add(1)
        });
        let mut affine = self.affine;
        for row in &mut affine {
            for d in 0..3 {
                row[d] *= spacing[d] / self.spacing[d];
            }
        }
        Self::with_affine(dims, affine)
    }

    /// A lattice of half as many points along each axis, rounded up, each in the middle of the up to
    /// eight points that are its own: those of indices 2i and 2i + 1 along each axis.
    ///
    /// # Errors
    /// None for a grid of some points.
    pub fn halved(&self) -> Result<Self, Error> {
        let affine =
            self.affine().map(|[a, b, c, d]| [2.0 * a, 2.0 * b, 2.0 * c, d + 0.5 * (a + b + c)]);
        Self::with_affine(self.dims().map(|count| count.div_ceil(2)), affine)
    }

    /// The lattice points of one slice, index `[i, j, 0]` of which has index `i` along axis `axis + 1`
    /// and `j` along `axis + 2` (modulo 3) of the whole, in their places in the world. Its third axis
    /// is normal to the slice, with the smaller spacing of the other two.
    pub(crate) fn slice(&self, axis: usize, index: usize) -> Self {
        let axes = [(axis + 1) % 3, (axis + 2) % 3];
        let [u, v] = axes.map(|c| self.affine.map(|row| row[c]));
        let spacing = axes.map(|c| self.spacing[c]);
        let step = spacing[0].min(spacing[1]);
        let normal = cross(u, v);
        let normal = scale(normal, step / length(normal));
        let mut corner = [0.0; 3];
        corner[axis] = index as f64;
        let corner = self.point(corner);
        Self {
            dims: [self.dims[axes[0]], self.dims[axes[1]], 1],
            spacing: [spacing[0], spacing[1], step],
            affine: std::array::from_fn(|r| [u[r], v[r], normal[r], corner[r]]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::tests::OBLIQUE;

    #[test]
    fn padding_keeps_points_in_place() {
        let grid = Grid::with_affine([9, 9, 9], OBLIQUE).unwrap();
        let padded = grid.padded(1).unwrap();
        for (a, b) in padded.point([4.0, 5.0, 6.0]).iter().zip(grid.point([3.0, 4.0, 5.0])) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn a_slice_stays_in_its_place() {
        let grid = Grid::with_affine([5, 6, 7], OBLIQUE).unwrap();
        for axis in 0..3 {
            let slice = grid.slice(axis, 2);
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            assert_eq!(slice.dims(), [grid.dims()[u], grid.dims()[v], 1]);
            let mut index = [0.0; 3];
            (index[axis], index[u], index[v]) = (2.0, 1.5, 4.0);
            for (a, b) in slice.point([1.5, 4.0, 0.0]).iter().zip(grid.point(index)) {
                assert!((a - b).abs() < 1e-12);
            }
            // It is a grid like any other.
            let again = Grid::with_affine(slice.dims(), slice.affine()).unwrap();
            let [x, y, z] = again.spacing();
            assert!((z - x.min(y)).abs() < 1e-12 && !again.is_mirrored());
            assert_eq!([x, y], [grid.spacing()[u], grid.spacing()[v]]);
        }
    }

    #[test]
    fn cropping_undoes_padding() {
        let grid = Grid::with_affine([4, 5, 6], OBLIQUE).unwrap();
        let padded = grid.padded_by([[1, 2], [0, 3], [70, 0]]).unwrap();
        assert_eq!(padded.dims(), [7, 8, 76]);
        let cropped = padded.crop([1..5, 0..5, 70..76]).unwrap();
        assert_eq!(cropped.dims(), grid.dims());
        cropped.check_same_lattice(&grid).unwrap();
        let error = grid.crop([0..4, 2..6, 0..6]).unwrap_err();
        assert_eq!(error, Error::NoSuchPoints { axis: 'y', start: 2, end: 6, points: 5 });
        assert!(grid.crop([0..4, 0..5, 3..3]).is_err());
        for margin in [Grid::MAX_DIM, usize::MAX] {
            assert!(matches!(grid.padded(margin), Err(Error::Dimensions { .. })));
        }
    }

    #[test]
    fn another_spacing_covers_the_same_points() {
        let grid = Grid::with_affine([10, 4, 1], OBLIQUE).unwrap();
        let [x, y, z] = grid.spacing();
        let finer = grid.with_spacing([x / 3.0, 2.0 * y, z / 7.0]).unwrap();
        assert_eq!(finer.dims(), [28, 3, 1]);
        for (a, b) in finer.point([27.0, 1.5, 0.0]).iter().zip(grid.point([9.0, 3.0, 0.0])) {
            assert!((a - b).abs() < 1e-12);
        }
        assert!(matches!(grid.with_spacing([1.0, 0.0, 1.0]), Err(Error::Frame(_))));
        assert!(matches!(grid.with_spacing([1.0, f64::NAN, 1.0]), Err(Error::Frame(_))));
        assert!(matches!(grid.with_spacing([1e-9, 1.0, 1.0]), Err(Error::Dimensions { .. })));
    }
}
