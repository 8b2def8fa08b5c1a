//! Meshes of several materials: the labels of a volume, and what is said of each of them and of their
//! contacts.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use shrouds::check::{CheckSettings, check};
use shrouds::materials::{Labels, MaterialMesh};
use shrouds::{Grid, Occupancy, TriMesh};

use crate::args::VolumeArgs;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;

/// A label with its closed boundary, in world units.
#[derive(Serialize)]
pub(crate) struct LabelReport {
    pub(crate) label: i64,
    pub(crate) name: String,
    pub(crate) voxels: u64,
    pub(crate) voxel_volume: f64,
    pub(crate) volume: f64,
    pub(crate) area: f64,
    pub(crate) triangles: usize,
    pub(crate) components: usize,
    #[serde(flatten)]
    pub(crate) checks: Checks,
}

/// Two labels that touch, in the order of their pair, and the area of their triangles.
#[derive(Serialize)]
pub(crate) struct Contact {
    pub(crate) labels: [i64; 2],
    pub(crate) triangles: usize,
    pub(crate) area: f64,
}

/// All should be 0. Of all labels together their sums.
#[derive(Serialize, Default, Clone, Copy)]
pub(crate) struct Checks {
    pub(crate) wrong_label: u64,
    pub(crate) boundary_edges: u64,
    pub(crate) non_manifold_edges: u64,
    pub(crate) non_manifold_vertices: u64,
    pub(crate) inconsistent_edges: u64,
    pub(crate) self_intersections: u64,
}

impl Checks {
    /// The sums over all labels.
    pub(crate) fn of_all(labels: &[LabelReport]) -> Self {
        let mut sums = Self::default();
        for LabelReport { checks, .. } in labels {
            sums.wrong_label += checks.wrong_label;
            sums.boundary_edges += checks.boundary_edges;
            sums.non_manifold_edges += checks.non_manifold_edges;
            sums.non_manifold_vertices += checks.non_manifold_vertices;
            sums.inconsistent_edges += checks.inconsistent_edges;
            sums.self_intersections += checks.self_intersections;
        }
        sums
    }

    /// What is wrong with the boundaries themselves.
    pub(crate) fn faults(&self) -> u64 {
        self.boundary_edges
            + self.non_manifold_edges
            + self.non_manifold_vertices
            + self.inconsistent_edges
            + self.self_intersections
    }
}

/// The labels of a volume file, with their places on this lattice.
pub(crate) fn labels(
    path: &Path,
    args: &VolumeArgs,
    lattice: &Grid,
    progress: &Progress,
) -> Result<Labels, Failure> {
    let volume = input::volume(path, args, args.layer(), progress)?;
    let problem = |text: String| Failure::Undone(format!("{}: {text}", path.display()));
    let values = volume.values.whole().ok_or_else(|| {
        problem("the values are no labels; --materials wants whole numbers".into())
    })?;
    let labels = Labels::new(lattice, &values).map_err(|error| problem(error.to_string()))?;
    match labels.values() {
        [_] => Err(problem("all values are 0; check that this is the segmentation".into())),
        _ => Ok(labels),
    }
}

/// The areas in which labels touch.
pub(crate) fn contacts(mesh: &MaterialMesh) -> Vec<Contact> {
    let contact = |(labels, (triangles, area))| Contact { labels, triangles, area };
    mesh.contacts().into_iter().map(contact).collect()
}

/// Checks the boundaries of all labels of a volume. One that has none in the mesh has an empty one.
pub(crate) fn label_reports(
    labels: &Labels,
    names: &BTreeMap<i128, String>,
    mesh: &MaterialMesh,
) -> Result<Vec<LabelReport>, Failure> {
    let occupancies = labels.occupancies()?;
    let meshes: BTreeMap<i64, TriMesh> = mesh.closed_meshes().collect();
    let none = TriMesh::default();
    let own = labels.values()[1..].iter().zip(&occupancies);
    own.map(|(&label, occupancy)| {
        let name = names.get(&label.into()).cloned().unwrap_or_default();
        label_report(label, name, meshes.get(&label).unwrap_or(&none), occupancy)
    })
    .collect()
}

fn label_report(
    label: i64,
    name: String,
    mesh: &TriMesh,
    occupancy: &Occupancy,
) -> Result<LabelReport, Failure> {
    let found = check(mesh, occupancy, &CheckSettings::default())?;
    let (structure, voxels) = (&found.structure, occupancy.count());
    let separation = &found.separation;
    let checks = Checks {
        wrong_label: separation.wrong_side.count + separation.odd_winding.count,
        boundary_edges: structure.boundary_edges.count,
        non_manifold_edges: structure.non_manifold_edges.count,
        non_manifold_vertices: structure.non_manifold_vertices.count,
        inconsistent_edges: structure.inconsistent_edges.count,
        self_intersections: found.self_intersections.as_ref().map_or(0, |pairs| pairs.count),
    };
    Ok(LabelReport {
        label,
        name,
        voxels,
        voxel_volume: voxels as f64 * occupancy.grid().voxel_volume(),
        volume: structure.volume,
        area: structure.area,
        triangles: mesh.triangles.len(),
        components: structure.components.len(),
        checks,
    })
}
