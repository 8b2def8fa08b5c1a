//! Volume and mesh files for [`shrouds`].
//!
//! A volume file becomes a [`Volume`]: its values, x fastest, on a grid that carries the affine of
//! the file, with the name and the unit of its world frame. A mesh, or several
//! with their names and numbers per vertex, goes out as PLY, STL, OBJ, GLB, VTP or 3MF, and comes
//! back from the first three. Output files appear whole or not at all ([`write_atomically`]).
//!
//! Whatever a file claims about itself, memory grows only with the bytes that are there, nothing
//! panics, and every [`Error`] names the file, what is wrong with it and what to do.
//!
//! ```no_run
//! use shrouds::Select;
//! use shrouds_io::{MeshOptions, VolumeOptions, read_volume, write_mesh};
//!
//! let volume = read_volume("liver.nii.gz", &VolumeOptions::default())?;
//! let inside = volume.occupancy(&Select::NonZero)?;
//! # let mesh = shrouds::TriMesh::default();
//! let options = MeshOptions { frame: Some(volume.frame.clone()), ..Default::default() };
//! write_mesh("liver.ply", &mesh, &options)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
mod chunks;
mod error;
mod mesh;
mod pick;
#[cfg(feature = "draco")]
mod precomputed;
mod stream;
mod text;
mod volume;
mod xml;

pub use atomic::write_atomically;
pub use chunks::{ChunkRun, Totals};
pub use error::Error;
pub use mesh::{
    Attribute, Line, MeshFormat, MeshOptions, Part, Precision, mesh_format, read_materials,
    read_mesh, write_lines, write_lines_with, write_materials, write_mesh, write_meshes,
};
#[cfg(feature = "draco")]
pub use precomputed::{VertexBits, write_layer_info};
pub use stream::Progress;
pub use volume::{
    Axes, Contents, ElementType, Frame, RawLayout, Segment, Selected, Values, Volume, VolumeFormat,
    VolumeOptions, read_contents, read_layers, read_occupancy, read_volume, volume_files,
    volume_format, write_labels, write_npy, write_volume, written_format, written_label_format,
};
