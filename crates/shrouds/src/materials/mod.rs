//! Several materials: in a volume of labels, out one network of interfaces for all of them.
//!
//! The binary flow again, with labels in place of bits. A *crossing* is a grid edge whose ends have
//! different labels; it carries one vertex, shared by both. A *junction* is a lattice face in which
//! three or four labels meet, and carries a point that moves in the face; *cell points* join the
//! junctions of a cell. Every interface is there once, between its two labels, and the interfaces of a
//! label together are closed: every lattice point lies inside its own label, wherever the points
//! are. `docs/materials.md` tells the rules.
//!
//! A volume of one label and background is left to the binary flow, and has its very mesh.
//!
//! Uses: everything above it in the flow.

mod cell;
mod ends;
mod face;
mod interfaces;
mod keep;
mod labels;
mod lines;
mod marks;
mod mesh;
mod network;
mod newton;
mod optimize;
mod rows;
mod shrouds;
mod span;
mod start;
mod window;

pub use interfaces::{Interfaces, Junction};
pub use keep::LabelVolume;
pub use labels::Labels;
pub use mesh::MaterialMesh;
pub use optimize::{Optimum, Report};
pub use shrouds::{Settings, Shrouds, shrouds};
