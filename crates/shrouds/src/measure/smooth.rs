//! Area and volume of the smooth surface through the vertices of a mesh.
//!
//! A mesh is inscribed: where its surface is convex the triangles lie inside, and area and volume come
//! out too small, those of a ball by about (edge/radius)²/6 and twice that. The vertex normals tell by how
//! much. Along an edge from x_i to x_j with unit normals n_i and n_j
//!
//! c = (n_j − n_i)·(x_j − x_i)
//!
//! is the squared length times the normal curvature, so the surface passes c/8 above the middle of the edge.
//! Each triangle becomes the quadratic one through its corners and the three middles m = (x_i + x_j)/2 +
//! (c/8)·(n_i + n_j)/|n_i + n_j|; neighbours share them, so a closed surface stays closed.
//!
//! - *Area*: that of the quadratic triangles, by three points each: exact up to the fourth power of the
//!   angle between normals.
//! - *Volume*: that of the mesh and, for each triangle of area A and unit normal N, (A/24)·Σ c·(N·m̂), m̂
//!   the direction of the middle's shift: the integral of the quadratic height 4·λ_i·λ_j·c/8.
//!
//! An edge is no arc where the surface has a crease. There c fades: it counts in full while the normals of
//! its ends differ by up to 30° and no more from 60° on. So a box with creases, or a voxel alone, keeps the
//! area and the volume of its triangles.

use crate::error::Error;
use crate::measure::integrals::{Integrals, integrals};
use crate::measure::stars::normals_of;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// Triangles that one block sums up.
const BLOCK: usize = 1 << 14;
/// Cosines of the angles between normals up to which an edge is an arc and from which it is a crease.
const ARC: f64 = 0.866_025_403_784_438_6;
const CREASE: f64 = 0.5;

/// The integrals of a mesh, with area and volume those of the smooth surface through its vertices.
///
/// The formula is at the head of `measure/smooth.rs`. On shrouds of smooth bodies, preset `exact`, this is the
/// estimate to publish: see `docs/measurements.md`. Centroid, covariance and bounds are those of the
/// triangles. Normals as for [`mesh_curvatures`](crate::measure::mesh_curvatures); where all are parallel
/// to their triangles' this is [`integrals`].
///
/// ```
/// use shrouds::{Settings, measure::smooth_integrals, optimize, shroud, volume::phantom};
///
/// let exact = optimize::Settings { preset: optimize::Preset::Exact, ..Default::default() };
/// let settings = Settings { optimize: exact, ..Default::default() };
/// let mesh = shroud(&phantom::sphere(32)?, &settings)?.mesh; // of radius 12.8
/// let area = 4.0 * std::f64::consts::PI * 12.8 * 12.8;
/// assert!((smooth_integrals(&mesh)?.area / area - 1.0).abs() < 1e-3);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// Those of [`mesh_curvatures`](crate::measure::mesh_curvatures).
pub fn smooth_integrals(mesh: &TriMesh) -> Result<Integrals, Error> {
    let normals = normals_of(mesh)?;
    let plain = integrals(mesh)?;
    let sums = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let facets = mesh.triangles[range].iter().map(|&t| Facet::of(mesh, &normals, t));
        facets.fold([0.0; 2], |[area, bulge], facet| [area + facet.area, bulge + facet.bulge])
    });
    let [area, bulge] = sums.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    Ok(Integrals { area, volume: plain.volume + bulge, ..plain })
}

/// A quadratic triangle.
pub(super) struct Facet {
    pub(super) area: f64,
    /// The volume between it and the flat one, positive outside.
    bulge: f64,
}

impl Facet {
    pub(super) fn of(mesh: &TriMesh, normals: &[[f32; 3]], triangle: [u32; 3]) -> Self {
        let corners = mesh.corners(triangle);
        let normals = triangle.map(|v| normals[v as usize].map(f64::from));
        // Edge n leads from corner n to the next one.
        let shifts = [0, 1, 2].map(|n| {
            let next = (n + 1) % 3;
            shift(subtract(corners[next], corners[n]), normals[n], normals[next])
        });
        let doubled = cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0]));
        let bulge = dot(doubled, shifts.into_iter().fold([0.0; 3], add)) / 6.0;
        Self { area: area(corners, shifts), bulge }
    }
}

/// How far the surface passes from the middle of an edge: c/8 along the mean normal.
fn shift(way: Vector, from: Vector, to: Vector) -> Vector {
    let arc = ((dot(from, to) - CREASE) / (ARC - CREASE)).clamp(0.0, 1.0);
    let middle = add(from, to);
    let size = length(middle);
    if arc == 0.0 || size == 0.0 {
        return [0.0; 3];
    }
    scale(middle, arc * dot(subtract(to, from), way) / (8.0 * size))
}

/// Area of the quadratic triangle with these corners, the middles of whose edges are shifted: the mean
/// over three points of the area that its two derivatives span.
fn area(corners: [Vector; 3], shifts: [Vector; 3]) -> f64 {
    let at = |heavy: usize| {
        let weight = |n: usize| if n == heavy { 2.0 / 3.0 } else { 1.0 / 6.0 };
        // The place is Σ λ_n·corner_n + Σ 4·λ_n·λ_(n+1)·shift_n.
        let slopes: [Vector; 3] = std::array::from_fn(|n| {
            let (next, last) = ((n + 1) % 3, (n + 2) % 3);
            let bent =
                add(scale(shifts[n], 4.0 * weight(next)), scale(shifts[last], 4.0 * weight(last)));
            add(corners[n], bent)
        });
        let [u, v] = [1, 2].map(|n| subtract(slopes[n], slopes[0]));
        0.5 * length(cross(u, v))
    };
    (at(0) + at(1) + at(2)) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle on the unit sphere around a corner of the cube, `size` its sides.
    fn on_sphere(size: f64) -> (TriMesh, Facet) {
        let unit = |p: Vector| scale(p, length(p).recip());
        let vertices = [[1.0, 1.0, 1.0 - size], [1.0 - size, 1.0, 1.0], [1.0, 1.0 - size, 1.0]];
        let vertices: Vec<Vector> = vertices.into_iter().map(unit).collect();
        let normals = vertices.iter().map(|p| p.map(|x| x as f32)).collect();
        let mesh = TriMesh { vertices, triangles: vec![[0, 1, 2]], normals };
        let facet = Facet::of(&mesh, &mesh.normals, [0, 1, 2]);
        (mesh, facet)
    }

    #[test]
    fn a_spherical_triangle_has_its_area_and_volume() {
        // The error falls with the fourth power of the size, that of the flat one with the second.
        for size in [0.4f64, 0.2, 0.1] {
            let (mesh, facet) = on_sphere(size);
            let [a, b, c] = mesh.corners([0, 1, 2]);
            // Van Oosterom and Strackee (1983).
            let solid_angle =
                2.0 * dot(a, cross(b, c)).atan2(1.0 + dot(a, b) + dot(b, c) + dot(c, a));
            let cone = dot(a, cross(b, c)) / 6.0 + facet.bulge;
            for found in [facet.area, 3.0 * cone] {
                let error = (found / solid_angle - 1.0).abs();
                assert!(error < 0.07 * size.powi(4), "{size}: {error}");
            }
            assert!((mesh.area() / solid_angle - 1.0).abs() > 0.14 * size.powi(2));
        }
    }

    #[test]
    fn creases_and_missing_normals_leave_the_triangle_flat() {
        let (mut mesh, _) = on_sphere(0.3);
        for normals in [
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[0.0; 3]; 3],
            [[0.0, 0.0, 1.0]; 3],
        ] {
            mesh.normals = normals.to_vec();
            let facet = Facet::of(&mesh, &mesh.normals, [0, 1, 2]);
            assert!((facet.area - mesh.area()).abs() < 1e-15 && facet.bulge == 0.0);
        }
    }
}
