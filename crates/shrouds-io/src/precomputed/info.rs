//! What a folder says about the layer in it.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use shrouds::Grid;

use super::VertexBits;
use crate::atomic::write_atomically;
use crate::error::Error;

/// Writes the `info` of a segmentation layer to a folder, and that of its meshes to the folder `mesh` in it,
/// both of which are made if need be. `grid` is the lattice of the voxels in nanometres, along the axes of
/// the world. Meshes are Draco-coded with so many bits, or of the legacy kind with none.
///
/// # Errors
/// [`Error::Io`] and the others of [`write_atomically`].
pub fn write_layer_info(folder: &Path, grid: &Grid, bits: Option<VertexBits>) -> Result<(), Error> {
    let meshes = folder.join("mesh");
    fs::create_dir_all(&meshes).map_err(|cause| Error::Io {
        path: meshes.clone(),
        doing: "make it",
        cause,
        advice: "check the folder and the disk",
    })?;
    write_json(&meshes.join("info"), &mesh_info(grid, bits))?;
    write_json(&folder.join("info"), &layer_info(grid))
}

/// `mip` is for cloud-volume and igneous: which of the scales the meshes were made at.
fn mesh_info(grid: &Grid, bits: Option<VertexBits>) -> Value {
    let Some(bits) = bits else { return json!({ "@type": "neuroglancer_legacy_mesh", "mip": 0 }) };
    json!({
        "@type": "neuroglancer_multilod_draco",
        "vertex_quantization_bits": bits.count(),
        "transform": grid.affine().as_flattened(),
        "lod_scale_multiplier": 1.0,
        "mip": 0,
    })
}

fn layer_info(grid: &Grid) -> Value {
    json!({
        "@type": "neuroglancer_multiscale_volume",
        "type": "segmentation",
        "data_type": "uint64",
        "num_channels": 1,
        "mesh": "mesh",
        "scales": [{
            "key": "0",
            "size": grid.dims(),
            "resolution": grid.spacing(),
            "voxel_offset": [0, 0, 0],
            "chunk_sizes": [[64, 64, 64]],
            "encoding": "raw",
        }],
    })
}

fn write_json(path: &Path, value: &Value) -> Result<(), Error> {
    write_atomically(path, |writer| writer.write_all(value.to_string().as_bytes()))
}
