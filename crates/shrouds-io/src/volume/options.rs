//! How to read a volume file.

use crate::stream::Progress;
use crate::volume::RawLayout;

/// Order of the axes in files that do not name them (NPY, NPZ).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axes {
    /// The array is indexed `[z, y, x]`.
    #[default]
    Zyx,
    /// The array is indexed `[x, y, z]`.
    Xyz,
}

/// How to read a volume file.
#[derive(Clone, Copy, Default)]
pub struct VolumeOptions<'a> {
    /// Order of the axes of a NumPy array; other formats name their axes. Default `[z, y, x]`.
    pub axes: Axes,
    /// Distance between lattice points along x, y, z. Given, it replaces the whole frame of the
    /// file but its unit: first point at the origin, axes along those of the world. Default: what
    /// the file says; 1 where it says nothing.
    pub spacing: Option<[f64; 3]>,
    /// Which volume of a file that holds several on one lattice, from 0 on: a frame of a series, a
    /// channel, or a layer of segments that overlap. Default: the only one; for layers of segments
    /// all of them.
    pub layer: Option<usize>,
    /// Which array of a file that holds several, by its name. Default: the only one, or the one that
    /// the format calls the main one.
    pub array: Option<&'a str>,
    /// How a raw file is to be read; other formats say so themselves. Default: as a file of JSON of
    /// the same name says.
    pub raw: Option<RawLayout>,
    /// Which resolution of a file that holds several, from the finest, 0, on. Default 0.
    pub level: usize,
    /// Called while the file is read, at least every few megabytes. Default: nothing.
    pub progress: Option<Progress<'a>>,
}

impl std::fmt::Debug for VolumeOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VolumeOptions")
            .field("axes", &self.axes)
            .field("spacing", &self.spacing)
            .field("layer", &self.layer)
            .field("array", &self.array)
            .field("raw", &self.raw)
            .field("level", &self.level)
            .field("progress", &self.progress.is_some())
            .finish()
    }
}
