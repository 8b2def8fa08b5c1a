//! Labels in, one network of interfaces out.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value};
use shrouds::materials::{self, Labels, Shrouds};
use shrouds::{Grid, Settings};
use shrouds_io::{Frame, MeshOptions, write_materials};
use shrouds_report::{Lattice, Materials, Times};

use crate::array::labels;
use crate::mesh::{positions, precision, triples};
use crate::pool::pool;
use crate::report::Said;
use crate::shroud::{by_name, settings_of};
use crate::work::run_quietly;
use crate::{error, json};

/// The settings that interfaces have.
pub(crate) const NAMES: [&str; 7] =
    ["faces", "preset", "start", "margin", "tolerance", "max_iterations", "volume"];

/// Interfaces, besides their arrays.
#[pyclass(frozen, module = "shrouds._native")]
pub(crate) struct MadeMaterials {
    grid: Grid,
    labels: Arc<Labels>,
    made: Arc<Shrouds>,
    settings: Settings,
}

/// Vertices, faces, pairs of labels, lines and the rest.
type Arrays<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyArray2<u32>>,
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray2<u32>>,
    MadeMaterials,
);

#[derive(Serialize)]
struct Report {
    input: Lattice,
    settings: Map<String, Value>,
    #[serde(flatten)]
    found: Materials,
    times: Times,
    version: &'static str,
}

/// The interfaces of an array of labels that is indexed [z, y, x].
#[pyfunction]
#[pyo3(signature = (values, affine, given, threads))]
pub(crate) fn interfaces<'py>(
    py: Python<'py>,
    values: &Bound<'py, PyAny>,
    affine: [[f64; 4]; 3],
    given: Vec<(String, String)>,
    threads: Option<usize>,
) -> PyResult<Arrays<'py>> {
    let settings = settings_of(&given)?;
    let (values, [nx, ny, nz]) = labels(values)?;
    let grid = Grid::with_affine([nx, ny, nz], affine).map_err(error::of_library)?;
    let known =
        py.detach(|| pool(threads).map(|pool| pool.install(|| Labels::new(&grid, &values))));
    let known = known?.map_err(error::of_library)?;
    drop(values);
    let (asked, labels) = (of_materials(&settings), known.clone());
    let made = run_quietly(py, threads, move || materials::shrouds(labels, &asked))?;
    let made = made.map_err(error::of_library)?;
    let mesh = &made.mesh;
    let lines = mesh.lines.clone();
    let shape = [[mesh.pairs.len(), 2], [lines.len(), 2]];
    Ok((
        positions(py, mesh.surface.vertices.clone(), grid.min_spacing())?,
        triples(py, mesh.surface.triangles.clone())?,
        mesh.pairs.clone().into_flattened().into_pyarray(py).reshape(shape[0])?,
        lines.into_flattened().into_pyarray(py).reshape(shape[1])?,
        MadeMaterials { grid, labels: Arc::new(known), made: Arc::new(made), settings },
    ))
}

fn of_materials(settings: &Settings) -> materials::Settings {
    let own = &settings.optimize;
    materials::Settings {
        faces: settings.faces,
        preset: own.preset,
        start: own.start.clone(),
        margin: own.margin,
        tolerance: own.tolerance(),
        volume: own.volume,
        max_iterations: own.max_iterations(),
    }
}

#[pymethods]
impl MadeMaterials {
    /// The report as JSON, every label checked.
    fn report(&self, py: Python<'_>, said: Said, threads: Option<usize>) -> PyResult<String> {
        let (labels, made) = (Arc::clone(&self.labels), Arc::clone(&self.made));
        let start = Instant::now();
        let found =
            run_quietly(py, threads, move || Materials::new(&labels, &made, &BTreeMap::new()))?;
        let mut times = Times::new(said.seconds, self.made.times);
        times.check = start.elapsed().as_secs_f64();
        times.total = times.read + times.surface + times.optimize + times.mesh + times.check;
        let mut settings = by_name(&self.settings);
        settings.retain(|name, _| NAMES.contains(&name.as_str()));
        json(&Report {
            input: Lattice::new(&self.grid, &said.frame, &said.unit),
            settings,
            found: found.map_err(error::of_library)?,
            times,
            version: env!("CARGO_PKG_VERSION"),
        })
    }

    /// Writes the interfaces to one file.
    fn write(&self, py: Python<'_>, path: PathBuf, frame: String, unit: String) -> PyResult<()> {
        let mesh = &self.made.mesh;
        let precision = precision(&mesh.surface.vertices, self.grid.min_spacing());
        let frame = Some(Frame { name: frame, unit, source: "options" });
        let options = MeshOptions { precision, frame };
        py.detach(|| write_materials(path, mesh, &options)).map_err(error::of_file)
    }
}
