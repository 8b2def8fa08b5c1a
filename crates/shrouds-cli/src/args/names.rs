//! Named choices. The names are the same on the command line and in the report.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// Coordinates of a mesh.
#[derive(ValueEnum, Serialize, Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FrameChoice {
    /// Those of the file, in its unit of length
    World,
    /// Voxel indices along x, y, z
    Index,
}

/// Order of the axes of an NPY array.
#[derive(ValueEnum, Serialize, Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Axes {
    /// Indexed `[z, y, x]`
    Zyx,
    /// Indexed `[x, y, z]`
    Xyz,
}

/// What to make of two volumes.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operation {
    /// What is inside A or B
    Union,
    /// What is inside both
    Intersect,
    /// What is inside A and not B
    Subtract,
    /// What is inside one of them only
    Xor,
}

/// How the side of a point between voxels is found.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Interpolation {
    /// That of the nearest voxel
    Nearest,
    /// Where at least half is inside: of what lies around the point, or, on a coarser lattice, of the
    /// new voxel
    Linear,
}

/// For which labels there is a mesh.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Each {
    /// For each one but 0
    All,
}

/// How the topology of a `.shroud` file is coded.
#[derive(ValueEnum, Serialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Profile {
    /// Hundreds of millions of voxels a second
    Fast,
    /// A third smaller, two microseconds per vertex
    Dense,
}

/// Where the places of the vertices in a `.shroud` file come from.
#[derive(ValueEnum, Serialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Places {
    /// The shroud of the volume, with the options of `shrouds mesh`
    Shroud,
    /// The isosurface of the grey values at --threshold
    Isosurface,
    /// The mesh that is packed
    Mesh,
}

impl Places {
    /// What a message calls the surface.
    pub(crate) fn surface(self) -> &'static str {
        match self {
            Self::Shroud => "shroud",
            Self::Isosurface => "isosurface",
            Self::Mesh => "mesh",
        }
    }
}

/// Numbers for every vertex of a mesh.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Attribute {
    /// Place on the grid edge: 1 at its inside end, 0 at the outside end
    Delta,
    /// Mean and Gaussian curvature, positive where convex: 1/length, 1/length²
    Curvature,
}

/// Numbers that are shown as colours.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Field {
    /// Mean of the principal curvatures, positive where convex
    MeanCurvature,
    /// Product of the principal curvatures, negative on saddles
    GaussianCurvature,
    /// The largest principal curvature
    MaximumCurvature,
    /// The smallest principal curvature
    MinimumCurvature,
    /// Place on the grid edge: 1 at its inside end, 0 at the outside end
    Delta,
}

/// Which winding numbers of a mesh are inside.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Winding {
    /// All but 0: the union of overlapping parts
    NonZero,
    /// Those above 0: parts that face inwards are empty
    Positive,
    /// The odd ones: overlaps are empty
    Odd,
}

/// The axis across some planes.
#[derive(ValueEnum, Serialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PlaneAxis {
    /// That of the coordinates
    X,
    /// That of the coordinates
    Y,
    /// That of the coordinates
    Z,
    /// The first of the volume's lattice
    I,
    /// The second of the lattice
    J,
    /// The third of the lattice: k = 12 is slice 12
    K,
}

impl PlaneAxis {
    /// 0, 1 or 2.
    pub(crate) fn index(self) -> usize {
        match self {
            Self::X | Self::I => 0,
            Self::Y | Self::J => 1,
            Self::Z | Self::K => 2,
        }
    }

    /// Whether it is that of a lattice.
    pub(crate) fn is_of_lattice(self) -> bool {
        matches!(self, Self::I | Self::J | Self::K)
    }

    /// As it is typed.
    pub(crate) fn name(self) -> &'static str {
        let names = if self.is_of_lattice() { ["i", "j", "k"] } else { ["x", "y", "z"] };
        names[self.index()]
    }
}
