//! Volumes that no memory holds: layer after layer.

use std::ops::Range;
use std::path::Path;

use shrouds::volume::Filler;
use shrouds::{Error as LatticeError, Occupancy, Select};

use crate::error::Error;
use crate::volume::{Unread, VolumeOptions, no_layer, open};

/// Reads a volume as [`read_occupancy`](crate::read_occupancy) does, `thickness` slices at a time, and hands each such layer to
/// `take` with its place along x, y, z. Layers are normal to z, or to x in files whose last axis is z.
///
/// # Errors
/// As for [`read_occupancy`](crate::read_occupancy), of several layers of segments too when none is named; those of `take`.
///
/// # Panics
/// When `thickness` is 0.
pub fn read_layers<E: From<Error>>(
    path: impl AsRef<Path>,
    options: &VolumeOptions,
    select: &Select,
    thickness: usize,
    mut take: impl FnMut([Range<usize>; 3], Occupancy) -> Result<(), E>,
) -> Result<(), E> {
    let path = path.as_ref();
    let Unread { grid, contents, mut slabs, z_fastest, scaling, .. } = open(path, options)?;
    if contents.layers > 1 && options.layer.is_none() {
        return Err(no_layer(path, &contents).into());
    }
    let dims = grid.dims();
    let axis = if z_fastest { 0 } else { 2 };
    let slice = grid.point_count() / dims[axis];
    let new_filler = if z_fastest { Filler::z_fastest } else { Filler::new };
    let mut place = dims.map(|count| 0..count);
    place[axis] = 0..0;
    let mut current: Option<Filler> = None;
    let mut left = 0;
    while let Some(slab) = slabs.next()? {
        let slab = match scaling {
            Some((slope, shift)) => slab.scaled(slope, shift),
            None => slab,
        };
        let mut start = 0;
        while start < slab.len() {
            let filler = match &mut current {
                Some(filler) => filler,
                None => {
                    let first = place[axis].end;
                    place[axis] = first..dims[axis].min(first + thickness);
                    left = slice * place[axis].len();
                    let layer = grid.crop(place.clone());
                    let layer =
                        layer.map_err(|cause| Error::Lattice { path: path.into(), cause })?;
                    current.insert(new_filler(layer, select.clone()))
                }
            };
            let end = slab.len().min(start + left);
            slab.push_some_to(filler, start..end);
            left -= end - start;
            start = end;
            if left == 0
                && let Some(filler) = current.take()
            {
                let first = place[axis].start;
                let layer = filler.finish().map_err(|cause| Error::Values {
                    path: path.into(),
                    cause: moved(cause, axis, first),
                })?;
                take(place.clone(), layer)?;
            }
        }
    }
    Ok(())
}

/// The same about a voxel further along an axis.
fn moved(error: LatticeError, axis: usize, first: usize) -> LatticeError {
    match error {
        LatticeError::NotANumber { mut voxel, others } => {
            voxel[axis] += first;
            LatticeError::NotANumber { voxel, others }
        }
        error => error,
    }
}
