//! Surfaces chunk by chunk, with what is found in a folder: the steps that tasks on workers call.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use shrouds::chunks::Layout;
use shrouds::{Grid, Settings};
use shrouds_io::{MeshOptions, Precision, VertexBits, write_layer_info};

use crate::error;
use crate::volume::Volume;
use crate::work::run_quietly;

/// An index of a chunk along x, y, z.
type Index = [usize; 3];
/// Positions, N × 3, and vertex indices, M × 3.
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// The work on a surface in chunks, see the module `distributed`.
#[pyclass(frozen, module = "shrouds._native")]
pub(crate) struct ChunkRun {
    run: Arc<shrouds_io::ChunkRun>,
    threads: Option<usize>,
}

#[pymethods]
impl ChunkRun {
    /// The work in a folder on a volume of so many voxels along x, y, z. Settings go by their names.
    #[new]
    #[pyo3(signature = (folder, identity, dims, affine, chunk, settings, threads))]
    fn new(
        folder: PathBuf,
        identity: &str,
        dims: [usize; 3],
        affine: [[f64; 4]; 3],
        chunk: usize,
        settings: Vec<(String, String)>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let pairs = settings.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        let settings = Settings::from_names(pairs).map_err(error::of_library)?;
        let grid = Grid::with_affine(dims, affine).map_err(error::of_library)?;
        let layout = Layout::new(grid, settings.border, chunk).map_err(error::of_library)?;
        let run = shrouds_io::ChunkRun::open(folder, identity, layout, &settings);
        Ok(Self { run: Arc::new(run.map_err(error::of_file)?), threads })
    }

    /// The indices of all chunks, in their order.
    fn chunks(&self) -> Vec<Index> {
        self.run.layout().chunks().collect()
    }

    /// Where the voxels of a chunk begin and end along x, y, z.
    fn voxels(&self, chunk: Index) -> [(usize, usize); 3] {
        self.run.layout().voxels(chunk).map(|range| (range.start, range.end))
    }

    /// How many passes there are.
    #[getter]
    fn passes(&self) -> usize {
        self.run.passes()
    }

    /// Whether a chunk has its voxels.
    fn has_voxels(&self, chunk: Index) -> PyResult<bool> {
        self.run.has_voxels(chunk).map_err(error::of_file)
    }

    /// Takes in the voxels of a chunk.
    fn put_voxels(&self, chunk: Index, volume: &Volume) -> PyResult<()> {
        self.run.put_voxels(chunk, &volume.occupancy).map_err(error::of_file)
    }

    /// Makes a pass for a chunk.
    fn relax(&self, py: Python<'_>, pass_: usize, chunk: Index) -> PyResult<()> {
        self.work(py, move |run| run.relax(pass_, chunk))
    }

    /// Sums up a pass that is made for all chunks: vertices and triangles.
    fn finish(&self, py: Python<'_>, pass_: usize) -> PyResult<(u64, u64)> {
        let totals = self.work(py, move |run| run.finish(pass_))?;
        Ok((totals.vertices, totals.triangles))
    }

    /// The triangles of a chunk with all their vertices.
    fn mesh<'py>(&self, py: Python<'py>, chunk: Index) -> PyResult<Arrays<'py>> {
        let (made, _) = self.work(py, move |run| run.mesh(chunk))?;
        let (vertices, faces) = (made.mesh.vertices, made.mesh.triangles);
        let shapes = [[vertices.len(), 3], [faces.len(), 3]];
        let vertices = vertices.into_flattened().into_pyarray(py).reshape(shapes[0])?;
        Ok((vertices, faces.into_flattened().into_pyarray(py).reshape(shapes[1])?))
    }

    /// Prepares a chunk for the file that `join` writes, of 64-bit floats or of 32-bit ones.
    fn write_piece(&self, py: Python<'_>, chunk: Index, double: bool) -> PyResult<()> {
        self.work(py, move |run| run.write_piece(chunk, &options(double)))
    }

    /// Writes the pieces of all chunks to one PLY file.
    fn join(&self, py: Python<'_>, path: PathBuf, double: bool) -> PyResult<()> {
        self.work(py, move |run| run.join(path, &options(double)))
    }

    /// Writes the mesh of a chunk to a PLY file of its own in a folder, if it has triangles.
    fn write_part(
        &self,
        py: Python<'_>,
        chunk: Index,
        folder: PathBuf,
        double: bool,
    ) -> PyResult<bool> {
        self.work(py, move |run| run.write_part(chunk, &folder, &options(double)))
    }

    /// The work on half as many voxels along each axis.
    fn coarser(&self) -> PyResult<Self> {
        let run = self.run.coarser().map_err(error::of_file)?;
        Ok(Self { run: Arc::new(run), threads: self.threads })
    }

    /// How many resolutions there are, this one and coarser ones, until one chunk holds all.
    #[getter]
    fn levels(&self) -> usize {
        self.run.layout().levels()
    }

    /// Takes in the voxels of a chunk from the run that this one was made from.
    fn take_finer(&self, py: Python<'_>, finer: &Self, chunk: Index) -> PyResult<()> {
        let finer = Arc::clone(&finer.run);
        self.work(py, move |run| run.take_finer(&finer, chunk))
    }

    /// Prepares the mesh of a chunk for the files that `join_levels` writes.
    fn write_fragments(&self, py: Python<'_>, chunk: Index, bits: u32) -> PyResult<()> {
        let bits = vertex_bits(bits)?;
        self.work(py, move |run| run.write_fragments(chunk, bits))
    }

    /// Writes the fragments of this run and coarser ones to two files in a folder.
    fn join_levels(
        &self,
        py: Python<'_>,
        coarser: Vec<Bound<'_, Self>>,
        folder: PathBuf,
        label: String,
    ) -> PyResult<usize> {
        let runs: Vec<_> = coarser.iter().map(|run| Arc::clone(&run.get().run)).collect();
        self.work(py, move |run| {
            let coarser: Vec<&shrouds_io::ChunkRun> = runs.iter().map(Arc::as_ref).collect();
            run.join_levels(&coarser, &folder, &label)
        })
    }

    /// Removes everything that was found.
    fn remove(&self, py: Python<'_>) -> PyResult<()> {
        self.work(py, |run| run.remove())
    }
}

impl ChunkRun {
    /// Runs a step without the interpreter's lock.
    fn work<T: Send + 'static>(
        &self,
        py: Python<'_>,
        step: impl FnOnce(&shrouds_io::ChunkRun) -> Result<T, shrouds_io::Error> + Send + 'static,
    ) -> PyResult<T> {
        let run = Arc::clone(&self.run);
        run_quietly(py, self.threads, move || step(&run))?.map_err(error::of_file)
    }
}

/// Writes the `info` of a layer and of its meshes: Draco-coded with so many bits, or of the legacy kind.
#[pyfunction]
#[pyo3(signature = (folder, dims, affine, bits))]
pub(crate) fn write_info(
    folder: PathBuf,
    dims: Index,
    affine: [[f64; 4]; 3],
    bits: Option<u32>,
) -> PyResult<()> {
    let grid = Grid::with_affine(dims, affine).map_err(error::of_library)?;
    let bits = bits.map(vertex_bits).transpose()?;
    write_layer_info(&folder, &grid, bits).map_err(error::of_file)
}

fn vertex_bits(count: u32) -> PyResult<VertexBits> {
    VertexBits::of_count(count)
        .ok_or_else(|| PyValueError::new_err(format!("bits is {count}, but must be 10 or 16")))
}

fn options(double: bool) -> MeshOptions {
    let precision = if double { Precision::Double } else { Precision::Single };
    MeshOptions { precision, frame: None }
}
