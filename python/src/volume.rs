//! Volumes out of volumes, meshes, files and bytes.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use shrouds::volume::Operation;
use shrouds::voxelize::{Fit, Rule, grid_for, voxelize};
use shrouds::{Grid, Occupancy, Select};
use shrouds_io::{Axes, VolumeOptions};

use crate::array::{occupancy, of_values, to_array};
use crate::error;
use crate::mesh::Mesh;
use crate::packed::settings;
use crate::pool::pool;
use crate::work::run_quietly;

/// The lattice points that are inside: a bit each, x fastest, with the lattice.
#[pyclass(frozen, module = "shrouds._native")]
pub(crate) struct Volume {
    pub(crate) occupancy: Arc<Occupancy>,
}

impl From<Occupancy> for Volume {
    fn from(occupancy: Occupancy) -> Self {
        Self { occupancy: Arc::new(occupancy) }
    }
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
        Ok(occupancy(values, affine, &select, &*pool(threads)?)?.into())
    }

    /// Number of inside points.
    fn count(&self) -> u64 {
        self.occupancy.count()
    }

    /// The volume as an array indexed [z, y, x].
    fn to_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<bool>>> {
        to_array(py, &self.occupancy)
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

    /// The box of its inside points with a margin, as far as there are points.
    fn cropped(&self, margin: usize) -> PyResult<Self> {
        let Some(bounds) = self.occupancy.bounding_box() else {
            return Ok(Self { occupancy: self.occupancy.clone() });
        };
        let dims = self.occupancy.grid().dims();
        made(self.occupancy.crop(std::array::from_fn(|d| {
            bounds[d].start.saturating_sub(margin)..dims[d].min(bounds[d].end + margin)
        })))
    }

    /// The connected components, in the order of their first points.
    fn components(&self, py: Python<'_>, faces: &str) -> PyResult<Vec<Self>> {
        let faces = faces.parse().map_err(error::of_library)?;
        let volume = self.occupancy.clone();
        let parts = run_quietly(py, None, move || {
            let components = volume.components(faces);
            (0..components.count()).map(|n| components.select(|m| m == n).into()).collect()
        })?;
        Ok(parts)
    }

    /// What `operation` makes of this volume and another one.
    fn combine(&self, py: Python<'_>, operation: &str, other: &Self) -> PyResult<Self> {
        let operation = match operation {
            "union" => Operation::Union,
            "intersect" => Operation::Intersect,
            "subtract" => Operation::Subtract,
            "xor" => Operation::Xor,
            _ => return Err(no_choice("operation", operation, "union, intersect, subtract, xor")),
        };
        let (a, b) = (self.occupancy.clone(), other.occupancy.clone());
        made(run_quietly(py, None, move || a.combine(operation, &b))?)
    }

    /// Grown, or shrunk, by a distance, on a lattice with room for it unless that is to stay.
    fn offset(
        &self,
        py: Python<'_>,
        by: f64,
        border: &str,
        keep_lattice: bool,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let border = border.parse().map_err(error::of_library)?;
        let volume = self.occupancy.clone();
        made(run_quietly(py, threads, move || match keep_lattice {
            true => volume.offset(by, border),
            false => volume.padded_for(by)?.offset(by, border),
        })?)
    }

    /// The bytes of a `.shroud` file.
    #[expect(clippy::too_many_arguments, reason = "the program has as many options")]
    fn pack<'py>(
        &self,
        py: Python<'py>,
        profile: &str,
        faces: &str,
        border: &str,
        frame: String,
        unit: String,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let faces = faces.parse().map_err(error::of_library)?;
        let border = border.parse().map_err(error::of_library)?;
        let settings = settings(profile, faces, border, frame, unit)?;
        let volume = self.occupancy.clone();
        let bytes = run_quietly(py, threads, move || {
            let mut bytes = Vec::new();
            shrouds_codec::pack(&volume, &settings, &mut bytes).map(|_| bytes)
        })?;
        Ok(PyBytes::new(py, &bytes.map_err(error::of_codec)?))
    }

    /// The volume in the bytes of a `.shroud` file, with the names of its world and its unit.
    #[staticmethod]
    fn unpack(
        py: Python<'_>,
        bytes: Vec<u8>,
        threads: Option<usize>,
    ) -> PyResult<(Self, String, String)> {
        let unpacked = run_quietly(py, threads, move || shrouds_codec::unpack(&bytes[..]))?;
        let unpacked = unpacked.map_err(error::of_codec)?;
        Ok((unpacked.volume.into(), unpacked.header.space, unpacked.header.unit))
    }

    /// The lattice points inside a mesh, and what is to be said about it.
    #[staticmethod]
    fn voxelize(
        py: Python<'_>,
        mesh: &Mesh,
        affine: [[f64; 4]; 3],
        dims: [usize; 3],
        winding: &str,
        threads: Option<usize>,
    ) -> PyResult<(Self, Vec<String>)> {
        let rule = match winding {
            "non-zero" => Rule::NonZero,
            "positive" => Rule::Positive,
            "odd" => Rule::Odd,
            _ => return Err(no_choice("winding", winding, "non-zero, positive, odd")),
        };
        let grid = Grid::with_affine(dims, affine).map_err(error::of_library)?;
        let mesh = mesh.mesh.clone();
        let made = run_quietly(py, threads, move || voxelize(&mesh, &grid, rule))?;
        let made = made.map_err(error::of_library)?;
        Ok((made.volume.into(), made.report.notes()))
    }
}

/// Affine and dimensions (x, y, z) of a lattice for a mesh: with this spacing, or so many points along
/// its longest side.
#[pyfunction]
pub(crate) fn lattice_for(
    mesh: &Mesh,
    spacing: Option<[f64; 3]>,
    size: usize,
    margin: usize,
) -> PyResult<([[f64; 4]; 3], [usize; 3])> {
    let fit = spacing.map_or(Fit::Size(size), Fit::Spacing);
    let grid = grid_for(&mesh.mesh, fit, margin).map_err(error::of_library)?;
    Ok((grid.affine(), grid.dims()))
}

/// A volume file: its values indexed [z, y, x], affine, name of the world, unit and warnings.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "Python unpacks it at once")]
pub(crate) fn read_volume(
    py: Python<'_>,
    path: PathBuf,
    axes: &str,
    frame: Option<usize>,
    array: Option<String>,
    level: usize,
) -> PyResult<(Py<PyAny>, [[f64; 4]; 3], String, String, Vec<String>)> {
    let axes = match axes {
        "zyx" => Axes::Zyx,
        "xyz" => Axes::Xyz,
        _ => return Err(no_choice("axes", axes, "zyx, xyz")),
    };
    let volume = run_quietly(py, None, move || {
        let array = array.as_deref();
        let options = VolumeOptions { axes, layer: frame, array, level, ..Default::default() };
        shrouds_io::read_volume(path, &options)
    })?;
    let volume = volume.map_err(error::of_file)?;
    let [nx, ny, nz] = volume.grid.dims();
    let values = of_values(py, volume.values, [nz, ny, nx])?;
    let (frame, warnings) = (volume.frame, volume.contents.warnings);
    Ok((values, volume.grid.affine(), frame.name, frame.unit, warnings))
}

fn made(volume: Result<Occupancy, shrouds::Error>) -> PyResult<Volume> {
    volume.map(Volume::from).map_err(error::of_library)
}

pub(crate) fn no_choice(name: &str, value: &str, known: &str) -> PyErr {
    PyValueError::new_err(format!("{name} is {value:?}, but must be {known}"))
}
