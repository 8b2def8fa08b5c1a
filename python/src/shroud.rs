//! Volume in, shroud out.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use shrouds::surface::Surface;
use shrouds::{Occupancy, Settings, Shroud, Times, TriMesh, optimize, shroud_observed};

use crate::array::Volume;
use crate::error;
use crate::work;

/// Rounding to 32 bits may move a vertex by this part of the smallest spacing: a twentieth of the
/// distance that vertices keep from lattice points.
const ROUNDING: f64 = 1e-4;
/// Largest relative error of rounding to 32 bits.
const SINGLE: f64 = 1.0 / (1 << 24) as f64;

/// What a shroud is made of besides its arrays.
#[pyclass(frozen, module = "shrouds._native")]
#[expect(dead_code, reason = "the report and the network come from it")]
pub(crate) struct Made {
    volume: Arc<Occupancy>,
    surface: Surface,
    report: optimize::Report,
    times: Times,
}

/// Vertices, faces, normals, δ and the rest.
type Arrays<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyArray2<u32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Made,
);

/// The shroud of a volume.
#[pyfunction]
#[pyo3(signature = (volume, given, threads, progress))]
pub(crate) fn shroud<'py>(
    py: Python<'py>,
    volume: &Volume,
    given: Vec<(String, String)>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Arrays<'py>> {
    let settings = settings(&given)?;
    let volume = volume.occupancy.clone();
    let inside = volume.clone();
    let shroud = work::run(py, threads, progress, move |teller| {
        shroud_observed(&inside, &settings, &mut |now| teller.tell(now))
    })?;
    let Shroud { surface, delta, mesh, report, times } = shroud.map_err(error::of_library)?;
    let TriMesh { vertices, triangles, normals } = mesh;
    Ok((
        positions(py, vertices, volume.grid().min_spacing())?,
        triples(py, triangles)?,
        triples(py, normals)?,
        delta.into_pyarray(py),
        Made { volume, surface, report, times },
    ))
}

/// The settings that names and values ask for.
fn settings(given: &[(String, String)]) -> PyResult<Settings> {
    let pairs = given.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    Settings::from_names(pairs).map_err(error::of_library)
}

/// The names of all settings.
#[pyfunction]
pub(crate) fn setting_names() -> Vec<&'static str> {
    Settings::named().into_iter().map(|setting| setting.name).collect()
}

/// Positions in 32 bits, or in 64 where those would move a vertex by more than a ten-thousandth of a
/// voxel.
fn positions<'py>(
    py: Python<'py>,
    vertices: Vec<[f64; 3]>,
    spacing: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let largest = vertices.as_flattened().iter().fold(0.0, |max: f64, x| max.max(x.abs()));
    if largest * SINGLE > ROUNDING * spacing {
        return Ok(triples(py, vertices)?.into_any());
    }
    let vertices = vertices.into_iter().map(|vertex| vertex.map(|x| x as f32)).collect();
    Ok(triples::<f32>(py, vertices)?.into_any())
}

/// An array of `N × 3`, which takes over the memory.
fn triples<T: numpy::Element>(
    py: Python<'_>,
    rows: Vec<[T; 3]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    rows.into_flattened().into_pyarray(py).reshape([count, 3])
}
