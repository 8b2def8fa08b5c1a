//! Where a MetaImage places its lattice.

use std::path::Path;

use crate::error::Error;
use crate::volume::metaimage::Header;
use crate::volume::{Frame, affine_of, normal_step};

/// Fields for the same thing, the one that ITK prefers first.
const ORIGINS: [&str; 4] = ["ImagePosition", "Origin", "Offset", "Position"];
const TURNS: [&str; 3] = ["TransformMatrix", "Rotation", "Orientation"];
const SPACINGS: [&str; 2] = ["ElementSpacing", "ElementSize"];

/// Index-to-world map and frame. The world is that of ITK: `LPS`, in millimetres.
pub(super) fn placement(
    path: &Path,
    header: &mut Header,
    axes: usize,
) -> Result<([[f64; 4]; 3], Frame), Error> {
    let origin = first(path, header, &ORIGINS, axes)?;
    let turn = first(path, header, &TURNS, axes * axes)?;
    let size = header.numbers(path, SPACINGS[0], axes)?;
    let spacing = match &size {
        // The size of an element may differ from its distance to the next.
        Some(_) => size,
        None => header.numbers(path, SPACINGS[1], axes)?,
    };
    let source = if turn.is_some() {
        "TransformMatrix"
    } else if spacing.is_some() {
        "ElementSpacing"
    } else if origin.is_some() {
        "Offset"
    } else {
        "none"
    };
    let name = if turn.is_some() || origin.is_some() { "LPS" } else { "index" };
    let unit = match header.get("DistanceUnits") {
        Some(unit) if !unit.is_empty() && unit != "?" => unit.to_string(),
        _ if source == "none" => "unknown".into(),
        _ => "mm".into(),
    };
    let step = |n: usize| spacing.as_ref().map_or(1.0, |spacing| spacing[n]);
    // Row n of the matrix is the direction of axis n.
    let column = |n: usize| -> [f64; 3] {
        std::array::from_fn(|r| {
            let along = match &turn {
                _ if r >= axes => 0.0,
                Some(turn) => turn[n * axes + r],
                None => f64::from(u8::from(r == n)),
            };
            along * step(n)
        })
    };
    let (u, v) = (column(0), column(1));
    let w = if axes == 2 { normal_step(u, v) } else { column(2) };
    if axes == 2 {
        header.warnings.push(
            "The file holds an image, which is taken for one slice as thick as its smaller spacing."
                .into(),
        );
    }
    if turn.is_some() && axes > 2 {
        check_orientation(header, [u, v, w]);
    }
    let origin = origin.unwrap_or_else(|| vec![0.0; axes]);
    let origin = std::array::from_fn(|r| origin.get(r).copied().unwrap_or(0.0));
    Ok((affine_of([u, v, w], origin), Frame::new(name, unit, source)))
}

/// The first of these fields that is there.
fn first(
    path: &Path,
    header: &mut Header,
    names: &[&str],
    count: usize,
) -> Result<Option<Vec<f64>>, Error> {
    let mut found: Option<(&str, Vec<f64>)> = None;
    for name in names {
        let Some(numbers) = header.numbers(path, name, count)? else { continue };
        match &found {
            None => found = Some((name, numbers)),
            Some((used, first)) if *first != numbers => {
                let warning = format!("The fields {used} and {name} differ; {used} is used.");
                header.warnings.push(warning);
            }
            Some(_) => {}
        }
    }
    Ok(found.map(|(_, numbers)| numbers))
}

/// Warns where the anatomical orientation is that of no reading of the directions: some name where an
/// axis comes from, some where it goes to.
fn check_orientation(header: &mut Header, columns: [[f64; 3]; 3]) {
    let Some(told) = header.get("AnatomicalOrientation").map(str::to_uppercase) else { return };
    if told.len() != 3 || told.chars().any(|letter| !"LRAPSI".contains(letter)) {
        return;
    }
    let letters = |signs: [&str; 2]| -> String {
        columns
            .iter()
            .map(|column| {
                let largest =
                    |r: usize, s: usize| if column[r].abs() >= column[s].abs() { r } else { s };
                let axis = largest(largest(0, 1), 2);
                char::from(signs[usize::from(column[axis] < 0.0)].as_bytes()[axis])
            })
            .collect()
    };
    let (from, to) = (letters(["RAI", "LPS"]), letters(["LPS", "RAI"]));
    if told != from && told != to {
        header.warnings.push(format!(
            "AnatomicalOrientation says {told}, the TransformMatrix says {from}; the matrix is used."
        ));
    }
}
