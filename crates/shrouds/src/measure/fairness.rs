//! How fair a surface is, by its contours.
//!
//! The paper judges surfaces by looking at contours on them. In numbers, for any mesh: contours across
//! x, y and z, a step apart, each walked in steps of that length, and along them
//!
//! > Σ over axes p of h Σ over contours of Σ (|T⁺ − T⁻|² / l) s⁵,
//!
//! T± the unit directions before and after a point, l the mean of their lengths, h the distance of the
//! planes and s = √(1 − n_p²) how steeply the surface with normal n meets the plane. The sum over a
//! contour is its bending energy ∫κ² ds (Young, Walker and Bowie, An analysis technique for biological
//! shape, 1974). By Meusnier's theorem κ = κ_n / s, and a strip of height h is h/s wide, so that the whole
//! is the integral ∫ Σ_p κ_p² s_p⁴ dA over the surface, κ_p its normal curvature along the contour
//! across p. It is the same for a body of any size, 32π/5 for a sphere, and given in spheres.

use crate::error::Error;
use crate::measure::contours::{Chain, chains, refuse_damage};
use crate::measure::planes::Planes;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::vector::{Vector, cross, dot, length, scale, subtract};

/// The sum for a sphere of any radius.
const SPHERE: f64 = 32.0 * std::f64::consts::PI / 5.0;
/// Most planes across an axis.
const MOST: f64 = 4096.0;

/// How fair a surface is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fairness {
    /// Bending energy of the contours, that of a sphere being 1: the lower, the fairer. Surfaces of the
    /// same body can be compared, measured with the same step.
    pub bending: f64,
    /// Distance of the contours and of the points on them, in world units.
    pub step: f64,
}

/// How fair a mesh is, from contours and points along them a step apart, in world units; the voxel
/// spacing shows what voxels leave behind. Above a size of 4096 steps it is made larger.
///
/// ```
/// use shrouds::{Settings, measure::fairness, optimize::Start, shroud, volume::phantom};
///
/// let volume = phantom::sphere(32)?;
/// let mut settings = Settings::default();
/// let smooth = fairness(&shroud(&volume, &settings)?.mesh, 1.0)?.bending;
/// assert!((smooth - 1.0).abs() < 0.05);
/// settings.optimize.start = Start::Midpoint;
/// settings.optimize.max_iterations = Some(0);
/// assert!(fairness(&shroud(&volume, &settings)?.mesh, 1.0)?.bending > 2.0);
/// # Ok::<(), shrouds::Error>(())
/// ```
///
/// # Errors
/// [`Error::Setting`] when the step is not positive and finite, otherwise as for
/// [`contours`](crate::measure::contours()).
pub fn fairness(mesh: &TriMesh, step: f64) -> Result<Fairness, Error> {
    if !(step > 0.0 && step.is_finite()) {
        let value = step.to_string();
        return Err(Error::Setting { name: "step", value, range: "positive and finite" });
    }
    refuse_damage(mesh)?;
    let bounds = [0, 1, 2].map(|axis| {
        let range = |[low, high]: [f64; 2], p: &Vector| [low.min(p[axis]), high.max(p[axis])];
        mesh.vertices.iter().fold([f64::INFINITY, f64::NEG_INFINITY], range)
    });
    let size = bounds.iter().fold(0.0, |size: f64, [low, high]| size.max(high - low));
    let step = step.max(size / MOST);
    let mut bending = 0.0;
    for (axis, [low, high]) in bounds.into_iter().enumerate() {
        let count = ((high - low) / step).ceil();
        if count.is_nan() || count < 1.0 {
            continue;
        }
        let distance = (high - low) / count;
        let middle = |n: u32| low + (f64::from(n) + 0.5) * distance;
        let planes = Planes::across(axis, (0..count as u32).map(middle).collect());
        let chains = chains(mesh, &planes)?;
        let sum = |range: std::ops::Range<usize>| {
            chains[range].iter().map(|chain| bending_of(chain, mesh, axis, step)).sum::<f64>()
        };
        bending += distance * parallel::sum_blocks(chains.len(), sum);
    }
    Ok(Fairness { bending: bending / SPHERE, step })
}

/// Σ (|T⁺ − T⁻|² / l) s⁵ along points a step apart.
fn bending_of(chain: &Chain, mesh: &TriMesh, axis: usize, step: f64) -> f64 {
    let walk = Walk::new(chain, mesh, axis);
    let whole = walk.lengths[walk.lengths.len() - 1];
    let least = if chain.closed { 4.0 } else { 1.0 };
    let count = (whole / step).round().max(least);
    let stride = whole / count;
    if stride.is_nan() || stride <= 0.0 {
        return 0.0;
    }
    let count = count as usize;
    let (points, steepness): (Vec<Vector>, Vec<f64>) = (0..count + usize::from(!chain.closed))
        .map(|n| (walk.place(n as f64 * stride), walk.steepness(n as f64 * stride, stride)))
        .unzip();
    let turns = if chain.closed { 0..count } else { 1..count };
    turns
        .map(|n| {
            let before = subtract(points[n], points[(n + count - 1) % count]);
            let after = subtract(points[(n + 1) % points.len()], points[n]);
            let lengths = [before, after].map(length);
            if lengths.contains(&0.0) {
                return 0.0;
            }
            let turn =
                subtract(scale(after, lengths[1].recip()), scale(before, lengths[0].recip()));
            2.0 * dot(turn, turn) / (lengths[0] + lengths[1]) * steepness[n].powi(5)
        })
        .sum()
}

/// A chain by the length along it.
struct Walk<'a> {
    chain: &'a Chain,
    /// Up to each point, and all of it.
    lengths: Vec<f64>,
    /// ∫ s along it, up to the same points.
    steep: Vec<f64>,
}

impl<'a> Walk<'a> {
    fn new(chain: &'a Chain, mesh: &TriMesh, axis: usize) -> Self {
        let (mut lengths, mut steep) = (vec![0.0], vec![0.0]);
        let [mut so_far, mut weighted] = [0.0; 2];
        for (n, &triangle) in chain.triangles.iter().enumerate() {
            let next = chain.points[(n + 1) % chain.points.len()];
            let way = length(subtract(next, chain.points[n]));
            let [a, b, c] = mesh.corners(mesh.triangles[triangle as usize]);
            let normal = cross(subtract(b, a), subtract(c, a));
            let size = length(normal);
            let mut across = normal;
            across[axis] = 0.0;
            so_far += way;
            weighted += way * if size > 0.0 { length(across) / size } else { 0.0 };
            lengths.push(so_far);
            steep.push(weighted);
        }
        Self { chain, lengths, steep }
    }

    /// The segment at a length, and how far along it.
    fn segment(&self, at: f64) -> (usize, f64) {
        let last = self.chain.triangles.len() - 1;
        let n = self.lengths.partition_point(|&length| length <= at).saturating_sub(1).min(last);
        let way = self.lengths[n + 1] - self.lengths[n];
        (n, if way > 0.0 { ((at - self.lengths[n]) / way).clamp(0.0, 1.0) } else { 0.0 })
    }

    fn place(&self, at: f64) -> Vector {
        let (n, t) = self.segment(at);
        let points = &self.chain.points;
        let [from, to] = [points[n], points[(n + 1) % points.len()]];
        std::array::from_fn(|k| (1.0 - t) * from[k] + t * to[k])
    }

    /// The mean of s over so much length around a place.
    fn steepness(&self, at: f64, around: f64) -> f64 {
        let whole = self.lengths[self.lengths.len() - 1];
        let up_to = |at: f64| {
            // Once around and further, or before the beginning.
            let rounds = if self.chain.closed { (at / whole).floor() } else { 0.0 };
            let (n, t) = self.segment(at - rounds * whole);
            let here = (1.0 - t) * self.steep[n] + t * self.steep[n + 1];
            here + rounds * self.steep[self.steep.len() - 1]
        };
        let (low, high) = (at - 0.5 * around, at + 0.5 * around);
        let (low, high) =
            if self.chain.closed { (low, high) } else { (low.max(0.0), high.min(whole)) };
        ((up_to(high) - up_to(low)) / (high - low)).clamp(0.0, 1.0)
    }
}
