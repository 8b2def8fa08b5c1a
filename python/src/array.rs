//! NumPy arrays as volumes, without a copy on the way in, and volumes as arrays.

use numpy::ndarray::{ArrayView3, Axis, Slice};
use numpy::{Element, IntoPyArray, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use shrouds::volume::{Filler, Voxel};
use shrouds::{Grid, Occupancy, Select};
use shrouds_io::Values;

use crate::error;

/// Values packed between two looks at Ctrl-C, and gathered at a time where they do not follow each
/// other in memory.
const SLAB: usize = 1 << 22;

/// A volume as an array indexed [z, y, x].
pub(crate) fn to_array<'py>(
    py: Python<'py>,
    volume: &Occupancy,
) -> PyResult<Bound<'py, PyArray3<bool>>> {
    let [nx, ny, nz] = volume.grid().dims();
    let values = py.detach(|| {
        let mut values = Vec::with_capacity(nx * ny * nz);
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            let row = volume.row(j, k);
            values.extend((0..nx).map(|i| row[i / 64] >> (i % 64) & 1 == 1));
        }
        values
    });
    values.into_pyarray(py).reshape([nz, ny, nx])
}

/// Values as an array indexed [z, y, x], which takes over their memory.
pub(crate) fn of_values(py: Python<'_>, values: Values, shape: [usize; 3]) -> PyResult<Py<PyAny>> {
    fn array<T: Element>(py: Python<'_>, v: Vec<T>, shape: [usize; 3]) -> PyResult<Py<PyAny>> {
        Ok(v.into_pyarray(py).reshape(shape)?.into_any().unbind())
    }
    match values {
        Values::Bool(v) => array(py, v, shape),
        Values::U8(v) => array(py, v, shape),
        Values::I8(v) => array(py, v, shape),
        Values::U16(v) => array(py, v, shape),
        Values::I16(v) => array(py, v, shape),
        Values::U32(v) => array(py, v, shape),
        Values::I32(v) => array(py, v, shape),
        Values::U64(v) => array(py, v, shape),
        Values::I64(v) => array(py, v, shape),
        Values::F32(v) => array(py, v, shape),
        Values::F64(v) => array(py, v, shape),
    }
}

/// The whole numbers of an array that is indexed [z, y, x], x fastest, and how many there are along x, y, z.
pub(crate) fn labels(values: &Bound<'_, PyAny>) -> PyResult<(Vec<i64>, [usize; 3])> {
    macro_rules! try_types {
        ($($label:ty),*) => {$(
            if let Ok(array) = values.extract::<PyReadonlyArray3<$label>>() {
                let array = array.as_array();
                let (nz, ny, nx) = array.dim();
                let labels = array.iter().map(|&label| i64::try_from(label));
                let labels = labels.collect::<Result<Vec<i64>, _>>().map_err(|_| {
                    PyValueError::new_err("a label is beyond those of 64 bits with a sign: relabel the array")
                })?;
                return Ok((labels, [nx, ny, nz]));
            }
        )*};
    }
    try_types!(u8, i8, u16, i16, u32, i32, u64, i64);
    let message = "labels are whole numbers: convert the array with array.astype";
    Err(PyValueError::new_err(message))
}

/// The selected points of an array that is indexed [z, y, x], of any strides and any type of
/// [`Voxel`]; `bool` comes as `uint8`, because its bytes need not be 0 or 1.
pub(crate) fn occupancy(
    values: &Bound<'_, PyAny>,
    affine: [[f64; 4]; 3],
    select: &Select,
    pool: &ThreadPool,
) -> PyResult<Occupancy> {
    macro_rules! try_types {
        ($($voxel:ty),*) => {$(
            if let Ok(array) = values.extract::<PyReadonlyArray3<$voxel>>() {
                return pack(values.py(), array.as_array(), affine, select, pool);
            }
        )*};
    }
    try_types!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);
    let message = "a NumPy array of three dimensions of integers or floats is wanted";
    Err(PyTypeError::new_err(message))
}

fn pack<T: Voxel + Element>(
    py: Python<'_>,
    values: ArrayView3<'_, T>,
    affine: [[f64; 4]; 3],
    select: &Select,
    pool: &ThreadPool,
) -> PyResult<Occupancy> {
    let (nz, ny, nx) = values.dim();
    let grid = Grid::with_affine([nx, ny, nz], affine).map_err(error::of_library)?;
    let strides = values.strides();
    let is_z_fastest = strides[0].unsigned_abs() < strides[2].unsigned_abs();
    let (slices, filler) = if is_z_fastest {
        (values.reversed_axes(), Filler::z_fastest(grid, select.clone()))
    } else {
        (values, Filler::new(grid, select.clone()))
    };
    let mut filler = filler;
    let (count, rows, length) = slices.dim();
    let thickness = (SLAB / (rows * length)).max(1);
    let mut gathered = Vec::new();
    for first in (0..count).step_by(thickness) {
        let range = Slice::from(first..count.min(first + thickness));
        let slab = slices.slice_axis(Axis(0), range);
        py.detach(|| {
            pool.install(|| match slab.as_slice() {
                Some(values) => filler.push_rows(values),
                None => {
                    gather(&slab, &mut gathered);
                    filler.push_rows(&gathered);
                }
            });
        });
        py.check_signals()?;
    }
    py.detach(|| pool.install(|| filler.finish())).map_err(error::of_library)
}

/// The values of a slab, one row after another.
fn gather<T: Copy>(slab: &ArrayView3<'_, T>, values: &mut Vec<T>) {
    values.clear();
    for row in slab.rows() {
        match row.as_slice() {
            Some(row) => values.extend_from_slice(row),
            None => values.extend(row.iter().copied()),
        }
    }
}
