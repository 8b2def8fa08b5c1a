//! The two conventions that a set of lattice points needs to bound a surface.

use crate::choice::choice;

/// What lies beyond the outermost lattice points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Border {
    /// Outside points: the surface closes over the border of the volume.
    #[default]
    Closed,
    /// Nothing: the surface ends at the outermost lattice planes.
    Open,
}

/// How a lattice face with two inside corners on one diagonal is cut.
///
/// The bilinear function on such a face of a binary volume has its saddle exactly at the threshold,
/// so the asymptotic decider ties and a convention is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum FaceRule {
    /// The inside corners are separated: inside is 6-connected, outside 18-connected.
    #[default]
    Separate,
    /// The inside corners are joined: inside is 18-connected, outside 6-connected.
    Join,
}

choice!(Border, "border":
    Closed = "closed", "Outside: the surface closes over the border";
    Open = "open", "Nothing: the surface ends at the outermost voxel centres";
);

choice!(FaceRule, "faces":
    Separate = "separate", "Keep the inside corners apart (6-connected inside)";
    Join = "join", "Join the inside corners (18-connected inside)";
);
