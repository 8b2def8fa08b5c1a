//! What the Python package `shrouds` is made of below its Python: NumPy arrays in, work without the
//! interpreter's lock, NumPy arrays out.
//!
//! The Python files beside it (`shrouds/`) bring arguments into one form and document everything; this
//! crate turns arrays into the library's types (`array`), runs the library on a thread that can be
//! interrupted (`work`), and maps errors (`error`). `shrouds/_native.pyi` describes what it exports.

mod array;
mod error;
mod shroud;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::array::Volume;
    #[pymodule_export]
    use crate::shroud::{Made, setting_names, shroud};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
