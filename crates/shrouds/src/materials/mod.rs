//! Several materials: in a volume of labels, out one network of interfaces for all of them.
mod cell;
mod face;
mod interfaces;
mod labels;
mod marks;

pub use interfaces::{Interfaces, Junction};
pub use labels::Labels;
