//! Lines out, as OBJ or VTP.

use std::path::Path;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::mesh::part::check_attributes;
use crate::mesh::{Attribute, MeshFormat, MeshOptions, mesh_format, obj, vtp};

/// A line through some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// Its points in order.
    pub points: &'a [[f64; 3]],
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

impl Line<'_> {
    /// The numbers of its points, the first of which is `first`, in the order to join them.
    pub(super) fn indices(&self, first: u64) -> impl Iterator<Item = u64> {
        let end = first + self.points.len() as u64;
        (first..end).chain((self.closed && end > first).then_some(first))
    }
}

/// Writes lines, as Wavefront (`.obj`: points and `l` elements, one for each line) or VTK XML
/// (`.vtp`). A line without points is left out. The file appears whole or not at all.
///
/// # Errors
/// [`Error::Extension`] for another extension, [`Error::Unwritable`] when a coordinate is not finite
/// or too large for the precision; otherwise as for [`write_atomically`].
pub fn write_lines(
    path: impl AsRef<Path>,
    lines: &[Line],
    options: &MeshOptions,
) -> Result<(), Error> {
    write_lines_with(path, lines, &[], options)
}

/// As [`write_lines`], with numbers per line, for example the axis normal to the plane of each. VTP
/// holds them as cell data; from OBJ they are left out.
///
/// # Errors
/// As [`write_lines`]; [`Error::Unwritable`] also when an attribute has not one finite value per line
/// or no usable name.
pub fn write_lines_with(
    path: impl AsRef<Path>,
    lines: &[Line],
    attributes: &[Attribute],
    options: &MeshOptions,
) -> Result<(), Error> {
    let path = path.as_ref();
    let unwritable = |problem| Error::Unwritable { path: path.into(), problem };
    let format = mesh_format(path).ok();
    let Some(format @ (MeshFormat::Obj | MeshFormat::Vtp)) = format else {
        let known = "lines are written to .obj and .vtp";
        return Err(Error::Extension { path: path.into(), kind: "line", known });
    };
    check_attributes(attributes, lines.len(), "lines").map_err(unwritable)?;
    let largest = options.precision.largest();
    let mut points = lines.iter().flat_map(|line| line.points);
    if let Some(point) = points.find(|point| !point.iter().all(|x| x.abs() <= largest)) {
        let problem = format!("a point lies at {point:?}, which is not finite or too large");
        return Err(unwritable(problem));
    }
    write_atomically(path, |writer| match format {
        MeshFormat::Vtp => vtp::write_lines(writer, lines, attributes, options),
        _ => obj::write_lines(writer, lines, options),
    })
}
