//! The one error type of the crate.

/// Why a picture could not be drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The picture has no pixels, or absurdly many.
    #[error("a picture of {width} × {height} pixels: each side must lie between 1 and {limit}")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// The largest allowed side.
        limit: u32,
    },
    /// The memory for the pixels could not be had.
    #[error("there is no memory for a picture of {width} × {height} pixels; draw a smaller one")]
    Memory {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// A setting of the camera, the style or a line set is outside its range.
    #[error("{name} is {value}, but must be {range}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: String,
        /// What is allowed.
        range: &'static str,
    },
    /// A coordinate or normal is infinite or not a number.
    #[error("{what} {index} is {value:?}; repair the mesh or leave that part out")]
    NotFinite {
        /// What kind of thing it belongs to.
        what: &'static str,
        /// Its index.
        index: usize,
        /// What was given.
        value: [f64; 3],
    },
    /// A triangle names a vertex that the mesh does not have.
    #[error(
        "triangle {triangle} names vertex {vertex}, but the mesh has {vertices} vertices, counted from 0"
    )]
    Index {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// Colours or normals do not match the mesh in number.
    #[error("{given} {what} were given for {needed}: give one for each")]
    Length {
        /// What was given.
        what: &'static str,
        /// How many.
        given: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The camera frames so small a part of the scene that positions cannot be told apart.
    #[error("the camera frames too small a part of the scene; widen its frame or lower its zoom")]
    TooClose,
    /// The PNG file could not be written.
    #[error("the PNG picture could not be written: {0}")]
    Png(#[from] png::EncodingError),
    /// The system does not let the server of the test bed do its work.
    #[error("{what} ({cause}); try again, or another port")]
    Serve {
        /// What could not be done.
        what: String,
        /// What the system says.
        cause: String,
    },
}

/// `Ok` when `good`, else the setting's error.
pub(crate) fn require(
    good: bool,
    name: &'static str,
    value: impl std::fmt::Debug,
    range: &'static str,
) -> Result<(), Error> {
    if good { Ok(()) } else { Err(Error::Setting { name, value: format!("{value:?}"), range }) }
}
