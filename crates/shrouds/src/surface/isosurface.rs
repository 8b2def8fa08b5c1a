//! Where the isosurface of grey values crosses the grid edges.

use crate::error::Error;
use crate::surface::Surface;
use crate::volume::{Border, Voxel};

impl Surface {
    /// δ of every vertex where the linear interpolation of `values` along its grid edge passes through
    /// `level`; the surface is that of the values above it.
    ///
    /// `values` holds one value per lattice point of the volume, x fastest, then y, then z; the layer
    /// around a closed border has none. Where an end has no value, or both have the same one, the
    /// vertex is in the middle; values on the wrong side of the level put it at the end.
    ///
    /// # Errors
    /// [`Error::Length`] when the number of values is not that of the lattice points of the volume.
    pub fn isosurface_deltas<T: Voxel>(&self, values: &[T], level: f64) -> Result<Vec<f64>, Error> {
        let margin = usize::from(self.border() == Border::Closed);
        // An image has no layers along z.
        let margins = self.grid().dims().map(|n| if n > 1 { margin } else { 0 });
        let dims: [usize; 3] = std::array::from_fn(|d| self.grid().dims()[d] - 2 * margins[d]);
        let points = dims.iter().product();
        if values.len() != points {
            return Err(Error::Length { values: values.len(), dims, points });
        }
        let value = |point: [usize; 3]| {
            let [i, j, k]: [usize; 3] = std::array::from_fn(|d| point[d].wrapping_sub(margins[d]));
            let is_there = i < dims[0] && j < dims[1] && k < dims[2];
            is_there.then(|| values[(k * dims[1] + j) * dims[0] + i].as_f64())
        };
        let delta = |inside: Option<f64>, outside: Option<f64>| {
            let (inside, outside) = (inside? - level, outside? - level);
            let share = outside / (outside - inside);
            share.is_finite().then(|| share.clamp(0.0, 1.0))
        };
        let crossings = self.crossings();
        Ok(crossings.map(|c| delta(value(c.inside()), value(c.outside())).unwrap_or(0.5)).collect())
    }
}
