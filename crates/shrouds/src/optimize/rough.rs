//! Where the surface need not be smooth.

use std::sync::Arc;

use crate::error::Error;
use crate::parallel;
use crate::surface::Surface;
use crate::volume::{Border, Occupancy};

/// Factors for an energy that does not count at vertices near marked lattice points: 0 where an end of
/// the grid edge is marked, 1 elsewhere.
pub(super) fn factors(surface: &Surface, marked: &Occupancy) -> Result<Arc<[f32]>, Error> {
    // The grid of the surface has one more layer on all sides when the border is closed; images have
    // it along x and y and call their border open.
    let (dims, given) = (surface.grid().dims(), marked.grid().dims());
    let beyond = [0, 1, 2].map(|k| dims[k].wrapping_sub(given[k]));
    let is_closed = surface.border() == Border::Closed;
    let layer = match beyond {
        [0, 0, 0] if !is_closed => [0; 3],
        [2, 2, 2] if is_closed => [1; 3],
        [2, 2, 0] if dims[2] == 1 => [1, 1, 0],
        _ => {
            let value = format!("of {given:?} points");
            let range = "on the grid of the volume";
            return Err(Error::Setting { name: "mask of rough places", value, range });
        }
    };
    let is_marked = |point: [usize; 3]| {
        let there = [0, 1, 2].map(|k| point[k].wrapping_sub(layer[k]));
        (0..3).all(|k| there[k] < given[k]) && marked.get(there)
    };
    let mut factors = vec![1.0; surface.vertex_count()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut factors, ends, |k, factors| {
        for (factor, crossing) in factors.iter_mut().zip(surface.slice_crossings(k)) {
            if is_marked(crossing.inside()) || is_marked(crossing.outside()) {
                *factor = 0.0;
            }
        }
    });
    Ok(factors.into())
}
