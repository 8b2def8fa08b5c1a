//! Surfaces of volumes that no memory holds: the steps of [`shrouds::chunks`], with what they find in files
//! of one folder.
//!
//! Every step reads files that steps before it wrote, and writes one, which appears whole or not at all. So
//! steps of one kind may run at the same time, on several machines that share the folder, and twice; what
//! was killed is called again; and what was done is not done again. The same steps write the same bytes.

mod artefact;
#[cfg(feature = "draco")]
mod layer;
mod run;
mod written;

pub use run::{ChunkRun, Totals};

/// The file that tells the work from all other.
const IDENTITY: &str = "identity";
/// The folder of the work on a lattice of half as many points, within that of the finer one.
const COARSER: &str = "coarser";
