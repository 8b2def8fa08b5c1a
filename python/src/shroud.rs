//! Volume in, shroud out.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::{Map, Value};
use shrouds::check::{CheckSettings, check};
use shrouds::energy::{Parameter, catalogue, with_parameter};
use shrouds::network::Network;
use shrouds::surface::Surface;
use shrouds::{Occupancy, Settings, Shroud, TriMesh, optimize, shroud_observed};
use shrouds_report::measure::Body;

use crate::mesh::{Mesh, positions, triples};
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
pub(crate) type Arrays<'py> = (
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

/// The shroud of a volume with the settings that names and values ask for, which need not be smooth near the
/// points of `rough`.
#[pyfunction]
#[pyo3(signature = (volume, given, rough, threads, progress))]
pub(crate) fn shroud<'py>(
    py: Python<'py>,
    volume: &Volume,
    given: Vec<(String, String)>,
    rough: Option<&Volume>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Arrays<'py>> {
    let mut settings = settings_of(&given)?;
    settings.optimize.rough = rough.map(|rough| rough.occupancy.clone());
    make(py, volume.occupancy.clone(), settings, threads, progress)
}

/// The settings that names and values ask for.
pub(crate) fn settings_of(given: &[(String, String)]) -> PyResult<Settings> {
    let pairs = given.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    Settings::from_names(pairs).map_err(error::of_library)
}

/// The shroud of a volume.
pub(crate) fn make<'py>(
    py: Python<'py>,
    volume: Arc<Occupancy>,
    settings: Settings,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Arrays<'py>> {
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

/// The text of an energy whose measures have this parametrisation where they are written without.
#[pyfunction]
pub(crate) fn energy_with(text: &str, parameter: &str) -> PyResult<String> {
    let known = Parameter::ALL.into_iter().find(|known| known.name() == parameter);
    let Some(known) = known else {
        let names = Parameter::ALL.map(Parameter::name).join(", ");
        let message = format!("parameter is {parameter:?}, but must be {names}");
        return Err(PyValueError::new_err(message));
    };
    with_parameter(text, known).ok_or_else(|| {
        let names = catalogue().iter().filter(|entry| entry.takes_parameter());
        let names: Vec<&str> = names.map(|entry| entry.name).collect();
        PyValueError::new_err(format!(
            "parameter cannot go into the energy {text:?}: leave it out, or choose an energy with {}",
            names.join(" or ")
        ))
    })
}

/// The area in which two bodies touch.
#[pyfunction]
pub(crate) fn contact_area(
    py: Python<'_>,
    one: &Volume,
    other: &Volume,
    given: Vec<(String, String)>,
    threads: Option<usize>,
) -> PyResult<f64> {
    let settings = settings_of(&given)?;
    let (one, other) = (one.occupancy.clone(), other.occupancy.clone());
    let area =
        run_quietly(py, threads, move || shrouds::contact::contact_area(&one, &other, &settings))?;
    area.map_err(error::of_library)
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
        let settings = by_name(&self.settings);
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

    /// How the optimisation ended.
    #[getter]
    fn status(&self) -> &'static str {
        self.report.status.name()
    }

    /// The bytes of a `.shroud` file with the voxels and so many bits of the place of each vertex.
    fn pack<'py>(
        &self,
        py: Python<'py>,
        delta: PyReadonlyArray1<'_, f64>,
        bits: u8,
        profile: &str,
        frame: String,
        unit: String,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let (faces, border) = (self.settings.faces, self.settings.border);
        let settings = crate::packed::settings(profile, faces, border, frame, unit)?;
        let (volume, surface) = (self.volume.clone(), self.surface.clone());
        let delta = delta.as_slice()?.to_vec();
        let bytes = run_quietly(py, None, move || {
            let planes = shrouds_codec::geometry::encode(&surface, &delta, bits.into())?;
            let mut bytes = Vec::new();
            shrouds_codec::pack_with_planes(&volume, &settings, &planes, &mut bytes)?;
            Ok::<_, shrouds_codec::Error>(bytes)
        })?;
        Ok(PyBytes::new(py, &bytes.map_err(error::of_codec)?))
    }

    /// Everything that is measured, as JSON.
    #[pyo3(signature = (mesh, other, threads))]
    fn measure(
        &self,
        py: Python<'_>,
        mesh: &Mesh,
        other: Option<&Mesh>,
        threads: Option<usize>,
    ) -> PyResult<String> {
        let (mesh, surface) = (mesh.mesh.clone(), self.surface.clone());
        let other = other.map(|other| other.mesh.clone());
        let (kind, voxels) = (self.settings.mesh, Some(self.volume.count()));
        let measured = run_quietly(py, threads, move || {
            Body { mesh: &mesh, surface: Some(&surface), kind, voxels }.measure(other.as_ref())
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

/// The settings in force as the report has them: numbers as such, null for what has no meaning.
pub(crate) fn by_name(settings: &Settings) -> Map<String, Value> {
    let in_force = settings.to_names();
    let value = |name| {
        let text = in_force.iter().find(|(known, _)| *known == name).map(|(_, text)| text);
        text.map_or(Value::Null, |text| match text.parse::<serde_json::Number>() {
            Ok(number) => number.into(),
            Err(_) => text.as_str().into(),
        })
    };
    setting_names().into_iter().map(|name| (name.to_owned(), value(name))).collect()
}
