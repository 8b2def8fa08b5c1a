//! Where an NRRD file places its lattice.

use std::path::Path;

use crate::error::Error;
use crate::volume::nrrd_axes::{Axes, vectors};
use crate::volume::nrrd_header::Header;
use crate::volume::{Frame, affine_of, diagonal, normal_step, nrrd_space};

type Affine = [[f64; 4]; 3];

/// Index-to-world map and frame: space directions with their origin, else spacings and axis mins,
/// else 1.
pub(super) fn placement(
    path: &Path,
    header: &mut Header,
    axes: &Axes,
) -> Result<(Affine, Frame), Error> {
    let space = header.get("space").map(nrrd_space::frame_name);
    let unit = unit(header, axes);
    if axes.spatial.len() == 2 {
        header.warnings.push(
            "The file holds an image, which is taken for one slice as thick as its smaller spacing."
                .into(),
        );
    }
    let origin = origin(path, header)?;
    let (affine, source) = match &axes.directions {
        Some(steps) => {
            check_spacings(path, header, axes, steps)?;
            (along_directions(path, axes, steps, origin)?, "space directions")
        }
        None => along_axes(path, header, axes, origin)?,
    };
    let placed = axes.directions.is_some() || origin.is_some();
    let name = space.unwrap_or(if placed { "unnamed".into() } else { "index".into() });
    let patient = ["LPS", "RAS", "LAS"].contains(&name.as_str());
    let unit = unit.unwrap_or(if patient { "mm".into() } else { "unknown".into() });
    Ok((affine, Frame::new(name, unit, source)))
}

fn origin(path: &Path, header: &Header) -> Result<Option<[f64; 3]>, Error> {
    let Some(text) = header.get("space origin") else { return Ok(None) };
    let vector = match vectors(text).as_deref() {
        Some([Some(vector)]) => in_space(vector),
        _ => None,
    };
    vector.map(Some).ok_or_else(|| Error::header(path, format!("space origin is '{text:.60}'")))
}

/// A vector of a space of two or three dimensions, or of three and time, in three.
fn in_space(vector: &[f64]) -> Option<[f64; 3]> {
    match *vector {
        [x, y] => Some([x, y, 0.0]),
        [x, y, z] | [x, y, z, _] => Some([x, y, z]),
        _ => None,
    }
}

fn along_directions(
    path: &Path,
    axes: &Axes,
    steps: &[Option<Vec<f64>>],
    origin: Option<[f64; 3]>,
) -> Result<Affine, Error> {
    let step = |axis: &usize| steps[*axis].as_deref().and_then(in_space);
    let columns: Option<Vec<[f64; 3]>> = axes.spatial.iter().map(step).collect();
    let columns = columns.ok_or_else(|| {
        Error::header(path, "the space directions are not vectors of two, three or four numbers")
    })?;
    let columns = match *columns.as_slice() {
        [u, v, w] => [u, v, w],
        [u, v, ..] => [u, v, normal_step(u, v)],
        _ => return Err(Error::header(path, "the space directions are fewer than two")),
    };
    Ok(affine_of(columns, origin.unwrap_or_default()))
}

/// A frame along the axes of the world: spacings, or the range from axis mins to axis maxs.
fn along_axes(
    path: &Path,
    header: &mut Header,
    axes: &Axes,
    origin: Option<[f64; 3]>,
) -> Result<(Affine, &'static str), Error> {
    let count = axes.sizes.len();
    let list = |name| {
        let numbers = header.numbers(path, name)?.unwrap_or_else(|| vec![f64::NAN; count]);
        let problem = format!("the {name} are not one for each of {count} axes");
        if numbers.len() == count { Ok(numbers) } else { Err(Error::header(path, problem)) }
    };
    let (spacings, lows, highs) = (list("spacings")?, list("axis mins")?, list("axis maxs")?);
    let centers = header.get("centers").or_else(|| header.get("centerings")).unwrap_or_default();
    let is_node = |axis: usize| centers.split_whitespace().nth(axis) == Some("node");
    let (mut spacing, mut start) = ([f64::NAN; 3], [0.0; 3]);
    for (n, &axis) in axes.spatial.iter().enumerate() {
        let steps = if is_node(axis) { axes.sizes[axis] - 1 } else { axes.sizes[axis] };
        let range = (highs[axis] - lows[axis]) / steps.max(1) as f64;
        let given = [spacings[axis], range].into_iter().find(|step| step.is_finite());
        spacing[n] = given.unwrap_or(1.0);
        // The range of a cell-centred axis begins half a voxel before the first centre.
        let half = if is_node(axis) { 0.0 } else { spacing[n] / 2.0 };
        start[n] = if lows[axis].is_finite() { lows[axis] + half } else { 0.0 };
    }
    if axes.spatial.len() == 2 {
        spacing[2] = spacing[0].abs().min(spacing[1].abs());
    }
    let has = |name| header.get(name).is_some();
    let (spaced, ranged) = (has("spacings"), has("axis mins"));
    if ranged && centers.is_empty() && origin.is_none() {
        header.warnings.push(
            "The header does not say whether its axis mins are centres or edges of voxels: edges \
             are assumed."
                .into(),
        );
    }
    let unspaced = |axis: &usize| !spacings[*axis].is_finite() && !highs[*axis].is_finite();
    if spaced && axes.spatial.iter().any(unspaced) {
        header.warnings.push("The spacings leave out an axis, along which 1 is taken.".into());
    }
    let source = if spaced {
        "spacings"
    } else if ranged {
        "axis mins"
    } else {
        "none"
    };
    Ok((affine_of(diagonal(spacing), origin.unwrap_or(start)), source))
}

/// Warns where there are spacings beside directions and they differ.
fn check_spacings(
    path: &Path,
    header: &mut Header,
    axes: &Axes,
    steps: &[Option<Vec<f64>>],
) -> Result<(), Error> {
    let Some(spacings) = header.numbers(path, "spacings")? else { return Ok(()) };
    let differs = |axis: &&usize| {
        let step = steps[**axis].iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        spacings.get(**axis).is_some_and(|spacing| (spacing.abs() - step).abs() > 1e-3 * step)
    };
    if axes.spatial.iter().any(|axis| differs(&axis)) {
        header.warnings.push(
            "The spacings differ from the lengths of the space directions, which are used.".into(),
        );
    }
    Ok(())
}

/// The unit of space, if the file names one.
fn unit(header: &mut Header, axes: &Axes) -> Option<String> {
    let quoted = |name: &str| -> Option<Vec<String>> {
        let text = header.get(name)?;
        Some(text.split('"').skip(1).step_by(2).map(|unit| unit.trim().to_string()).collect())
    };
    let of_space = quoted("space units").map(|units| units.into_iter().take(3).collect());
    let of_axes = || {
        let units = quoted("units")?;
        Some(axes.spatial.iter().filter_map(|axis| units.get(*axis).cloned()).collect())
    };
    let mut units: Vec<String> = of_space.or_else(of_axes)?;
    units.retain(|unit| !unit.is_empty());
    let first = units.first().cloned()?;
    if units.iter().any(|unit| *unit != first) {
        header.warnings.push(format!("The axes have different units; {first} is used for all."));
    }
    Some(first)
}
