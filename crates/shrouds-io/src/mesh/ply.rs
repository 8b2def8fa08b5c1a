//! PLY out: binary, little endian.

use std::io::{self, Write};

use shrouds::TriMesh;

use crate::mesh::{MeshOptions, Precision};

pub(super) fn write(
    writer: &mut dyn Write,
    mesh: &TriMesh,
    options: &MeshOptions,
) -> io::Result<()> {
    writer.write_all(header(mesh, options).as_bytes())?;
    let mut record = Vec::with_capacity(48);
    for (index, vertex) in mesh.vertices.iter().enumerate() {
        let normal = mesh.normals.get(index);
        record.clear();
        for x in vertex.iter().chain(normal.into_iter().flatten()) {
            match options.precision {
                Precision::Single => record.extend_from_slice(&(*x as f32).to_le_bytes()),
                Precision::Double => record.extend_from_slice(&x.to_le_bytes()),
            }
        }
        writer.write_all(&record)?;
    }
    for triangle in &mesh.triangles {
        let mut record = [3; 13];
        for (bytes, corner) in record[1..].as_chunks_mut::<4>().0.iter_mut().zip(triangle) {
            *bytes = corner.to_le_bytes();
        }
        writer.write_all(&record)?;
    }
    Ok(())
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
