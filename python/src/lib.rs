//! What the Python package `shrouds` is made of below its Python: NumPy arrays in, work without the
//! interpreter's lock, NumPy arrays out.
//!
//! The Python files beside it (`shrouds/`) bring arguments into one form and document everything; this
//! crate turns arrays into the library's types (`array`, `mesh`), runs the library on a thread that can be
//! interrupted (`work`), and maps errors (`error`). `shrouds/_native.pyi` describes what it exports.

mod array;
mod chunk;
mod error;
mod materials;
mod mesh;
mod packed;
mod pool;
mod report;
mod shroud;
mod volume;
mod work;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde::Serialize;

#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::chunk::{ChunkRun, write_info};
    #[pymodule_export]
    use crate::materials::{MadeMaterials, interfaces};
    #[pymodule_export]
    use crate::mesh::Mesh;
    #[pymodule_export]
    use crate::packed::{is_labels, pack_labels, unpack_labels, unpack_shroud};
    #[pymodule_export]
    use crate::shroud::{Made, contact_area, energy_with, setting_names, shroud};
    #[pymodule_export]
    use crate::volume::{Volume, lattice_for, read_volume};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// What is told to Python as JSON, of which it makes dictionaries.
fn json(report: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(report).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}
