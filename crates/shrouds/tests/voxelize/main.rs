//! Meshes become volumes.
#![allow(clippy::unwrap_used)]

mod damaged;
mod exact;
mod fit;
mod refused;
mod shapes;
