//! What a mesh file holds.

use std::path::Path;

use serde::Serialize;
use shrouds::TriMesh;
use shrouds::check::structure;

use super::{table, vector};
use crate::console::{grouped, number};
use crate::failure::Failure;
use crate::report::name;
use shrouds_report::looks::bounds;

#[derive(Serialize)]
pub(super) struct MeshInfo {
    kind: &'static str,
    file: String,
    vertices: usize,
    triangles: usize,
    /// Whether every vertex has a normal.
    normals: bool,
    /// Smallest and largest corner; null without vertices.
    bounds: Option<[[f64; 3]; 2]>,
    /// Whether every edge has two triangles that run through it in opposite directions.
    closed: bool,
    components: usize,
    /// Euler characteristic of each component.
    euler: Vec<i64>,
    /// Null unless closed.
    volume: Option<f64>,
    area: f64,
}

impl MeshInfo {
    pub(super) fn new(path: &Path, mesh: &TriMesh) -> Result<Self, Failure> {
        let structure = structure(mesh)
            .map_err(|error| Failure::Undone(format!("{}: {error}", path.display())))?;
        Ok(Self {
            kind: "mesh",
            file: name(path),
            vertices: mesh.vertices.len(),
            triangles: mesh.triangles.len(),
            normals: !mesh.normals.is_empty(),
            bounds: bounds(mesh.vertices.iter().copied()),
            closed: structure.is_closed(),
            components: structure.components.len(),
            euler: structure.components.iter().map(|component| component.euler).collect(),
            volume: structure.is_closed().then_some(structure.volume),
            area: structure.area,
        })
    }

    pub(super) fn in_words(&self) -> String {
        let bounds = match self.bounds {
            Some([low, high]) => format!("{} to {}", vector(low), vector(high)),
            None => "none".into(),
        };
        let normals = if self.normals { "with normals" } else { "without normals" };
        let euler: i64 = self.euler.iter().sum();
        let volume = self.volume.map_or("unknown: it is not closed".into(), number);
        table(&[
            ("mesh", self.file.clone()),
            ("vertices", format!("{}, {normals}", grouped(self.vertices as u64))),
            ("triangles", grouped(self.triangles as u64)),
            ("bounds", bounds),
            ("closed", if self.closed { "yes" } else { "no" }.into()),
            ("parts", format!("{}, Euler characteristic {euler}", self.components)),
            ("volume", volume),
            ("area", number(self.area)),
        ])
    }
}
