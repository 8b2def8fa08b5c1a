//! Meshes of several materials: triangles with the labels on both sides, and junction lines.

use std::io::{self, Write};
use std::path::Path;

use shrouds::materials::MaterialMesh;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::mesh::part::{Part, check_mesh};
use crate::mesh::records::{put, write_fixed};
use crate::mesh::vtk_xml::{Array, Counts, Kind, Section, field_data, write_file};
use crate::mesh::{MeshFormat, MeshOptions, Precision, mesh_format, write_meshes};

/// Writes the interfaces of several labels in the format that the extension of `path` names; the file
/// appears whole or not at all.
///
/// Triangles face the second label of their pair. PLY has the pair as properties `first` and `second`
/// of its faces, and the junction lines as its element `edge`; VTP has it as cell data `labels` with
/// two components, 0 and 0 for the junction lines, which are its lines. GLB, OBJ and 3MF have an object
/// for each pair, named `first-second`; all objects have the same corners where they meet.
///
/// # Errors
/// [`Error::Unwritable`] for STL, for labels of more than 32 bits in PLY, and as for
/// [`write_meshes`](crate::write_meshes); otherwise as there.
pub fn write_materials(
    path: impl AsRef<Path>,
    mesh: &MaterialMesh,
    options: &MeshOptions,
) -> Result<(), Error> {
    let path = path.as_ref();
    let format = mesh_format(path)?;
    let unwritable = |problem| Error::Unwritable { path: path.into(), problem };
    check_mesh(&mesh.surface, format.largest(options.precision)).map_err(unwritable)?;
    match format {
        MeshFormat::Stl => {
            let problem = "STL has no place for the labels of triangles; write .ply or .vtp";
            Err(unwritable(problem.into()))
        }
        MeshFormat::Ply => {
            let is_wide = |label: &&i64| i32::try_from(**label).is_err();
            if let Some(label) = mesh.pairs.as_flattened().iter().find(is_wide) {
                let problem = format!("the label {label} is too large for PLY; write .vtp");
                return Err(unwritable(problem));
            }
            write_atomically(path, |writer| write_ply(writer, mesh, options))
        }
        MeshFormat::Vtp => write_atomically(path, |writer| write_vtp(writer, mesh, options)),
        MeshFormat::Obj | MeshFormat::Glb | MeshFormat::ThreeMf => {
            let interfaces: Vec<_> = mesh
                .contacts()
                .into_keys()
                .map(|pair| {
                    let [first, second] = pair;
                    (format!("{first}-{second}"), mesh.interface(pair))
                })
                .collect();
            let part = |(name, mesh)| Part { name, label: None, mesh, attributes: &[] };
            let parts: Vec<Part> =
                interfaces.iter().map(|(name, mesh)| part((name.as_str(), mesh))).collect();
            write_meshes(path, &parts, options)
        }
    }
}

fn write_ply(writer: &mut dyn Write, mesh: &MaterialMesh, options: &MeshOptions) -> io::Result<()> {
    let (surface, lines) = (&mesh.surface, &mesh.lines);
    let float = if options.precision == Precision::Single { "float" } else { "double" };
    let header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n\
         property {float} x\nproperty {float} y\nproperty {float} z\nelement face {}\n\
         property list uchar int vertex_indices\nproperty int first\nproperty int second\n\
         element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
        options.comment(),
        surface.vertices.len(),
        surface.triangles.len(),
        lines.len(),
    );
    writer.write_all(header.as_bytes())?;
    match options.precision {
        Precision::Single => {
            write_fixed(writer, surface.vertices.iter(), |place, record: &mut [u8; 12]| {
                put(record, place.map(|x| (x as f32).to_le_bytes()).as_flattened());
            })?;
        }
        Precision::Double => {
            write_fixed(writer, surface.vertices.iter(), |place, record: &mut [u8; 24]| {
                put(record, place.map(f64::to_le_bytes).as_flattened());
            })?;
        }
    }
    let faces = surface.triangles.iter().zip(&mesh.pairs);
    write_fixed(writer, faces, |(triangle, pair), record: &mut [u8; 21]| {
        record[0] = 3;
        let rest = put(&mut record[1..], triangle.map(u32::to_le_bytes).as_flattened());
        put(rest, pair.map(|label| (label as i32).to_le_bytes()).as_flattened());
    })?;
    write_fixed(writer, lines.iter(), |line, record: &mut [u8; 8]| {
        put(record, line.map(u32::to_le_bytes).as_flattened());
    })
}

fn write_vtp(writer: &mut dyn Write, mesh: &MaterialMesh, options: &MeshOptions) -> io::Result<()> {
    let (surface, lines) = (&mesh.surface, &mesh.lines);
    let (points, count) = (surface.vertices.len(), surface.triangles.len());
    // The data of cells are those of lines first, then those of polygons.
    let pairs = || std::iter::repeat_n([0; 2], lines.len()).chain(mesh.pairs.iter().copied());
    let labels =
        Array::new("labels", Kind::Int64, [lines.len() + count, 2], pairs, |pair, bytes| {
            bytes.extend_from_slice(pair.map(i64::to_le_bytes).as_flattened());
        });
    let places = || surface.vertices.iter();
    let kind = Kind::up_to(3 * count.max(points).max(lines.len()));
    fn cells<'a, const N: usize>(cells: &'a [[u32; N]], kind: Kind) -> Vec<Array<'a>> {
        let ends = || (1..=cells.len() as u64).map(|n| [N as u64 * n]);
        let corners = || cells.iter();
        vec![
            Array::new("connectivity", kind, [N * cells.len(), 1], corners, move |cell, bytes| {
                kind.put(*cell, bytes);
            }),
            Array::new("offsets", kind, [cells.len(), 1], ends, move |end, bytes| {
                kind.put(end, bytes);
            }),
        ]
    }
    let sections = [
        Section { name: "CellData", arrays: vec![labels] },
        Section { name: "Points", arrays: vec![Array::points(points, options.precision, places)] },
        Section { name: "Lines", arrays: cells(lines, kind) },
        Section { name: "Polys", arrays: cells(&surface.triangles, kind) },
    ];
    let counts = Counts { points, lines: lines.len(), polygons: count };
    write_file(writer, &counts, &field_data(options), &sections)
}
