//! PLY out: binary, little endian.

use std::io::{self, Write};

use shrouds::TriMesh;

use crate::mesh::records::write_fixed;
use crate::mesh::{MeshOptions, Precision};

pub(super) fn write(
    writer: &mut dyn Write,
    mesh: &TriMesh,
    options: &MeshOptions,
) -> io::Result<()> {
    writer.write_all(header(mesh, options).as_bytes())?;
    let vertices = mesh.vertices.iter();
    let both = vertices.clone().zip(&mesh.normals);
    match (options.precision, mesh.normals.is_empty()) {
        (Precision::Single, true) => write_fixed(writer, vertices, |v, record: &mut [u8; 12]| {
            put(record, v.map(|x| (x as f32).to_le_bytes()));
        }),
        (Precision::Single, false) => write_fixed(writer, both, |(v, n), record: &mut [u8; 24]| {
            let (place, normal) = record.split_at_mut(12);
            put(place, v.map(|x| (x as f32).to_le_bytes()));
            put(normal, n.map(f32::to_le_bytes));
        }),
        (Precision::Double, true) => write_fixed(writer, vertices, |v, record: &mut [u8; 24]| {
            put(record, v.map(f64::to_le_bytes));
        }),
        (Precision::Double, false) => write_fixed(writer, both, |(v, n), record: &mut [u8; 48]| {
            let (place, normal) = record.split_at_mut(24);
            put(place, v.map(f64::to_le_bytes));
            put(normal, n.map(|x| f64::from(x).to_le_bytes()));
        }),
    }?;
    write_fixed(writer, mesh.triangles.iter(), |triangle, record: &mut [u8; 13]| {
        record[0] = 3;
        put(&mut record[1..], triangle.map(u32::to_le_bytes));
    })
}

/// Puts three numbers at the beginning of a record.
fn put<const SIZE: usize>(record: &mut [u8], numbers: [[u8; SIZE]; 3]) {
    record[..3 * SIZE].copy_from_slice(numbers.as_flattened());
}

fn header(mesh: &TriMesh, options: &MeshOptions) -> String {
    let float = match options.precision {
        Precision::Single => "float",
        Precision::Double => "double",
    };
    let names: &[&str] =
        if mesh.normals.is_empty() { &["x", "y", "z"] } else { &["x", "y", "z", "nx", "ny", "nz"] };
    let properties: String =
        names.iter().map(|name| format!("property {float} {name}\n")).collect();
    // Everybody reads int; uint only where it must be.
    let index = if mesh.vertices.len() > i32::MAX as usize { "uint" } else { "int" };
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n{properties}\
         element face {}\nproperty list uchar {index} vertex_indices\nend_header\n",
        options.comment(),
        mesh.vertices.len(),
        mesh.triangles.len()
    )
}
