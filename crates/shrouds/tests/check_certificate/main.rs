//! The independent check against formulas, brute force and deliberately broken meshes.

mod intersection;
mod margin;
mod report;
mod separation;
mod shapes;
mod structure;
mod voxel_topology;
