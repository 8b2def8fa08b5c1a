//! Everything that is measured of one body, in columns.
//!
//! What each column means is in `docs/measurements.md`.

mod columns;
mod parts;

use serde::Serialize;
use shrouds::check::{Structure, structure};
use shrouds::measure::{
    Curvature, Integrals, SignAreas, SurfaceDistances, curvature_areas, curvatures, flat_threshold,
    integrals, mesh_curvatures, smooth_integrals, surface_distances, thickness, uncertainty,
};
use shrouds::mesh::MeshKind;
use shrouds::network::Network;
use shrouds::surface::Surface;
use shrouds::{Error, TriMesh};

pub use columns::{Dimension, Entries, Entry, Units, Value};
pub use parts::parts;

use crate::looks::{bounds, mean_edge};
use crate::vector::{Vector, cross, length, sub};
use Dimension::{Area, Length, None as Plain, PerArea, PerLength, Volume};

/// Pieces that triangles are cut into, for distances and thickness, are no longer than this many of the
/// smallest spacings, or of the mean edges of a mesh.
const PIECE: f64 = 2.0;
/// But there are no fewer than this many along the diagonal of a mesh.
const PIECES: f64 = 50.0;

/// A surface to be measured, in world coordinates.
pub struct Body<'a> {
    /// Its triangles.
    pub mesh: &'a TriMesh,
    /// The crossings that it comes from, unless it is any mesh.
    pub surface: Option<&'a Surface>,
    /// Which mesh of the surface it is.
    pub kind: MeshKind,
    /// How many voxels it separates.
    pub voxels: Option<u64>,
}

/// All columns of a body, and what is to be said about it.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// The columns.
    #[serde(flatten)]
    pub entries: Entries,
    /// What is to be said, a sentence each.
    pub notes: Vec<String>,
}

impl Body<'_> {
    /// Measures everything; `other` is a surface to which the distance is wanted.
    ///
    /// # Errors
    /// [`Error::Mesh`] when a triangle names a vertex that does not exist or a coordinate is not finite.
    pub fn measure(&self, other: Option<&TriMesh>) -> Result<Measured, Error> {
        let structure = structure(self.mesh)?;
        let (plain, smooth) = (integrals(self.mesh)?, smooth_integrals(self.mesh)?);
        let mut entries = Entries::default();
        let closed = structure.is_closed();
        self.size(&mut entries, closed, &smooth, &plain);
        shape(&mut entries, closed, &smooth);
        let cavities = topology(&mut entries, self.mesh, &structure);
        self.curvature(&mut entries)?;
        let mut notes = notes(&structure, &plain, cavities);
        self.thickness(&mut entries, &mut notes)?;
        if let Some(other) = other {
            let found = surface_distances(self.mesh, other, self.step())?;
            distance(&mut entries, &found);
        }
        Ok(Measured { entries, notes })
    }

    fn size(&self, entries: &mut Entries, closed: bool, smooth: &Integrals, plain: &Integrals) {
        let span = self.surface.map(|surface| uncertainty(surface, smooth));
        let lattice = self.surface.map(Surface::grid);
        let voxels = self.voxels.zip(lattice);
        entries.count("voxels", self.voxels.and_then(|n| n.try_into().ok()));
        entries.number(
            "voxel_volume",
            Volume,
            voxels.map(|(n, grid)| n as f64 * grid.voxel_volume()),
        );
        let [volume, area] = [span.map(|span| span.volume), span.map(|span| span.area)];
        entries.number("volume", Volume, closed.then_some(smooth.volume));
        entries.number("volume_error", Volume, volume.map(|span| span.error));
        entries.number("volume_low", Volume, volume.map(|span| span.low));
        entries.number("volume_high", Volume, volume.map(|span| span.high));
        entries.number("area", Area, smooth.area);
        entries.number("area_error", Area, area.map(|span| span.error));
        entries.number("area_low", Area, area.map(|span| span.low));
        entries.number("area_high", Area, area.map(|span| span.high));
        entries.number("triangle_volume", Volume, closed.then_some(plain.volume));
        entries.number("triangle_area", Area, plain.area);
    }

    fn curvature(&self, entries: &mut Entries) -> Result<(), Error> {
        let mesh = self.mesh;
        let found = match self.surface {
            // The curves of the network tell more than normals alone.
            Some(surface) if self.kind == MeshKind::Primal => {
                curvatures(&Network::trace(surface), &mesh.vertices, &mesh.normals)
            }
            _ => mesh_curvatures(mesh)?,
        };
        let spacing = self.spacing();
        let threshold = flat_threshold(spacing);
        let areas = curvature_areas(mesh, &found, threshold)?;
        let SignAreas { positive, negative, near_zero } = areas.gaussian;
        entries.number("gaussian_positive_area", Area, positive);
        entries.number("gaussian_negative_area", Area, negative);
        entries.number("gaussian_near_zero_area", Area, near_zero);
        let SignAreas { positive, negative, near_zero } = areas.mean;
        entries.number("convex_area", Area, positive);
        entries.number("concave_area", Area, negative);
        entries.number("mean_near_zero_area", Area, near_zero);
        entries.number("near_zero_curvature", PerLength, threshold);
        let shares = shares(mesh);
        let median = |of: fn(Curvature) -> f64| {
            weighted_median(found.iter().map(|c| of(*c)).zip(shares.iter().copied()).collect())
        };
        entries.number("mean_curvature_median", PerLength, median(Curvature::mean));
        entries.number("gaussian_curvature_median", PerArea, median(Curvature::gaussian));
        Ok(())
    }

    fn thickness(&self, entries: &mut Entries, notes: &mut Vec<String>) -> Result<(), Error> {
        let found = thickness(self.mesh, self.step())?;
        let is_known = found.share > 0.0;
        entries.number("thickness_mean", Length, is_known.then_some(found.mean));
        entries.number("thickness_median", Length, is_known.then_some(found.median));
        entries.number("thickness_maximum", Length, is_known.then_some(found.maximum));
        if found.share < 1.0 - 1e-6 {
            notes.push(format!("thickness is that of {:.1} % of the area", 100.0 * found.share));
        }
        Ok(())
    }

    /// Of the lattice, or the mean edge of a mesh file, which stands for one.
    fn spacing(&self) -> Vector {
        match self.surface {
            Some(surface) => surface.grid().spacing(),
            None => [mean_edge(self.mesh).unwrap_or(1.0); 3],
        }
    }

    fn step(&self) -> f64 {
        if let Some(surface) = self.surface {
            return PIECE * surface.grid().min_spacing();
        }
        let diagonal = bounds(self.mesh.vertices.iter().copied())
            .map_or(0.0, |[low, high]| length(sub(high, low)));
        let edges = mean_edge(self.mesh).map_or(f64::INFINITY, |edge| PIECE * edge);
        let step = edges.min(diagonal / PIECES);
        if step > 0.0 { step } else { 1.0 }
    }
}

/// Where a body lies and what its shape is.
fn shape(entries: &mut Entries, closed: bool, of: &Integrals) {
    let axes = of.principal_axes();
    entries.vector("centroid", Length, closed.then_some(of.centroid));
    entries.vector("axis_lengths", Length, closed.then_some(axes.lengths));
    let directions = right_handed(axes.directions);
    for (key, direction) in ["axis_1", "axis_2", "axis_3"].into_iter().zip(directions) {
        entries.vector(key, Plain, closed.then_some(direction));
    }
    entries.vector("box_low", Length, of.bounds[0]);
    entries.vector("box_high", Length, of.bounds[1]);
    entries.number("surface_to_volume", PerLength, closed.then(|| of.surface_to_volume()));
    entries.number("sphericity", Plain, closed.then(|| of.sphericity()));
}

/// The same axes: the first two point to where their largest coordinate is positive, the third makes
/// them a right-handed system.
fn right_handed([first, second, _]: [Vector; 3]) -> [Vector; 3] {
    let positive = |v: Vector| {
        let largest = v.into_iter().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if largest < 0.0 { v.map(|x| -x) } else { v }
    };
    let [first, second] = [first, second].map(positive);
    [first, second, cross(first, second)]
}

/// Counts of the surface; returns how many cavities there are, if it is closed.
fn topology(entries: &mut Entries, mesh: &TriMesh, structure: &Structure) -> Option<usize> {
    let closed = structure.is_closed();
    let surfaces = structure.components.len() as i64;
    let cavities = closed.then(|| parts(mesh).iter().filter(|part| part.volume() < 0.0).count());
    entries.count("surfaces", surfaces);
    entries.count("cavities", cavities.map(|n| n as i64));
    entries.count("euler", structure.euler());
    entries.count("genus", closed.then(|| surfaces - structure.euler() / 2));
    cavities
}

fn notes(structure: &Structure, plain: &Integrals, cavities: Option<usize>) -> Vec<String> {
    let mut notes = Vec::new();
    if !structure.is_closed() {
        let edges = structure.boundary_edges.count
            + structure.non_manifold_edges.count
            + structure.inconsistent_edges.count;
        notes.push(format!(
            "the mesh is not closed ({edges} edges without two triangles that face the same side): it has no volume"
        ));
    } else if plain.volume < 0.0 && cavities == Some(structure.components.len()) {
        notes.push(
            "the mesh faces inwards: its volume is negative, and convex means concave".into(),
        );
    }
    notes
}

fn distance(entries: &mut Entries, found: &SurfaceDistances) {
    let all = [
        (["distance_mean", "distance_rms", "distance_95", "distance_maximum"], found.symmetric),
        (
            [
                "distance_forth_mean",
                "distance_forth_rms",
                "distance_forth_95",
                "distance_forth_maximum",
            ],
            found.forth,
        ),
        (
            [
                "distance_back_mean",
                "distance_back_rms",
                "distance_back_95",
                "distance_back_maximum",
            ],
            found.back,
        ),
    ];
    for (keys, of) in all {
        let values = [of.mean, of.root_mean_square, of.percentile_95, of.maximum];
        for (key, value) in keys.into_iter().zip(values) {
            entries.number(key, Length, value);
        }
    }
}

/// A third of the area of every triangle for each of its corners.
///
/// # Panics
/// When a triangle names a vertex that does not exist.
pub fn shares(mesh: &TriMesh) -> Vec<f64> {
    let mut shares = vec![0.0; mesh.vertices.len()];
    for &triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle);
        let third = length(cross(sub(b, a), sub(c, a))) / 6.0;
        triangle.iter().for_each(|&v| shares[v as usize] += third);
    }
    shares
}

/// The value that half of the weight does not exceed.
fn weighted_median(mut values: Vec<(f64, f64)>) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    let reached = |(_, weight): &&(f64, f64)| {
        sum += weight;
        sum >= half
    };
    values.iter().find(reached).map(|(value, _)| *value)
}
