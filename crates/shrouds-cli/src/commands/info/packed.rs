//! What a packed file holds.

use std::path::Path;

use serde::Serialize;
use shrouds::volume::{Border, FaceRule};
use shrouds_codec::{Content, Kind, Profile, survey};

use super::{lattice_in_words, table};
use crate::args;
use crate::console::grouped;
use crate::failure::Failure;
use crate::packed;
use crate::report::{Lattice, name};
use crate::selection::list;

#[derive(Serialize)]
pub(super) struct PackedInfo {
    kind: &'static str,
    file: String,
    #[serde(flatten)]
    lattice: Lattice,
    /// Null for a volume.
    labels: Option<Vec<i64>>,
    profile: args::Profile,
    #[serde(with = "crate::by_name")]
    faces: FaceRule,
    #[serde(with = "crate::by_name")]
    border: Border,
    /// Layers in a slab, and whether each is coded by itself.
    slab: usize,
    independent: bool,
    /// Bit planes of the places of the vertices.
    planes: u8,
    /// Bytes of topology or labels, and of planes.
    topology_bytes: u64,
    plane_bytes: u64,
    chunks: usize,
}

impl PackedInfo {
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let (header, chunks) = packed::open(path, survey)?;
        let bytes = |plane: bool| -> u64 {
            let parts = chunks.iter().filter(|part| (part.kind == Kind::Plane) == plane);
            parts.map(|part| part.bytes).sum()
        };
        Ok(Self {
            kind: "packed",
            file: name(path),
            lattice: packed::lattice(&header),
            profile: match header.profile {
                Profile::Fast => args::Profile::Fast,
                Profile::Dense => args::Profile::Dense,
            },
            faces: header.faces,
            border: header.border,
            slab: header.slab_height,
            independent: header.independent,
            planes: header.planes,
            topology_bytes: bytes(false),
            plane_bytes: bytes(true),
            chunks: chunks.len(),
            labels: match header.content {
                Content::Labels(labels) => Some(labels),
                Content::Volume => None,
            },
        })
    }

    pub(super) fn in_words(&self) -> String {
        let labels = match &self.labels {
            Some(labels) => list(labels.iter().map(i64::to_string)),
            None => "none: a binary volume".into(),
        };
        let kind =
            if self.independent { "each coded by itself" } else { "each after the one before" };
        let slabs = format!("{} layers, {kind}", self.slab);
        let mut rows = vec![("packed", self.file.clone())];
        rows.extend(lattice_in_words(&self.lattice));
        rows.extend([
            ("frame", self.lattice.frame.clone()),
            ("labels", labels),
            ("profile", format!("{:?}", self.profile).to_lowercase()),
            ("slabs", slabs),
            ("topology", format!("{} bytes", grouped(self.topology_bytes))),
            ("planes", format!("{}, {} bytes", self.planes, grouped(self.plane_bytes))),
        ]);
        table(&rows)
    }
}
