//! After stage 6, check: in a triangle mesh and its volume, out a certificate.
//!
//! The check trusts nothing: it shares no code with the extraction of the surface, takes meshes from
//! any source, and decides every side with exact predicates. It certifies that the mesh is a closed,
//! oriented manifold without self-intersections, that every lattice point lies on its own side, and
//! that the mesh has the topology that the bits of the volume ask for.
//!
//! Uses: `grid`, `volume`, `mesh`.

pub(crate) mod crossing;
mod curve;
mod fans;
mod found;
mod grid_edges;
mod intersection;
mod measure;
mod near;
mod network;
mod predicates;
mod report;
mod separation;
mod structure;
mod union;
mod voxel_components;
mod voxel_rows;
mod voxel_topology;
mod windows;

pub use crossing::TOUCH;
pub use found::Found;
pub use near::{NearestPoint, nearest_point};
pub use network::{FourNetwork, four_network};
pub use report::CheckReport;
pub use separation::{Separation, WrongPoint};
pub use structure::{Component, Structure, structure};
pub use voxel_topology::{VoxelTopology, voxel_topology};

use crate::error::Error;
use crate::grid::Grid;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::volume::{Border, FaceRule, Occupancy};

/// What to expect of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CheckSettings {
    /// Whether the mesh closes or ends at the border of the volume. Default closed.
    pub border: Border,
    /// How it passes through ambiguous faces; decides the expected topology. Default separate.
    pub faces: FaceRule,
    /// Whether to follow the lines of the lattice along y and z too. On a closed mesh those along x
    /// say all; on one with holes the others see more. An open border always needs all three.
    /// Default false.
    pub all_axes: bool,
    /// Whether to look for self-intersections, the longest part of the check. Default true.
    pub self_intersections: bool,
}

impl Default for CheckSettings {
    fn default() -> Self {
        Self {
            border: Border::default(),
            faces: FaceRule::default(),
            all_axes: false,
            self_intersections: true,
        }
    }
}

/// Certifies a triangle mesh against the volume it is the surface of.
///
/// Time and memory follow the mesh, but for a look at each word of the volume. Signs are exact for
/// the coordinates as they are; separation is decided in units of the index, to which each vertex is
/// brought once. Work grows with the square of the number of triangles where they lie on top of each
/// other.
///
/// ```
/// use shrouds::{Grid, Occupancy, TriMesh, check::{CheckSettings, check}};
///
/// // One inside point and an octahedron around it.
/// let volume = Occupancy::from_fn(Grid::new([3; 3], [1.0; 3])?, |index| index == [1; 3]);
/// let [low, high] = [0.5, 1.5];
/// let mesh = TriMesh {
///     vertices: vec![
///         [low, 1.0, 1.0], [high, 1.0, 1.0], [1.0, low, 1.0],
///         [1.0, high, 1.0], [1.0, 1.0, low], [1.0, 1.0, high],
///     ],
///     triangles: vec![
///         [1, 3, 5], [3, 0, 5], [0, 2, 5], [2, 1, 5], [3, 1, 4], [0, 3, 4], [2, 0, 4], [1, 2, 4],
///     ],
///     normals: vec![],
/// };
/// let report = check(&mesh, &volume, &CheckSettings::default())?;
/// assert!(report.is_clean(), "{:?}", report.problems());
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when a triangle names a vertex that does not exist, a coordinate is not finite or
/// beyond 1e90, or there are more than 2³²/3 triangles; [`Error::NoCells`] when the border is open
/// and the volume has a single lattice point along an axis. Everything else is a finding.
pub fn check(
    mesh: &TriMesh,
    volume: &Occupancy,
    settings: &CheckSettings,
) -> Result<CheckReport, Error> {
    let dims = volume.grid().dims();
    let open = settings.border == Border::Open;
    if open && dims.contains(&1) {
        return Err(Error::NoCells { dims });
    }
    let (found, expected) = parallel::both(
        || examine(mesh, volume, settings),
        || voxel_topology(volume, settings.border, settings.faces),
    );
    let (structure, boundary, separation) = found?;
    Ok(CheckReport {
        settings: *settings,
        structure,
        stray_boundary_edges: stray_edges(mesh, &boundary, volume.grid(), settings.border),
        self_intersections: settings
            .self_intersections
            .then(|| intersection::self_intersections(mesh)),
        separation,
        expected,
    })
}

/// The mesh by itself, with its boundary edges, and against the lattice points.
fn examine(
    mesh: &TriMesh,
    volume: &Occupancy,
    settings: &CheckSettings,
) -> Result<(Structure, structure::Edges, Separation), Error> {
    let (structure, boundary, windows) = structure::examine(mesh)?;
    let open = settings.border == Border::Open;
    let axes = if open || settings.all_axes { 3 } else { 1 };
    let separated =
        axes == 1 && windows.is_some_and(|windows| grid_edges::separates(&windows, volume));
    let separation = match separated {
        true => Separation { axes, ..Separation::default() },
        false => separation::separation(mesh, volume, settings.border, axes)?,
    };
    Ok((structure, boundary, separation))
}

/// The boundary edges that do not lie in an outermost lattice plane of an open volume.
fn stray_edges(
    mesh: &TriMesh,
    boundary: &[[u32; 2]],
    grid: &Grid,
    border: Border,
) -> Found<[u32; 2]> {
    let inverse = grid.inverse_affine();
    let in_plane = |v: u32, axis: usize, plane: usize| {
        let (row, p) = (inverse[axis], mesh.vertices[v as usize]);
        let index = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
        (index - plane as f64).abs() <= crossing::TOUCH
    };
    let at_border = |edge: &[u32; 2]| {
        (0..3).any(|axis| {
            [0, grid.dims()[axis] - 1]
                .into_iter()
                .any(|plane| edge.iter().all(|&v| in_plane(v, axis, plane)))
        })
    };
    let mut stray = Found::default();
    boundary
        .iter()
        .filter(|edge| border == Border::Closed || !at_border(edge))
        .for_each(|&edge| stray.push(edge));
    stray
}
