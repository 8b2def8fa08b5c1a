//! Smooth surfaces that provably separate the voxels of a segmentation.
//!
//! A binary volume goes in ([`Occupancy`]); out comes a triangle mesh with the topology of the
//! hole-free marching cubes surface whose vertices slide along the grid edges they sit on until a
//! fairness energy of all planar slice curves is minimal. Every voxel centre stays on its own side.
//!
//! The method is that of Nielson, Graf, Holmes, Huang and Phielipp, *Shrouds: Optimal Separating
//! Surfaces for Enumerated Volumes* (2003); equation numbers in this documentation refer to it.
//!
//! ```
//! use shrouds::{shroud, volume::phantom, Settings};
//!
//! let volume = phantom::linked_tori(24)?;
//! let shroud = shroud(&volume, &Settings::default())?;
//! assert_eq!(shroud.surface.vertex_count(), shroud.mesh.vertices.len());
//! println!("{} triangles, {:?}", shroud.mesh.triangles.len(), shroud.report.status);
//! # Ok::<(), shrouds::Error>(())
//! ```
//!
//! The modules below are in the order of the flow; each may use the ones above it that its
//! documentation names, and `tests/layering.rs` holds them to it.

mod choice;
mod error;
mod gather;
mod parallel;
mod random;
mod tree;
mod vector;
pub mod grid;
pub mod volume;
pub mod surface;
pub mod network;
pub mod energy;
pub mod optimize;
pub mod mesh;
pub mod measure;
pub mod check;
pub mod voxelize;
mod settings;
mod pipeline;
pub mod chunks;
pub mod contact;
pub mod polygon;
pub mod containment;

pub use choice::{Choice, Named};
pub use error::Error;
pub use grid::Grid;
pub use mesh::TriMesh;
pub use pipeline::{Shroud, Times, shroud, shroud_observed};
pub use settings::{Setting, Settings};
pub use volume::{Occupancy, Select};
pub use voxelize::voxelize;

/// The README's example runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
