//! Settings by their names.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use shrouds::Settings;

/// The settings that names and values ask for.
pub(crate) fn settings(given: &[(String, String)]) -> PyResult<Settings> {
    let mut settings = Settings::default();
    for (name, value) in given {
        match name.as_str() {
            "energy" => {
                let energy = value.parse().map_err(crate::error::of_library)?;
                settings.optimize.energy = Some(energy);
            }
            _ => return Err(PyValueError::new_err(format!("there is no setting {name:?}"))),
        }
    }
    Ok(settings)
}
