//! What was packed, and into how much.

use serde::Serialize;
use shrouds_codec::Packed;

use super::places::Distances;
use crate::args::{PackArgs, Places, Profile};
use crate::console::{grouped, number, plural};
use crate::report::name;

#[derive(Serialize)]
pub(super) struct Report {
    input: String,
    output: String,
    selection: String,
    dims: [usize; 3],
    profile: Profile,
    /// Labels that were packed; null for a volume.
    pub(super) labels: Option<usize>,
    /// Voxels inside; null for labels.
    pub(super) inside: Option<u64>,
    /// Grid edges whose ends differ: the vertices of the surface, or of the boundaries of all labels.
    vertices: u64,
    /// Bytes of the file, and of the topology in it.
    bytes: u64,
    topology_bytes: u64,
    chunks: u64,
    /// Bits of topology per triangle, of which there are two for each vertex; null without vertices.
    bits_per_triangle: Option<f64>,
    /// Null with --bits 0.
    pub(super) planes: Option<PlanesReport>,
    pub(super) seconds: f64,
}

/// The bit planes.
#[derive(Serialize)]
pub(super) struct PlanesReport {
    /// Which surface they are of.
    pub(super) from: Places,
    /// How many there are.
    pub(super) bits: u8,
    pub(super) bytes: u64,
    /// How far the surface that comes back is from it.
    pub(super) distances: Distances,
}

impl Report {
    pub(super) fn new(
        args: &PackArgs,
        selection: String,
        dims: [usize; 3],
        packed: &Packed,
    ) -> Self {
        let bits = 8.0 * packed.topology as f64;
        Self {
            input: name(&args.input),
            output: name(&args.output),
            selection,
            dims,
            profile: args.profile,
            labels: None,
            inside: None,
            vertices: packed.vertices,
            bytes: packed.bytes,
            topology_bytes: packed.topology,
            chunks: packed.chunks,
            bits_per_triangle: (packed.vertices > 0).then(|| bits / (2.0 * packed.vertices as f64)),
            planes: None,
            seconds: 0.0,
        }
    }

    pub(super) fn in_words(&self) -> String {
        let what =
            self.labels.map_or(String::new(), |count| format!("{}, ", plural(count, "label")));
        let rate = self.bits_per_triangle.map_or(String::new(), |bits| {
            format!(", {bits:.3} bits per triangle for the topology")
        });
        let planes = self.planes.as_ref().map_or(String::new(), PlanesReport::in_words);
        format!(
            "{}: {what}{} vertices in {} bytes{rate}{planes}, {:.2} s",
            self.output,
            grouped(self.vertices),
            grouped(self.bytes),
            self.seconds
        )
    }
}

impl PlanesReport {
    fn in_words(&self) -> String {
        let Distances { edge, normal } = &self.distances;
        format!(
            "; {} in {} bytes, which leave {} voxels RMS to the {} along grid edges, {} along its normals (at most {})",
            plural(self.bits.into(), "bit plane"),
            grouped(self.bytes),
            number(edge.rms),
            self.from.surface(),
            number(normal.rms),
            number(normal.max),
        )
    }
}
