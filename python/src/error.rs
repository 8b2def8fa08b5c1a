//! Errors of the library as Python's, with their messages.

use std::io;

use pyo3::PyErr;
use pyo3::exceptions::{
    PyFileNotFoundError, PyMemoryError, PyOSError, PyPermissionError, PyValueError,
};

/// An error of the library: a setting or a volume that cannot be worked on.
pub(crate) fn of_library(error: shrouds::Error) -> PyErr {
    match error {
        shrouds::Error::Memory { .. } => PyMemoryError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// An error of a file: OSError where the file is at fault, ValueError where the call is.
pub(crate) fn of_file(error: shrouds_io::Error) -> PyErr {
    use shrouds_io::Error;
    let message = error.to_string();
    match error {
        Error::Extension { .. }
        | Error::Choice { .. }
        | Error::Layout { .. }
        | Error::Values { .. }
        | Error::Unwritable { .. }
        | Error::UnwritableVolume { .. } => PyValueError::new_err(message),
        Error::Io { cause, .. } => match cause.kind() {
            io::ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
            io::ErrorKind::PermissionDenied => PyPermissionError::new_err(message),
            _ => PyOSError::new_err(message),
        },
        _ => PyOSError::new_err(message),
    }
}
