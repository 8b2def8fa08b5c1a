//! Integrals over a closed mesh and the body within: area, volume, centroid and second moments.
//!
//! The body is the sum of the tetrahedra between the triangles and one point, each with its sign. Of
//! a tetrahedron with volume V and corners 0, a, b, c the first moment is V·(a + b + c)/4 and the
//! matrix of second moments V·(aaᵀ + bbᵀ + ccᵀ + ssᵀ)/20, s = a + b + c.

use crate::error::Error;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// Triangles per block of parallel work.
const BLOCK: usize = 1 << 12;
/// Sweeps of rotations after which a symmetric matrix of three rows is diagonal to the last bit.
const SWEEPS: usize = 12;

/// Area of a mesh, and what its body weighs and where, at density 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Integrals {
    /// Sum of the areas of the triangles, in squared world units.
    pub area: f64,
    /// Enclosed volume in cubic world units; positive when the mesh faces outwards.
    pub volume: f64,
    /// Centre of mass of the body; the middle of the bounding box where there is no volume.
    pub centroid: [f64; 3],
    /// Mean of x·xᵀ over the body, x from the centroid: the covariance of its points, in squared world
    /// units; 0 where there is no volume.
    pub covariance: [[f64; 3]; 3],
    /// Smallest and largest coordinates of the vertices that triangles use.
    pub bounds: [[f64; 3]; 2],
}

/// The directions in which a body is longest, less long and shortest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalAxes {
    /// Unit vectors at right angles.
    pub directions: [[f64; 3]; 3],
    /// Lengths of the axes, both halves, of the ellipsoid with the same volume's covariance, the
    /// longest first; world units.
    pub lengths: [f64; 3],
}

/// The integrals over a mesh.
///
/// Volume, centroid and covariance mean something for closed meshes only, and for these do not depend
/// on the origin.
///
/// ```
/// use shrouds::{Settings, measure::integrals, shroud, volume::phantom};
///
/// let mesh = shroud(&phantom::sphere(32)?, &Settings::default())?.mesh; // of radius 12.8
/// let found = integrals(&mesh)?;
/// assert!((found.sphericity() - 1.0).abs() < 0.01);
/// assert!(found.principal_axes().lengths.iter().all(|axis| (axis / 25.6 - 1.0).abs() < 0.01));
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] when a triangle names a vertex that does not exist or one that is not finite.
pub fn integrals(mesh: &TriMesh) -> Result<Integrals, Error> {
    let Some(bounds) = bounds(mesh)? else { return Ok(Integrals::default()) };
    let origin = scale(add(bounds[0], bounds[1]), 0.5);
    let sums = parallel::blocks(mesh.triangles.len(), BLOCK, |range| {
        let mut sums = Sums::default();
        for &triangle in &mesh.triangles[range] {
            sums.add_triangle(mesh.corners(triangle).map(|p| subtract(p, origin)));
        }
        sums
    });
    let mut all = Sums::default();
    sums.iter().for_each(|sums| all.add(sums));
    Ok(all.finish(origin, bounds))
}

/// The box around the vertices that triangles use; an error where one is missing or not finite.
pub(super) fn bounds(mesh: &TriMesh) -> Result<Option<[Vector; 2]>, Error> {
    let mut bounds: Option<[Vector; 2]> = None;
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &v in triangle {
            let damaged =
                |what: &str| Error::Mesh(format!("triangle {t} names vertex {v}, {what}"));
            let place =
                *mesh.vertices.get(v as usize).ok_or_else(|| damaged("which is not there"))?;
            if !place.iter().all(|x| x.is_finite()) {
                return Err(damaged("a coordinate of which is not finite"));
            }
            let [low, high] = bounds.unwrap_or([place; 2]);
            bounds = Some([
                std::array::from_fn(|k| low[k].min(place[k])),
                std::array::from_fn(|k| high[k].max(place[k])),
            ]);
        }
    }
    Ok(bounds)
}

/// Integrals about an origin, not divided yet.
#[derive(Default)]
struct Sums {
    area: f64,
    /// Six times the volume.
    volume: f64,
    /// 24 times the first moment.
    first: Vector,
    /// 120 times the second moments.
    second: [Vector; 3],
}

impl Sums {
    fn add_triangle(&mut self, [a, b, c]: [Vector; 3]) {
        self.area += 0.5 * length(cross(subtract(b, a), subtract(c, a)));
        let volume = dot(a, cross(b, c));
        let sum = add(add(a, b), c);
        self.volume += volume;
        self.first = add(self.first, scale(sum, volume));
        for (r, row) in self.second.iter_mut().enumerate() {
            let products: Vector =
                std::array::from_fn(|k| a[r] * a[k] + b[r] * b[k] + c[r] * c[k] + sum[r] * sum[k]);
            *row = add(*row, scale(products, volume));
        }
    }

    fn add(&mut self, other: &Self) {
        self.area += other.area;
        self.volume += other.volume;
        self.first = add(self.first, other.first);
        self.second = std::array::from_fn(|r| add(self.second[r], other.second[r]));
    }

    fn finish(&self, origin: Vector, bounds: [Vector; 2]) -> Integrals {
        let volume = self.volume / 6.0;
        let shift = scale(self.first, 1.0 / (24.0 * volume));
        let covariance: [Vector; 3] = std::array::from_fn(|r| {
            std::array::from_fn(|k| self.second[r][k] / (120.0 * volume) - shift[r] * shift[k])
        });
        let is_body = shift.iter().chain(covariance.as_flattened()).all(|x| x.is_finite());
        Integrals {
            area: self.area,
            volume,
            centroid: if is_body { add(origin, shift) } else { origin },
            covariance: if is_body { covariance } else { [[0.0; 3]; 3] },
            bounds,
        }
    }
}

impl Integrals {
    /// Area over volume, 1/length; not finite where there is no volume.
    pub fn surface_to_volume(&self) -> f64 {
        self.area / self.volume
    }

    /// The area of the ball of the same volume over the area: 1 for a ball, less for all else (Wadell
    /// 1935). Not a number where there is no area.
    pub fn sphericity(&self) -> f64 {
        let volume = self.volume.abs();
        std::f64::consts::PI.cbrt() * (6.0 * volume).powi(2).cbrt() / self.area
    }

    /// The axes of the solid ellipsoid that has the covariance of the body.
    pub fn principal_axes(&self) -> PrincipalAxes {
        let (values, directions) = eigen(self.covariance);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        PrincipalAxes {
            directions: order.map(|n| directions[n]),
            // The mean of x² over an ellipsoid is the square of its half axis over 5.
            lengths: order.map(|n| 2.0 * (5.0 * values[n].max(0.0)).sqrt()),
        }
    }
}

/// Eigenvalues of a symmetric matrix and their unit vectors, by Jacobi's rotations.
fn eigen(mut matrix: [Vector; 3]) -> (Vector, [Vector; 3]) {
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * SWEEPS) {
        if matrix[p][q] == 0.0 {
            continue;
        }
        let ratio = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
        let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
        let cosine = tangent.hypot(1.0).recip();
        let sine = tangent * cosine;
        let turn = |rows: &mut [Vector; 3]| {
            let (a, b) = (rows[p], rows[q]);
            rows[p] = subtract(scale(a, cosine), scale(b, sine));
            rows[q] = add(scale(a, sine), scale(b, cosine));
        };
        turn(&mut matrix);
        matrix = transposed(matrix);
        turn(&mut matrix);
        turn(&mut vectors);
    }
    ([0, 1, 2].map(|n| matrix[n][n]), vectors)
}

fn transposed(m: [Vector; 3]) -> [Vector; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}
