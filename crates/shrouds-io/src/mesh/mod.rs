//! Mesh files: PLY, STL and OBJ, out and in.

mod obj;
mod ply;
mod ply_read;
mod records;
mod stl;

use std::fs;
use std::io::Write;
use std::path::Path;

use shrouds::TriMesh;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::volume::Frame;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Polygon File Format, `.ply`: written binary little endian, with normals.
    Ply,
    /// Stereolithography, `.stl`: written binary, every triangle with its own three corners.
    Stl,
    /// Wavefront, `.obj`: text, with normals.
    Obj,
}

/// Size of the floats of a PLY file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits, about seven digits: what every program reads.
    #[default]
    Single,
    /// 64 bits: nothing is lost.
    Double,
}

/// How to write a mesh file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeshOptions {
    /// Floats of positions and normals in PLY. STL has 32 bits always; OBJ is text, with as many
    /// digits as the precision needs.
    pub precision: Precision,
    /// Frame of the coordinates, for the comment of the file. A comment `SPACE=RAS` or `SPACE=LPS`
    /// makes 3D Slicer place the mesh where it belongs.
    pub frame: Option<Frame>,
}

impl MeshOptions {
    /// One line of ASCII: who wrote the file, and the frame of its coordinates.
    fn comment(&self) -> String {
        let mut comment = format!("shrouds {}", env!("CARGO_PKG_VERSION"));
        if let Some(frame) = &self.frame {
            comment.push_str(&format!(" SPACE={} UNIT={}", frame.name, frame.unit));
        }
        comment.replace(|c: char| !(c.is_ascii_graphic() || c == ' '), "?")
    }
}

/// The mesh format that the extension of `path` names, in upper or lower case.
///
/// # Errors
/// [`Error::Extension`] when it names none.
pub fn mesh_format(path: impl AsRef<Path>) -> Result<MeshFormat, Error> {
    let path = path.as_ref();
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "ply" => Ok(MeshFormat::Ply),
        "stl" => Ok(MeshFormat::Stl),
        "obj" => Ok(MeshFormat::Obj),
        _ => {
            let known = "meshes are written to and read from .ply, .stl and .obj";
            Err(Error::Extension { path: path.into(), kind: "mesh", known })
        }
    }
}

/// Writes a mesh in the format that the extension of `path` names; the file appears whole or not at
/// all.
///
/// # Errors
/// [`Error::Extension`] for an unknown extension, [`Error::Unwritable`] when the mesh refers to
/// vertices it does not have, has a coordinate that is not finite or too large for the precision, or
/// does not fit the format; otherwise as for [`write_atomically`].
pub fn write_mesh(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    options: &MeshOptions,
) -> Result<(), Error> {
    let path = path.as_ref();
    let format = mesh_format(path)?;
    let single = options.precision == Precision::Single || format == MeshFormat::Stl;
    let largest = if single { f64::from(f32::MAX) } else { f64::MAX };
    let count = u32::try_from(mesh.triangles.len());
    let checked = check(mesh, largest).and_then(|()| match count {
        Err(_) => Err(format!("it has {} triangles; crop it", mesh.triangles.len())),
        Ok(_) => Ok(()),
    });
    checked.map_err(|problem| Error::Unwritable { path: path.into(), problem })?;
    write_atomically(path, |writer| write_mesh_to(writer, format, mesh, options))
}

/// A line through some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// Its points in order.
    pub points: &'a [[f64; 3]],
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

/// Writes lines to a Wavefront file, `.obj`: points and `l` elements, one for each line. The file
/// appears whole or not at all.
///
/// # Errors
/// [`Error::Extension`] for another extension, [`Error::Unwritable`] when a coordinate is not finite
/// or too large for the precision; otherwise as for [`write_atomically`].
pub fn write_lines(
    path: impl AsRef<Path>,
    lines: &[Line],
    options: &MeshOptions,
) -> Result<(), Error> {
    let path = path.as_ref();
    if mesh_format(path).ok() != Some(MeshFormat::Obj) {
        return Err(Error::Extension {
            path: path.into(),
            kind: "line",
            known: "lines are written to .obj",
        });
    }
    let single = options.precision == Precision::Single;
    let largest = if single { f64::from(f32::MAX) } else { f64::MAX };
    let mut points = lines.iter().flat_map(|line| line.points);
    if let Some(point) = points.find(|point| !point.iter().all(|x| x.abs() <= largest)) {
        let problem = format!("a point lies at {point:?}, which is not finite or too large");
        return Err(Error::Unwritable { path: path.into(), problem });
    }
    write_atomically(path, |writer| obj::write_lines(writer, lines, options))
}

/// Reads a mesh: PLY or STL, binary or text, or OBJ, by the extension of `path`.
///
/// Polygons become fans of triangles. STL has no vertices of its own: corners at exactly the same
/// place become one. Normals are kept where the file gives a finite one for every vertex.
///
/// # Errors
/// [`Error::Extension`] for an unknown extension, [`Error::Io`] when the file cannot be read,
/// [`Error::Content`] when it is of another kind than its extension says, [`Error::Mesh`] when it is
/// damaged or truncated, a coordinate is not finite or a face names a vertex that is not there.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriMesh, Error> {
    let path = path.as_ref();
    let format = mesh_format(path)?;
    if path.is_dir() {
        return Err(Error::unsupported(path, "a folder", "name one of the files in it"));
    }
    let bytes = fs::read(path).map_err(|cause| Error::open(path, cause))?;
    let mut mesh = match format {
        MeshFormat::Ply => ply_read::read(path, &bytes),
        MeshFormat::Stl => stl::read(path, &bytes),
        MeshFormat::Obj => obj::read(path, &bytes),
    }?;
    if mesh.normals.iter().flatten().any(|x| !x.is_finite()) {
        mesh.normals.clear();
    }
    check(&mesh, f64::MAX).map_err(|problem| Error::mesh(path, problem))?;
    Ok(mesh)
}

/// Writes a mesh to anything that takes bytes.
fn write_mesh_to(
    writer: &mut dyn Write,
    format: MeshFormat,
    mesh: &TriMesh,
    options: &MeshOptions,
) -> std::io::Result<()> {
    match format {
        MeshFormat::Ply => ply::write(writer, mesh, options),
        MeshFormat::Stl => stl::write(writer, mesh, options),
        MeshFormat::Obj => obj::write(writer, mesh, options),
    }
}

/// Says what makes a mesh unusable: an index without its vertex, a coordinate beyond `largest`, a
/// normal without its vertex.
fn check(mesh: &TriMesh, largest: f64) -> Result<(), String> {
    let count = mesh.vertices.len();
    let usable = |x: &f64| x.abs() <= largest;
    if let Some(v) = mesh.vertices.iter().position(|v| !v.iter().all(usable)) {
        return Err(format!(
            "vertex {v} lies at {:?}, which is not finite or too large",
            mesh.vertices[v]
        ));
    }
    let missing = |index: &u32| *index as usize >= count;
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(missing)) {
        let corners = mesh.triangles[t];
        return Err(format!(
            "triangle {t} has corners {corners:?}, but there are {count} vertices"
        ));
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != count {
        return Err(format!("it has {} normals for {count} vertices", mesh.normals.len()));
    }
    Ok(())
}

/// Appends a polygon to `triangles` as a fan around its first corner; says what is wrong with it.
fn push_fan(triangles: &mut Vec<[u32; 3]>, corners: &[u32]) -> Result<(), String> {
    let [first, rest @ ..] = corners else { return Err("has no corners".into()) };
    if rest.len() < 2 {
        return Err(format!("has {} corners", corners.len()));
    }
    triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    Ok(())
}
