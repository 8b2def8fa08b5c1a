//! How far two surfaces lie from each other.
//!
//! The distance of a place on one surface is that to the nearest place on the other. Each triangle is cut
//! into pieces no longer than a step; in each piece the integral over the area is
//! A·(f₁ + f₂ + f₃ + 9·f₀)/12, from the values at its corners and its middle, which is exact for quadratic
//! functions. The largest distance is that of these places, so at least of all vertices.

use crate::error::Error;
use crate::measure::nearest::doubled_area;
use crate::measure::samples::{Samples, pieces, refuse_damage};
use crate::mesh::TriMesh;
use crate::parallel;
use crate::tree::Tree;
use crate::vector::{add, length, scale};

/// Triangles per block of parallel work.
const BLOCK: usize = 256;

/// Distances of the places on a surface from another one, over its area; in world units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Distances {
    /// The mean.
    pub mean: f64,
    /// Root of the mean square.
    pub root_mean_square: f64,
    /// No more than 5 % of the area lies farther away.
    pub percentile_95: f64,
    /// The largest one.
    pub maximum: f64,
}

/// Distances between two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SurfaceDistances {
    /// From the places on the first one.
    pub forth: Distances,
    /// From the places on the second one.
    pub back: Distances,
    /// Symmetric: mean and root mean square over both areas together, percentile and maximum the larger
    /// of the two, so that the maximum is the Hausdorff distance.
    pub symmetric: Distances,
}

/// The distances between two meshes, open or closed.
///
/// `step` is the largest length of the pieces that triangles are cut into, in world units.
///
/// ```
/// use shrouds::{Settings, measure::surface_distances, shroud, volume::phantom};
///
/// let mesh = shroud(&phantom::sphere(24)?, &Settings::default())?.mesh;
/// let mut moved = mesh.clone();
/// moved.vertices.iter_mut().for_each(|p| p[2] += 0.5);
/// let found = surface_distances(&mesh, &moved, 1.0)?;
/// assert!(found.symmetric.maximum < 0.5 + 1e-9);
/// // Half the cosine, over a sphere.
/// assert!((found.symmetric.mean - 0.25).abs() < 0.01);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when a mesh has no area, or a triangle names a vertex that does not exist or is not
/// finite; [`Error::Setting`] when the step is not positive.
pub fn surface_distances(
    one: &TriMesh,
    other: &TriMesh,
    step: f64,
) -> Result<SurfaceDistances, Error> {
    refuse_damage(one, step)?;
    refuse_damage(other, step)?;
    let [forth, back] = [(one, other), (other, one)].map(|(from, to)| one_way(from, to, step));
    let area = forth.area() + back.area();
    let mean = |f: fn(f64) -> f64| (forth.integral(f) + back.integral(f)) / area;
    let (there, here) = (Distances::of(&forth), Distances::of(&back));
    Ok(SurfaceDistances {
        forth: there,
        back: here,
        symmetric: Distances {
            mean: mean(|x| x),
            root_mean_square: mean(|x| x * x).sqrt(),
            percentile_95: there.percentile_95.max(here.percentile_95),
            maximum: there.maximum.max(here.maximum),
        },
    })
}

/// Distances of the pieces of a mesh, in order.
fn one_way(from: &TriMesh, to: &TriMesh, step: f64) -> Samples {
    let tree = Tree::new(to.triangles.iter().map(|&t| to.corners(t)).collect());
    let distance = |p| tree.nearest(p).map_or(0.0, |nearest| nearest.distance);
    // Triangles share their corners.
    let mut of_vertices = vec![0.0; from.vertices.len()];
    parallel::fill(&mut of_vertices, |v| distance(from.vertices[v]));
    let blocks = parallel::blocks(from.triangles.len(), BLOCK, |range| {
        let mut samples = Samples::default();
        for &triangle in &from.triangles[range] {
            let corners = from.corners(triangle);
            for piece in pieces(corners, step) {
                let [a, b, c] = piece;
                let area = 0.5 * length(doubled_area(piece));
                let middle = scale(add(add(a, b), c), 1.0 / 3.0);
                samples.push(distance(middle), 0.75 * area);
                for corner in piece {
                    let known = corners.iter().position(|p| *p == corner);
                    let value = known.map(|n| of_vertices[triangle[n] as usize]);
                    samples.push(value.unwrap_or_else(|| distance(corner)), area / 12.0);
                }
            }
        }
        samples
    });
    let mut all = Samples::default();
    blocks.into_iter().for_each(|samples| all.extend(samples));
    all.sort();
    all
}

impl Distances {
    fn of(samples: &Samples) -> Self {
        let area = samples.area();
        Self {
            mean: samples.integral(|x| x) / area,
            root_mean_square: (samples.integral(|x| x * x) / area).sqrt(),
            percentile_95: samples.quantile(0.95),
            maximum: samples.largest(),
        }
    }
}
