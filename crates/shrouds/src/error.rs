//! The one error type of the library.

/// What can be wrong with what a caller hands in.
///
/// Not converging is no error: it is a status in the report of the optimisation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A dimension is zero, or larger than a crossing can name.
    #[error(
        "grid of {dims:?} lattice points: each dimension must lie between 1 and {limit}; crop or split the volume"
    )]
    Dimensions {
        /// Lattice points along x, y, z.
        dims: [usize; 3],
        /// The largest allowed dimension.
        limit: usize,
    },
    /// The spacing or the affine is not a usable frame.
    #[error(
        "the frame {0} is not usable: spacing must be positive and finite and the axes independent; give the spacing explicitly"
    )]
    Frame(String),
    /// The number of values does not fit the grid.
    #[error("{values} values were given for a grid of {dims:?} = {points} lattice points")]
    Length {
        /// Number of values given.
        values: usize,
        /// Lattice points along x, y, z.
        dims: [usize; 3],
        /// Their product.
        points: usize,
    },
    /// A voxel value is not a number, so it has no side.
    #[error(
        "the value at voxel {voxel:?} (x, y, z) is not a number, and {others} more are not; replace them, for example by 0 where nothing was measured"
    )]
    NotANumber {
        /// Index of the first such voxel.
        voxel: [usize; 3],
        /// How many more there are.
        others: usize,
    },
    /// A setting is outside its range.
    #[error("{name} is {value}, but must be {range}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: String,
        /// What is allowed.
        range: &'static str,
    },
    /// What was found for a chunk of a volume does not fit its voxels.
    #[error("what was found for chunk {chunk:?} is not that of its voxels: make it again")]
    Chunk {
        /// Its index along x, y, z.
        chunk: [usize; 3],
    },
    /// A setting has no such value.
    #[error("{setting} is {value:?}, but must be {known}")]
    Choice {
        /// Name of the setting.
        setting: &'static str,
        /// What was given.
        value: String,
        /// What there is.
        known: String,
    },
    /// No setting has this name.
    #[error("there is no setting named {name:?}; choose one of {known}")]
    UnknownSetting {
        /// What was given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The surface has more vertices than a 32-bit index can name.
    #[error(
        "the surface has {vertices} vertices; at most {limit} can be indexed: crop or split the volume"
    )]
    TooManyVertices {
        /// Number of crossings found.
        vertices: u64,
        /// The largest number that can be indexed.
        limit: u64,
    },
    /// An open border needs two lattice points along each axis for a cell to exist.
    #[error(
        "an open border needs at least 2 lattice points along each axis, not {dims:?}; use a closed border"
    )]
    NoCells {
        /// Lattice points along x, y, z.
        dims: [usize; 3],
    },
    /// A volume of several slices stands where an image is wanted.
    #[error(
        "an image has one slice along z, not the {slices} of this volume; take one of them with Occupancy::slice"
    )]
    NotAnImage {
        /// Lattice points along z.
        slices: usize,
    },
    /// There is no such slice.
    #[error("there is no slice {axis}={index}: they go from {axis}=0 to {axis}={last}")]
    NoSlice {
        /// The axis across the slices: x, y or z.
        axis: char,
        /// The slice asked for.
        index: usize,
        /// The last one there is.
        last: usize,
    },
    /// A range of indices holds no lattice points of the volume.
    #[error(
        "{axis}={start}..{end} is no range of this volume's lattice points; give a first index below the end, which is at most {points}"
    )]
    NoSuchPoints {
        /// The axis: x, y or z.
        axis: char,
        /// The first index of the range.
        start: usize,
        /// The index after the last one.
        end: usize,
        /// Lattice points along the axis.
        points: usize,
    },
    /// Two volumes that should share a lattice do not.
    #[error(
        "the volumes lie on different lattices: {differences}; resample one of them onto the lattice of the other"
    )]
    DifferentLattices {
        /// What differs, with both values.
        differences: String,
    },
    /// Distances need axes at right angles.
    #[error(
        "the axes {axes} of the lattice meet at {degrees:.4} degrees, but offsets need right angles; resample the volume onto a lattice whose axes are orthogonal"
    )]
    Sheared {
        /// Two of x, y and z.
        axes: &'static str,
        /// The angle between them.
        degrees: f64,
    },
    /// There is not enough memory for a volume.
    #[error(
        "a volume of {dims:?} lattice points takes {bytes} bytes, more memory than there is; choose fewer points or a larger spacing"
    )]
    Memory {
        /// Lattice points along x, y, z.
        dims: [usize; 3],
        /// Size of the volume's bits.
        bytes: u64,
    },
    /// A part of a containment scene makes no sense.
    #[error("{part}: {problem}")]
    Scene {
        /// Which part, with its number where there are several.
        part: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// No phantom has this name.
    #[error("there is no phantom named {name:?}; choose one of {known}")]
    UnknownPhantom {
        /// What was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A text does not describe an energy.
    #[error(
        "{text:?} is no energy: {reason}; write a sum of measures with weights such as bending+0.3*variation, the measures being {known}"
    )]
    Energy {
        /// What was given.
        text: String,
        /// What is wrong with it.
        reason: String,
        /// The measures there are, with their arguments.
        known: String,
    },
    /// A mesh has no extent that a lattice could be fitted to.
    #[error(
        "no lattice fits the mesh, because {0}; take the lattice of a volume, or give the spacing"
    )]
    NoExtent(&'static str),
    /// A mesh refers to a vertex that it does not have, or a coordinate is not finite.
    #[error("the mesh is damaged: {0}")]
    Mesh(String),
}
