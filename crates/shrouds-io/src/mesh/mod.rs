//! Mesh files: PLY, STL and OBJ, out and in; GLB, VTP and 3MF, out.

mod glb;
mod lines;
mod materials;
mod obj;
mod part;
pub(crate) mod ply;
mod ply_read;
mod records;
mod stl;
mod threemf;
mod vtk_xml;
mod vtp;
mod xml;

use std::fs;
use std::io::Read;
use std::path::Path;

use shrouds::TriMesh;
use shrouds::materials::MaterialMesh;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::volume::Frame;

pub use lines::{Line, write_lines, write_lines_with};
pub use materials::write_materials;
pub use part::{Attribute, Part};

use part::{Parts, check_mesh};

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Polygon File Format, `.ply`: written binary little endian, with normals and attributes.
    Ply,
    /// Stereolithography, `.stl`: written binary, every triangle with its own three corners.
    Stl,
    /// Wavefront, `.obj`: text, with normals.
    Obj,
    /// Binary glTF 2.0, `.glb`, for viewers: with normals and attributes. Coordinates are not turned
    /// (y up) nor scaled (metres) to glTF's conventions. Written, not read.
    Glb,
    /// VTK XML PolyData, `.vtp`: arrays as raw binary data, with normals and attributes. Written, not
    /// read.
    Vtp,
    /// 3D Manufacturing Format, `.3mf`, for printing: triangles and their unit. Written, not read.
    ThreeMf,
}

impl MeshFormat {
    /// Whether it holds [`Attribute`]s; from other formats they are left out.
    pub fn holds_attributes(self) -> bool {
        matches!(self, Self::Ply | Self::Glb | Self::Vtp)
    }

    /// Whether it holds several [`Part`]s that can be told apart.
    pub fn holds_parts(self) -> bool {
        self != Self::Stl
    }

    /// Whether [`read_mesh`] reads it.
    pub fn is_read(self) -> bool {
        matches!(self, Self::Ply | Self::Stl | Self::Obj)
    }

    /// The largest coordinate that it holds with a precision.
    fn largest(self, precision: Precision) -> f64 {
        match self {
            Self::Stl | Self::Glb => Precision::Single.largest(),
            _ => precision.largest(),
        }
    }
}

/// Size of the floats of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits, about seven digits: what every program reads.
    #[default]
    Single,
    /// 64 bits: nothing is lost.
    Double,
}

impl Precision {
    /// Rounding may move a vertex by this part of the smallest spacing: a twentieth of the distance
    /// that vertices keep from lattice points.
    const ROUNDING: f64 = 1e-4;

    /// The least that keeps every voxel on its side, where no coordinate is larger than `largest` and
    /// voxels are at least `spacing` apart: single, unless it would move a vertex by more than a
    /// ten-thousandth of the spacing.
    pub fn needed(largest: f64, spacing: f64) -> Self {
        let error = largest * f64::from(f32::EPSILON) / 2.0;
        if error > Self::ROUNDING * spacing { Self::Double } else { Self::Single }
    }

    /// The largest coordinate it holds.
    fn largest(self) -> f64 {
        match self {
            Self::Single => f32::MAX.into(),
            Self::Double => f64::MAX,
        }
    }
}

/// How to write a mesh file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeshOptions {
    /// Floats of positions in PLY and VTP, and of normals in PLY. STL and GLB have 32 bits always, GLB
    /// relative to the middle of the mesh; OBJ and 3MF are text, with as many digits as the precision
    /// needs.
    pub precision: Precision,
    /// Frame of the coordinates, which the file names: `SPACE=RAS` or `SPACE=LPS` in the comment of
    /// PLY, STL and OBJ or in the field data of VTP makes 3D Slicer place the mesh where it belongs.
    /// 3MF needs the unit: millimetres, unless it is one of nm, um, cm, m, in and ft.
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
        "glb" => Ok(MeshFormat::Glb),
        "vtp" => Ok(MeshFormat::Vtp),
        "3mf" => Ok(MeshFormat::ThreeMf),
        _ => {
            let known = "meshes are written to .glb, .vtp, .3mf, .ply, .stl and .obj, and read from \
                         .ply, .stl and .obj";
            Err(Error::Extension { path: path.into(), kind: "mesh", known })
        }
    }
}

/// Writes a mesh in the format that the extension of `path` names; the file appears whole or not at
/// all.
///
/// # Errors
/// As for [`write_meshes`].
pub fn write_mesh(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    options: &MeshOptions,
) -> Result<(), Error> {
    write_meshes(path, &[mesh.into()], options)
}

/// Writes several meshes, with names and numbers per vertex, to one file in the format that the
/// extension of `path` names; the file appears whole or not at all.
///
/// Names are those of objects in OBJ, 3MF and GLB, and an array `names` of VTP. PLY has one list of
/// vertices, with a property `label`, and VTP one of triangles, with cell data `label`: the labels of
/// the parts, or their numbers from 1 where one has no label. Attributes are properties of PLY, point
/// data of VTP, and attributes of GLB in capitals after an underscore (`_DELTA`); other formats leave
/// them out. Normals go out where all parts have them.
///
/// # Errors
/// [`Error::Extension`] for an unknown extension, [`Error::Unwritable`] when a mesh refers to
/// vertices it does not have, has a coordinate that is not finite or too large for the precision, an
/// attribute has not one finite value per vertex or no usable name, parts differ in the names of
/// their attributes, or they do not fit the format; otherwise as for [`write_atomically`].
pub fn write_meshes(
    path: impl AsRef<Path>,
    parts: &[Part],
    options: &MeshOptions,
) -> Result<(), Error> {
    let path = path.as_ref();
    let format = mesh_format(path)?;
    let unwritable = |problem| Error::Unwritable { path: path.into(), problem };
    let largest = format.largest(options.precision);
    let checked = Parts::check(parts, format, largest).map_err(unwritable)?;
    match format {
        MeshFormat::Ply => {
            let file = ply::Ply::new(checked, options).map_err(unwritable)?;
            write_atomically(path, |writer| file.write(writer))
        }
        MeshFormat::Stl => write_atomically(path, |writer| stl::write(writer, checked, options)),
        MeshFormat::Obj => write_atomically(path, |writer| obj::write(writer, checked, options)),
        MeshFormat::Glb => {
            let file = glb::Glb::new(checked, options).map_err(unwritable)?;
            write_atomically(path, |writer| file.write(writer))
        }
        MeshFormat::Vtp => write_atomically(path, |writer| vtp::write(writer, checked, options)),
        MeshFormat::ThreeMf => {
            threemf::check(checked).map_err(unwritable)?;
            write_atomically(path, |writer| threemf::write(writer, checked, options))
        }
    }
}

/// Reads a mesh: PLY or STL, binary or text, or OBJ, by the extension of `path`.
///
/// Polygons become fans of triangles. STL has no vertices of its own: corners at exactly the same
/// place become one. Several objects of a file become one mesh. Normals are kept where the file gives
/// a finite one for every vertex.
///
/// # Errors
/// [`Error::Extension`] for an unknown extension, [`Error::Unsupported`] for a format that is only
/// written, [`Error::Io`] when the file cannot be read,
/// [`Error::Content`] when it is of another kind than its extension says, [`Error::Mesh`] when it is
/// damaged or truncated, a coordinate is not finite or a face names a vertex that is not there.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriMesh, Error> {
    let path = path.as_ref();
    let format = mesh_format(path)?;
    if path.is_dir() {
        return Err(Error::unsupported(path, "a folder", "name one of the files in it"));
    }
    if !format.is_read() {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let advice = "meshes are read from .ply, .stl and .obj: write it again as one of those";
        return Err(Error::unsupported(path, format!("a .{extension} mesh"), advice));
    }
    let bytes = fs::read(path).map_err(|cause| Error::open(path, cause))?;
    let mut mesh = match format {
        MeshFormat::Stl => stl::read(path, &bytes),
        MeshFormat::Obj => obj::read(path, &bytes),
        _ => ply_read::read(path, &bytes),
    }?;
    if mesh.normals.iter().flatten().any(|x| !x.is_finite()) {
        mesh.normals.clear();
    }
    check_mesh(&mesh, f64::MAX).map_err(|problem| Error::mesh(path, problem))?;
    Ok(mesh)
}

/// Reads a mesh of several materials, as [`write_materials`] writes it: a PLY file whose faces have the
/// properties `first` and `second`. Nothing for any other mesh.
///
/// # Errors
/// As [`read_mesh`] for such a file, and [`Error::Mesh`] when a triangle has one label on both sides or a
/// line names a vertex that is not there.
pub fn read_materials(path: impl AsRef<Path>) -> Result<Option<MaterialMesh>, Error> {
    let path = path.as_ref();
    if mesh_format(path)? != MeshFormat::Ply || path.is_dir() {
        return Ok(None);
    }
    let mut head = Vec::new();
    let mut file = fs::File::open(path).map_err(|cause| Error::open(path, cause))?;
    let read = (&mut file).take(LONGEST_HEADER).read_to_end(&mut head);
    read.map_err(|cause| Error::open(path, cause))?;
    if !ply_read::has_labels(&head) {
        return Ok(None);
    }
    file.read_to_end(&mut head).map_err(|cause| Error::open(path, cause))?;
    let mesh = ply_read::parsed(path, &head)?;
    check_mesh(&mesh.surface, f64::MAX).map_err(|problem| Error::mesh(path, problem))?;
    let vertices = mesh.surface.vertices.len();
    if let Some(n) = mesh.pairs.iter().position(|[first, second]| first == second) {
        return Err(Error::mesh(path, format!("triangle {n} has one label on both sides")));
    }
    if mesh.lines.as_flattened().iter().any(|&v| v as usize >= vertices) {
        return Err(Error::mesh(path, "an edge names a vertex that is not there"));
    }
    Ok(Some(mesh))
}

/// Bytes of a file in which its header is looked for.
const LONGEST_HEADER: u64 = 1 << 16;

/// Appends a polygon to `triangles` as a fan around its first corner; says what is wrong with it.
fn push_fan(triangles: &mut Vec<[u32; 3]>, corners: &[u32]) -> Result<(), String> {
    let [first, rest @ ..] = corners else { return Err("has no corners".into()) };
    if rest.len() < 2 {
        return Err(format!("has {} corners", corners.len()));
    }
    triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    Ok(())
}
