//! Triangles with whole coordinates as the bytes of a Draco file.

use draco_core::draco_types::DataType;
use draco_core::encoder_buffer::EncoderBuffer;
use draco_core::encoder_options::EncoderOptions;
use draco_core::geometry_attribute::{GeometryAttributeType, PointAttribute};
use draco_core::mesh::Mesh;
use draco_core::mesh_encoder::MeshEncoder;

/// The bytes of a mesh, the positions without loss.
pub(super) fn encode(positions: &[[u32; 3]], triangles: &[[u32; 3]]) -> Result<Vec<u8>, String> {
    let mut attribute = PointAttribute::new();
    let kind = GeometryAttributeType::Position;
    attribute.init(kind, 3, DataType::Uint32, false, positions.len());
    let bytes: Vec<u8> = positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    attribute.buffer_mut().write(0, &bytes);
    let mut mesh = Mesh::new();
    mesh.set_num_points(positions.len());
    mesh.add_attribute(attribute);
    mesh.try_set_num_faces(triangles.len()).map_err(|error| error.to_string())?;
    mesh.set_faces_from_flat_indices(triangles.as_flattened());
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    let coded = encoder.encode(&EncoderOptions::new(), &mut buffer);
    coded.map_err(|error| error.to_string())?;
    Ok(buffer.data().to_vec())
}
