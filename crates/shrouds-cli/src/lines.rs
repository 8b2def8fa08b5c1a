//! Contours and curves of the network: where planes are, and lines into files.

use std::path::Path;

use serde::Serialize;
use shrouds::measure::{self, Contour, Planes};
use shrouds::{Grid, TriMesh};
use shrouds_io::{
    Attribute, Frame, Line, MeshFormat, MeshOptions, Precision, mesh_format, write_lines_with,
};

use crate::args::PlaneAxis;
use crate::console::number;
use crate::failure::Failure;
use shrouds_report::looks::mean_edge;

/// Most planes at once.
const MOST: f64 = 10_000.0;

/// Fails unless lines can be written to a file of this name.
pub(crate) fn check_format(path: &Path) -> Result<(), Failure> {
    if let Ok(MeshFormat::Obj | MeshFormat::Vtp) = mesh_format(path) {
        return Ok(());
    }
    let message = "no file of lines by its name; lines are written to .vtp and .obj";
    Err(Failure::Call(format!("{}: {message}", path.display())))
}

/// No planes yet, across an axis; those of a lattice need a volume.
pub(crate) fn across(axis: PlaneAxis, lattice: Option<&Grid>) -> Result<Planes, Failure> {
    match (axis.is_of_lattice(), lattice) {
        (false, _) => Ok(Planes::across(axis.index(), Vec::new())),
        (true, Some(grid)) => Ok(Planes::across_lattice(grid, axis.index(), Vec::new())),
        (true, None) => {
            let message =
                "belongs to the lattice of a volume, and a mesh file has none: use x, y or z";
            Err(Failure::Call(format!("the axis {} {message}", axis.name())))
        }
    }
}

/// Planes so far apart through a mesh, one of them at `offset` or as if there were one.
pub(crate) fn every(
    planes: Planes,
    mesh: &TriMesh,
    distance: f64,
    offset: f64,
) -> Result<Planes, Failure> {
    let Some([low, high]) = planes.range(mesh) else { return Ok(planes) };
    let [first, last] = [((low - offset) / distance).ceil(), ((high - offset) / distance).floor()];
    let count = last - first + 1.0;
    if count.is_nan() || count > MOST {
        return Err(Failure::Call(format!(
            "planes {distance} apart are {count:.0} through this surface, from {low} to {high}: more than {MOST}; put them farther apart"
        )));
    }
    // None if the surface lies between two of them.
    let positions = (0..count.max(0.0) as u32).map(|n| offset + (first + f64::from(n)) * distance);
    Ok(planes.at(positions.collect()))
}

/// How fair a surface is, in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct FairnessReport {
    /// Bending energy of contours across x, y and z, that of a sphere being 1.
    bending: f64,
    /// Distance of these contours and of the points on them, in the unit of the mesh.
    step: f64,
}

impl FairnessReport {
    /// The bending energy with three digits behind the point.
    pub(crate) fn rounded(&self) -> f64 {
        (1000.0 * self.bending).round() / 1000.0
    }

    /// For a person.
    pub(crate) fn in_words(&self) -> String {
        let [bending, step] = [self.rounded(), self.step].map(number);
        format!(
            "fairness {bending}: contours {step} apart bend that many times as much as those of a sphere"
        )
    }
}

/// How fair a mesh is, with the smallest spacing of its lattice as step, or else the mean length of its
/// edges; nothing if it has none.
pub(crate) fn fairness(
    mesh: &TriMesh,
    lattice: Option<&Grid>,
) -> Result<Option<FairnessReport>, Failure> {
    let step = lattice.map(Grid::min_spacing).or_else(|| mean_edge(mesh));
    let Some(step) = step.filter(|_| !mesh.triangles.is_empty()) else { return Ok(None) };
    let measure::Fairness { bending, step } = measure::fairness(mesh, step)?;
    Ok(Some(FairnessReport { bending, step }))
}

/// Writes lines, each with the axis across it, as many digits as they have. `position` is what the
/// positions are called.
pub(crate) fn write(
    path: &Path,
    contours: &[(usize, &Contour)],
    position: &str,
    frame: Option<Frame>,
) -> Result<(), Failure> {
    let lines: Vec<Line> = contours
        .iter()
        .map(|(_, contour)| Line { points: &contour.points, closed: contour.closed })
        .collect();
    let numbers = |of: fn(usize, &Contour) -> f64| -> Vec<f32> {
        contours.iter().map(|&(axis, contour)| of(axis, contour) as f32).collect()
    };
    let columns = [
        ("axis", numbers(|axis, _| axis as f64)),
        (position, numbers(|_, contour| contour.position)),
        ("closed", numbers(|_, contour| f64::from(u8::from(contour.closed)))),
        ("length", numbers(|_, contour| contour.length)),
        ("area", numbers(|_, contour| contour.area)),
    ];
    let attributes: Vec<Attribute> =
        columns.iter().map(|(name, values)| Attribute { name, values }).collect();
    let options = MeshOptions { precision: Precision::Double, frame };
    Ok(write_lines_with(path, &lines, &attributes, &options)?)
}
