//! What a volume file holds besides the values of one lattice.

use std::path::PathBuf;

/// What a volume file holds besides the values of one lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// Volumes on the same lattice: frames of a series, channels, or layers of segments.
    pub layers: usize,
    /// Resolutions to choose from with [`VolumeOptions::level`](crate::VolumeOptions::level).
    pub levels: usize,
    /// The segments that the file names, in its order.
    pub segments: Vec<Segment>,
    /// Names of the arrays to choose from with [`VolumeOptions::array`](crate::VolumeOptions::array),
    /// if there are several.
    pub arrays: Vec<String>,
    /// What is doubtful about the file, and what was done about it.
    pub warnings: Vec<String>,
    /// The files besides the one that was named: those of the data of a header, the header of data,
    /// the layout of raw voxels. Of a folder, none are named here.
    pub files: Vec<PathBuf>,
}

impl Default for Contents {
    fn default() -> Self {
        let (segments, arrays, warnings, files) = Default::default();
        Self { layers: 1, levels: 1, segments, arrays, warnings, files }
    }
}

impl Contents {
    /// Whether the layers are those of segments that overlap, and not the frames of a series or channels.
    pub fn has_layers_of_segments(&self) -> bool {
        self.segments.iter().any(|segment| segment.layer > 0)
    }

    /// The segments that have voxels in a layer: of a series, all in each frame.
    pub fn segments_of(&self, layer: usize) -> impl Iterator<Item = &Segment> {
        let in_layers = self.has_layers_of_segments();
        self.segments.iter().filter(move |segment| !in_layers || segment.layer == layer)
    }
}

/// A named part of a segmentation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// Its name in the file.
    pub name: String,
    /// The value of its voxels.
    pub label: i128,
    /// The layer those voxels are in. Segments of different layers may overlap, and have the same
    /// label.
    pub layer: usize,
}
