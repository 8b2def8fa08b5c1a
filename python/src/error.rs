//! Errors of the libraries as Python's, with their messages.
//!
//! ValueError where the call or the data is at fault, OSError where a file is, MemoryError where there is
//! not enough of it.

use std::io;

use pyo3::PyErr;
use pyo3::exceptions::{
    PyFileNotFoundError, PyMemoryError, PyOSError, PyPermissionError, PyValueError,
};

/// An error of the library.
pub(crate) fn of_library(error: shrouds::Error) -> PyErr {
    match error {
        shrouds::Error::Memory { .. } => PyMemoryError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// An error about a packed volume.
pub(crate) fn of_codec(error: shrouds_codec::Error) -> PyErr {
    match error {
        shrouds_codec::Error::Memory { .. } => PyMemoryError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// An error about a file.
pub(crate) fn of_file(error: shrouds_io::Error) -> PyErr {
    use shrouds_io::Error;
    let message = error.to_string();
    match error {
        Error::Extension { .. }
        | Error::Choice { .. }
        | Error::Layout { .. }
        | Error::Values { .. }
        | Error::Unwritable { .. } => PyValueError::new_err(message),
        Error::Chunks { .. } => PyValueError::new_err(message),
        Error::Io { cause, .. } => match cause.kind() {
            io::ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
            io::ErrorKind::PermissionDenied => PyPermissionError::new_err(message),
            _ => PyOSError::new_err(message),
        },
        _ => PyOSError::new_err(message),
    }
}
