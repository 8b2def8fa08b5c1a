//! What is said about the interfaces of several materials: every label and every contact, and whether all holds.

use std::collections::BTreeMap;

use serde::Serialize;
use shrouds::check::{CheckSettings, check};
use shrouds::materials::{LabelVolume, Labels, MaterialMesh, Shrouds};
use shrouds::{Error, Occupancy, TriMesh};

/// Everything about the interfaces of a volume but where the volume came from.
#[derive(Debug, Clone, Serialize)]
pub struct Materials {
    /// Sizes of the mesh.
    pub topology: MaterialTopology,
    /// How the optimisation went.
    pub solver: MaterialSolver,
    /// All labels but the background.
    pub labels: Vec<LabelReport>,
    /// All pairs of labels that touch.
    pub contacts: Vec<Contact>,
    /// Sums over all labels.
    pub checks: LabelChecks,
}

/// Sizes of a mesh of interfaces.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct MaterialTopology {
    /// Of all kinds.
    pub vertices: usize,
    /// Vertices on grid edges.
    pub crossings: usize,
    /// Vertices in lattice faces.
    pub junction_points: usize,
    /// Vertices within cells.
    pub cell_points: usize,
    /// Each once, whichever its labels.
    pub triangles: usize,
    /// Edges where three or more labels meet.
    pub junction_lines: usize,
}

/// How an optimisation went.
#[derive(Debug, Clone, Serialize)]
pub struct MaterialSolver {
    /// How it ended.
    pub status: &'static str,
    /// Steps made.
    pub iterations: usize,
    /// At the start of every pass and after each step.
    pub energies: Vec<Vec<f64>>,
    /// How well volumes were kept, if they were to be.
    pub kept_volumes: Option<KeptVolumes>,
}

/// How near labels came to the volumes of their voxels.
#[derive(Debug, Clone, Serialize)]
pub struct KeptVolumes {
    /// How many labels were to.
    pub labels: usize,
    /// The largest difference of those that the bounds do not keep from it, as a part of the volume.
    pub relative_error: f64,
    /// Those that they do.
    pub held: Vec<i64>,
}

impl KeptVolumes {
    fn new(volumes: &[LabelVolume]) -> Option<Self> {
        let held = volumes.iter().filter(|volume| volume.is_held).map(|volume| volume.label);
        let others = volumes.iter().filter(|volume| !volume.is_held);
        let error = others.map(|volume| (volume.reached / volume.target - 1.0).abs());
        (!volumes.is_empty()).then(|| Self {
            labels: volumes.len(),
            relative_error: error.fold(0.0, f64::max),
            held: held.collect(),
        })
    }

    /// The same in words.
    pub fn summary(&self) -> String {
        let Self { labels, relative_error, held } = self;
        match held.len() {
            0 => format!("volumes of {labels} labels kept to {relative_error:.0e}"),
            held => format!(
                "volumes of {labels} labels kept to {relative_error:.0e}, but for {held} held by the bounds"
            ),
        }
    }
}

/// A label with its closed boundary, in world units.
#[derive(Debug, Clone, Serialize)]
pub struct LabelReport {
    /// The label.
    pub label: i64,
    /// Its name, where it has one.
    pub name: String,
    /// Its voxels.
    pub voxels: u64,
    /// Their volume.
    pub voxel_volume: f64,
    /// Enclosed by its boundary.
    pub volume: f64,
    /// Of its boundary.
    pub area: f64,
    /// Of its boundary.
    pub triangles: usize,
    /// Parts of its boundary.
    pub components: usize,
    /// What is wrong with its boundary.
    #[serde(flatten)]
    pub checks: LabelChecks,
}

/// Two labels that touch, in the order of their pair.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Contact {
    /// The background second, else ascending.
    pub labels: [i64; 2],
    /// Between both.
    pub triangles: usize,
    /// Of these, in squared world units.
    pub area: f64,
}

/// Counts that should all be 0.
#[derive(Debug, Serialize, Default, Clone, Copy)]
pub struct LabelChecks {
    /// Lattice points outside their label's boundary or inside that of another.
    pub wrong_label: u64,
    /// Edges of one triangle.
    pub boundary_edges: u64,
    /// Edges of more than two triangles of a label.
    pub non_manifold_edges: u64,
    /// Vertices where a label's boundary touches itself.
    pub non_manifold_vertices: u64,
    /// Edges passed twice in the same direction.
    pub inconsistent_edges: u64,
    /// Pairs of triangles that cross each other.
    pub self_intersections: u64,
}

impl LabelChecks {
    /// What is wrong with boundaries, all kinds together.
    pub fn faults(&self) -> u64 {
        self.boundary_edges
            + self.non_manifold_edges
            + self.non_manifold_vertices
            + self.inconsistent_edges
            + self.self_intersections
    }

    /// The sums over some labels.
    pub fn of_all(labels: &[LabelReport]) -> Self {
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
}

impl Materials {
    /// Checks the boundary of every label. `names` are those of labels, where they have some.
    ///
    /// # Errors
    /// None for interfaces that were made of these labels.
    pub fn new(
        labels: &Labels,
        made: &Shrouds,
        names: &BTreeMap<i128, String>,
    ) -> Result<Self, Error> {
        let mesh = &made.mesh;
        let vertices = mesh.surface.vertices.len();
        let labels = label_reports(labels, names, mesh)?;
        let checks = LabelChecks::of_all(&labels);
        Ok(Self {
            topology: MaterialTopology {
                vertices,
                crossings: made.crossings,
                junction_points: made.junctions,
                cell_points: vertices - made.crossings - made.junctions,
                triangles: mesh.surface.triangles.len(),
                junction_lines: mesh.lines.len(),
            },
            solver: MaterialSolver {
                status: made.report.status.name(),
                iterations: made.report.steps(),
                energies: made.report.passes.clone(),
                kept_volumes: KeptVolumes::new(&made.report.volumes),
            },
            labels,
            contacts: contacts(mesh),
            checks,
        })
    }
}

/// The areas in which labels touch.
pub fn contacts(mesh: &MaterialMesh) -> Vec<Contact> {
    let contact = |(labels, (triangles, area))| Contact { labels, triangles, area };
    mesh.contacts().into_iter().map(contact).collect()
}

/// Checks the boundaries of all labels of a volume. One that has none in the mesh has an empty one.
///
/// # Errors
/// None for labels on a lattice with cells.
pub fn label_reports(
    labels: &Labels,
    names: &BTreeMap<i128, String>,
    mesh: &MaterialMesh,
) -> Result<Vec<LabelReport>, Error> {
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
) -> Result<LabelReport, Error> {
    let found = check(mesh, occupancy, &CheckSettings::default())?;
    let (structure, voxels) = (&found.structure, occupancy.count());
    let separation = &found.separation;
    let checks = LabelChecks {
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
