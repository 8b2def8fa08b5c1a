//! `.shroud` files: labels in and out, and shrouds within what bit planes say of their vertices.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use shrouds::Grid;
use shrouds::optimize::VolumeRule;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds_codec::geometry::{self, Places};
use shrouds_codec::{Content, LabelMap, Profile, Settings, Unpacked};

use crate::error;
use crate::shroud::{Arrays, make, settings_of};
use crate::volume::{Volume, no_choice};
use crate::work::run_quietly;

/// How a file is to be written.
pub(crate) fn settings(
    profile: &str,
    faces: FaceRule,
    border: Border,
    space: String,
    unit: String,
) -> PyResult<Settings> {
    let profile = match profile {
        "fast" => Profile::Fast,
        "dense" => Profile::Dense,
        _ => return Err(no_choice("profile", profile, "fast, dense")),
    };
    Ok(Settings { profile, faces, border, space, unit, ..Settings::default() })
}

/// The bytes of a file with all labels of an array that is indexed [z, y, x].
#[pyfunction]
pub(crate) fn pack_labels<'py>(
    py: Python<'py>,
    values: &Bound<'py, PyAny>,
    affine: [[f64; 4]; 3],
    profile: &str,
    frame: String,
    unit: String,
) -> PyResult<Bound<'py, PyBytes>> {
    let settings = settings(profile, FaceRule::default(), Border::default(), frame, unit)?;
    let (values, dims) = crate::array::labels(values)?;
    let grid = Grid::with_affine(dims, affine).map_err(error::of_library)?;
    let bytes = run_quietly(py, None, move || {
        let mut bytes = Vec::new();
        let map = LabelMap::new(grid, &values)?;
        shrouds_codec::pack_labels(&map, &settings, &mut bytes)?;
        Ok::<_, shrouds_codec::Error>(bytes)
    })?;
    Ok(PyBytes::new(py, &bytes.map_err(error::of_codec)?))
}

/// Whether a file has labels.
#[pyfunction]
pub(crate) fn is_labels(bytes: &[u8]) -> PyResult<bool> {
    let header = shrouds_codec::read_header(bytes).map_err(error::of_codec)?;
    Ok(matches!(header.content, Content::Labels(_)))
}

/// Labels indexed [z, y, x], affine, and the names of the world and the unit.
type Labels<'py> = (Bound<'py, PyArray3<i64>>, [[f64; 4]; 3], String, String);

/// The labels of a file.
#[pyfunction]
pub(crate) fn unpack_labels(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Labels<'_>> {
    let unpacked = run_quietly(py, None, move || shrouds_codec::unpack_labels(&bytes[..]))?;
    let (header, map) = unpacked.map_err(error::of_codec)?;
    let [nx, ny, nz] = map.grid().dims();
    let values = map.values().collect::<Vec<i64>>().into_pyarray(py).reshape([nz, ny, nx])?;
    Ok((values, map.grid().affine(), header.space, header.unit))
}

/// The shroud of a packed volume, within what its bit planes say, with the volume and the names of its world and
/// its unit.
#[pyfunction]
#[pyo3(signature = (bytes, given, threads))]
pub(crate) fn unpack_shroud<'py>(
    py: Python<'py>,
    bytes: Vec<u8>,
    mut given: Vec<(String, String)>,
    threads: Option<usize>,
) -> PyResult<(Arrays<'py>, Volume, String, String)> {
    let found = run_quietly(py, threads, move || {
        let unpacked = shrouds_codec::unpack(&bytes[..]).map_err(error::of_codec)?;
        let places = places(&unpacked)?;
        Ok::<_, PyErr>((unpacked, places))
    })?;
    let (Unpacked { header, volume, .. }, places) = found?;
    given.push(("faces".into(), header.faces.to_string()));
    given.push(("border".into(), header.border.to_string()));
    let is_free =
        !given.iter().any(|(name, _)| ["preset", "solver", "crease"].contains(&name.as_str()));
    if places.planes > 0 && is_free {
        // Within intervals the one that converges comes much nearer to the surface that was packed.
        given.push(("preset".into(), "exact".into()));
    }
    let mut settings = settings_of(&given)?;
    if places.planes > 0 {
        if settings.optimize.volume == VolumeRule::Keep {
            let message =
                "volume=\"keep\" has no meaning where bit planes place the vertices: leave it out";
            return Err(PyValueError::new_err(message));
        }
        settings.optimize.intervals = Some(places.intervals().collect());
    }
    let volume = Arc::new(volume);
    let made = make(py, volume.clone(), settings, threads, None)?;
    Ok((made, Volume { occupancy: volume }, header.space, header.unit))
}

/// What the bit planes say.
fn places(unpacked: &Unpacked) -> PyResult<Places> {
    let header = &unpacked.header;
    let surface = Surface::extract(&unpacked.volume, header.faces, header.border);
    let surface = surface.map_err(error::of_library)?;
    let planes = unpacked.planes.iter();
    let payloads: Vec<(&[u8], u32)> =
        planes.map(|plane| (&plane.payload[..], plane.decoded_sum)).collect();
    let places = geometry::decode(&surface, &header.plane_settings, &payloads);
    match places.lost.as_ref().or(unpacked.lost.as_ref()) {
        Some(lost) => Err(PyValueError::new_err(lost.clone())),
        None => Ok(places),
    }
}
