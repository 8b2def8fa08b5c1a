//! Triangle meshes: arrays to the library's type and back, files, and what is said about them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::{Element, IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Serialize;
use shrouds::TriMesh;
use shrouds::check::{CheckReport, CheckSettings};
use shrouds::mesh::MeshKind;
use shrouds_io::{Attribute, Frame, MeshOptions, Part, Precision, write_meshes};
use shrouds_report::Checks;
use shrouds_report::looks::roughness;
use shrouds_report::measure::{Body, parts};

use crate::volume::Volume;
use crate::work::run_quietly;
use crate::{error, json};

/// A triangle mesh.
#[pyclass(frozen, module = "shrouds._native")]
pub(crate) struct Mesh {
    pub(crate) mesh: TriMesh,
}

/// Vertices, faces and normals, if there are some.
type Arrays<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>, Option<Bound<'py, PyArray2<f32>>>);

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces, normals))]
    fn new(
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, u32>,
        normals: Option<PyReadonlyArray2<'_, f32>>,
    ) -> PyResult<Self> {
        let normals = normals.map_or(Ok(Vec::new()), |normals| rows(&normals, "normals"))?;
        let (vertices, triangles) = (rows(&vertices, "vertices")?, rows(&faces, "faces")?);
        if let Some(v) = triangles.as_flattened().iter().find(|&&v| v as usize >= vertices.len()) {
            let count = vertices.len();
            let message = format!("a face names vertex {v}, but there are {count} vertices");
            return Err(PyValueError::new_err(message));
        }
        if !normals.is_empty() && normals.len() != vertices.len() {
            return Err(PyValueError::new_err("there must be one normal per vertex"));
        }
        Ok(Self { mesh: TriMesh { vertices, triangles, normals } })
    }

    /// The mesh of a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let mesh = run_quietly(py, None, move || shrouds_io::read_mesh(path))?;
        Ok(Self { mesh: mesh.map_err(error::of_file)? })
    }

    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        let TriMesh { vertices, triangles, normals } = self.mesh.clone();
        let normals = (!normals.is_empty()).then(|| triples(py, normals)).transpose()?;
        Ok((triples(py, vertices)?, triples(py, triangles)?, normals))
    }

    /// Writes the mesh to a file with numbers per vertex; `spacing` is the smallest of the lattice, for
    /// the number of digits.
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        attributes: BTreeMap<String, PyReadonlyArray1<'_, f32>>,
        frame: String,
        unit: String,
        spacing: f64,
    ) -> PyResult<()> {
        let mut numbers = Vec::new();
        for (name, values) in &attributes {
            numbers.push(Attribute { name, values: values.as_slice()? });
        }
        let part = Part { attributes: &numbers, ..Part::from(&self.mesh) };
        let frame = Some(Frame { name: frame, unit, source: "options" });
        let options = MeshOptions { precision: precision(&self.mesh.vertices, spacing), frame };
        py.detach(|| write_meshes(path, &[part], &options)).map_err(error::of_file)
    }

    /// The columns of a mesh of which nothing else is known, as JSON.
    #[pyo3(signature = (other, threads))]
    fn measure(
        &self,
        py: Python<'_>,
        other: Option<&Self>,
        threads: Option<usize>,
    ) -> PyResult<String> {
        let (mesh, other) = (self.mesh.clone(), other.map(|other| other.mesh.clone()));
        let measured = run_quietly(py, threads, move || {
            let body = Body { mesh: &mesh, surface: None, kind: MeshKind::Primal, voxels: None };
            body.measure(other.as_ref())
        })?;
        json(&measured.map_err(error::of_library)?)
    }

    /// The parts of the mesh that hang together.
    fn parts(&self) -> Vec<Self> {
        parts(&self.mesh).into_iter().map(|mesh| Self { mesh }).collect()
    }

    /// Root mean square of the angles between neighbouring triangles, in degrees.
    fn roughness(&self, py: Python<'_>) -> PyResult<f64> {
        let mesh = self.mesh.clone();
        run_quietly(py, None, move || roughness(&mesh))
    }

    /// The certificate of the mesh against a volume, as JSON.
    #[expect(clippy::too_many_arguments, reason = "the program has as many options")]
    fn check(
        &self,
        py: Python<'_>,
        volume: &Volume,
        border: &str,
        faces: &str,
        all_axes: bool,
        self_intersections: bool,
        threads: Option<usize>,
    ) -> PyResult<String> {
        let settings = CheckSettings {
            border: border.parse().map_err(error::of_library)?,
            faces: faces.parse().map_err(error::of_library)?,
            all_axes,
            self_intersections,
        };
        let (mesh, volume) = (self.mesh.clone(), volume.occupancy.clone());
        let report =
            run_quietly(py, threads, move || shrouds::check::check(&mesh, &volume, &settings))?;
        json(&Certificate::new(&report.map_err(error::of_library)?))
    }
}

/// The findings of a check.
#[derive(Serialize)]
struct Certificate {
    vertices: u64,
    triangles: u64,
    checks: Checks,
    euler: Vec<i64>,
    notes: Vec<String>,
    version: &'static str,
}

impl Certificate {
    fn new(report: &CheckReport) -> Self {
        let structure = &report.structure;
        Self {
            vertices: structure.vertices + structure.unused_vertices,
            triangles: structure.triangles,
            checks: Checks::new(report),
            euler: structure.components.iter().map(|component| component.euler).collect(),
            notes: report.notes(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// Size of the floats that coordinates need on a lattice with this smallest spacing.
pub(crate) fn precision(vertices: &[[f64; 3]], spacing: f64) -> Precision {
    let largest = vertices.as_flattened().iter().fold(0.0, |max: f64, x| max.max(x.abs()));
    Precision::needed(largest, spacing)
}

/// An array of `N × 3`, which takes over the memory.
pub(crate) fn triples<T: Element>(
    py: Python<'_>,
    rows: Vec<[T; 3]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    rows.into_flattened().into_pyarray(py).reshape([count, 3])
}

/// The rows of an array of `N × 3` in C order.
fn rows<T: Element + Copy>(array: &PyReadonlyArray2<'_, T>, name: &str) -> PyResult<Vec<[T; 3]>> {
    let (rows, rest) = array.as_slice()?.as_chunks::<3>();
    if array.as_array().ncols() != 3 || !rest.is_empty() {
        return Err(PyValueError::new_err(format!("{name} must have the shape (n, 3)")));
    }
    Ok(rows.to_vec())
}

/// Positions in 32 bits, or in 64 where those would move a vertex by too much.
pub(crate) fn positions<'py>(
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
