//! Volume in, shroud out.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use serde_json::{Map, Value};
use shrouds::check::{CheckSettings, check};
use shrouds::network::Network;
use shrouds::surface::Surface;
use shrouds::{Occupancy, Settings, Shroud, TriMesh, optimize, shroud_observed};
use shrouds_io::Precision;
use shrouds_report::measure::Body;

use crate::mesh::{Mesh, precision, triples};
use crate::report::{Report, Said};
use crate::volume::Volume;
use crate::work::{self, run_quietly};
use crate::{error, json};

/// What a shroud is made of besides its arrays.
#[pyclass(frozen, module = "shrouds._native")]
pub(crate) struct Made {
    volume: Arc<Occupancy>,
    surface: Arc<Surface>,
    settings: Settings,
    report: optimize::Report,
    times: shrouds::Times,
}

/// Vertices, faces, normals, δ and the rest.
type Arrays<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyArray2<u32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Made,
);

/// The curves of a family: their vertices one after another, where each begins and the last ends, and
/// which are closed.
type Curves<'py> =
    (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// The shroud of a volume with the settings that names and values ask for.
#[pyfunction]
#[pyo3(signature = (volume, given, threads, progress))]
pub(crate) fn shroud<'py>(
    py: Python<'py>,
    volume: &Volume,
    given: Vec<(String, String)>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Arrays<'py>> {
    let pairs = given.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    let settings = Settings::from_names(pairs).map_err(error::of_library)?;
    let volume = volume.occupancy.clone();
    let (inside, asked) = (volume.clone(), settings.clone());
    let shroud = work::run(py, threads, progress, move |teller| {
        shroud_observed(&inside, &asked, &mut |now| teller.tell(now))
    })?;
    let Shroud { surface, delta, mesh, report, times } = shroud.map_err(error::of_library)?;
    let TriMesh { vertices, triangles, normals } = mesh;
    Ok((
        positions(py, vertices, volume.grid().min_spacing())?,
        triples(py, triangles)?,
        triples(py, normals)?,
        delta.into_pyarray(py),
        Made { volume, surface: Arc::new(surface), settings, report, times },
    ))
}

/// The names of all settings.
#[pyfunction]
pub(crate) fn setting_names() -> Vec<&'static str> {
    Settings::named().into_iter().map(|setting| setting.name).collect()
}

#[pymethods]
impl Made {
    /// The report as JSON, the mesh checked against the voxels.
    fn report(
        &self,
        py: Python<'_>,
        mesh: &Mesh,
        said: Said,
        threads: Option<usize>,
    ) -> PyResult<String> {
        let checks = CheckSettings {
            border: self.settings.border,
            faces: self.settings.faces,
            all_axes: false,
            self_intersections: false,
        };
        let (mesh, volume) = (mesh.mesh.clone(), self.volume.clone());
        let start = std::time::Instant::now();
        let checked = run_quietly(py, threads, move || check(&mesh, &volume, &checks))?;
        let checked = checked.map_err(error::of_library)?;
        let seconds = start.elapsed().as_secs_f64();
        let settings = self.settings_by_name();
        json(&Report::new(
            &self.volume,
            said,
            settings,
            &self.report,
            self.times,
            &checked,
            seconds,
        ))
    }

    /// Everything that is measured, as JSON.
    fn measure(&self, py: Python<'_>, mesh: &Mesh, threads: Option<usize>) -> PyResult<String> {
        let (mesh, surface) = (mesh.mesh.clone(), self.surface.clone());
        let (kind, voxels) = (self.settings.mesh, Some(self.volume.count()));
        let measured = run_quietly(py, threads, move || {
            Body { mesh: &mesh, surface: Some(&surface), kind, voxels }.measure(None)
        })?;
        json(&measured.map_err(error::of_library)?)
    }

    /// The planar curves across x, y and z.
    fn network<'py>(&self, py: Python<'py>) -> PyResult<Vec<Curves<'py>>> {
        let surface = self.surface.clone();
        let families = run_quietly(py, None, move || {
            let mut families: [(Vec<u32>, Vec<i64>, Vec<bool>); 3] = Default::default();
            families.iter_mut().for_each(|(_, starts, _)| starts.push(0));
            for curve in Network::trace(&surface).curves() {
                let (vertices, starts, closed) = &mut families[curve.axis];
                vertices.extend(curve.vertices);
                starts.push(vertices.len() as i64);
                closed.push(curve.closed);
            }
            families
        })?;
        let arrays = families.into_iter().map(|(vertices, starts, closed)| {
            (vertices.into_pyarray(py), starts.into_pyarray(py), closed.into_pyarray(py))
        });
        Ok(arrays.collect())
    }
}

impl Made {
    /// The settings in force as the report has them: numbers as such, null for what has no meaning.
    fn settings_by_name(&self) -> Map<String, Value> {
        let in_force = self.settings.to_names();
        let value = |name| {
            let text = in_force.iter().find(|(known, _)| *known == name).map(|(_, text)| text);
            text.map_or(Value::Null, |text| match text.parse::<serde_json::Number>() {
                Ok(number) => number.into(),
                Err(_) => text.as_str().into(),
            })
        };
        setting_names().into_iter().map(|name| (name.to_owned(), value(name))).collect()
    }
}

/// Positions in 32 bits, or in 64 where those would move a vertex by too much.
fn positions<'py>(
    py: Python<'py>,
    vertices: Vec<[f64; 3]>,
    spacing: f64,
) -> PyResult<Bound<'py, PyAny>> {
    if precision(&vertices, spacing) == Precision::Double {
        return Ok(triples(py, vertices)?.into_any());
    }
    let vertices = vertices.into_iter().map(|vertex| vertex.map(|x| x as f32)).collect();
    Ok(triples::<f32>(py, vertices)?.into_any())
}
