//! NumPy arrays as volumes, without a copy on the way in.

use std::sync::Arc;

use numpy::ndarray::{ArrayView3, Axis, Slice};
use numpy::{Element, IntoPyArray, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rayon::ThreadPool;
use shrouds::volume::{Filler, Voxel};
use shrouds::{Grid, Occupancy, Select};

use crate::error;
use crate::work::pool;

/// Values packed between two looks at Ctrl-C, and gathered at a time where they do not follow each
/// other in memory.
const SLAB: usize = 1 << 22;

/// The lattice points that are inside: a bit each, x fastest, with the lattice.
#[pyclass(frozen, module = "shrouds._native")]
pub(crate) struct Volume {
    pub(crate) occupancy: Arc<Occupancy>,
}

#[pymethods]
impl Volume {
    /// The lattice points whose value is not 0, or one of the labels, or above the threshold. The array
    /// is indexed [z, y, x].
    #[new]
    #[pyo3(signature = (values, affine, labels, threshold, threads))]
    fn new(
        values: &Bound<'_, PyAny>,
        affine: [[f64; 4]; 3],
        labels: Option<Vec<i128>>,
        threshold: Option<f64>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let select = match (labels, threshold) {
            (Some(labels), _) => Select::Labels(labels),
            (None, Some(threshold)) => Select::Above(threshold),
            (None, None) => Select::NonZero,
        };
        let occupancy = occupancy(values, affine, &select, &pool(threads)?)?;
        Ok(occupancy.into())
    }

    /// Number of inside points.
    fn count(&self) -> u64 {
        self.occupancy.count()
    }

    /// The volume as an array indexed [z, y, x], 1 inside and 0 outside.
    fn to_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<bool>>> {
        let volume = &self.occupancy;
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

    /// The map from index to world, three rows of four.
    #[getter]
    fn affine(&self) -> [[f64; 4]; 3] {
        self.occupancy.grid().affine()
    }

    /// The smallest distance of neighbouring lattice points.
    #[getter]
    fn min_spacing(&self) -> f64 {
        self.occupancy.grid().min_spacing()
    }
}

impl From<Occupancy> for Volume {
    fn from(occupancy: Occupancy) -> Self {
        Self { occupancy: Arc::new(occupancy) }
    }
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
