//! Creases: edges that stay sharp between faces that become flat.
//!
//! Every convex curve turns by 2π in all, so that an energy convex in the turning angle cannot tell a
//! corner from an arc. One that levels off can. Here the squares of the energy are weighted by
//! `1/(1 + (θ/σ)²)²`, θ being the turning angle when the weights are frozen, which makes the sum one of
//! Geman and McClure: a vertex that turns by much more than σ counts next to nothing.

use crate::parallel;
use crate::surface::Surface;
use crate::volume::Occupancy;

/// The Meusnier exponent of measures that have one. A smaller one than theirs lets the slices that
/// are nearly tangent to a face, on which its vertices crowd, count more.
pub(super) const MEUSNIER_EXPONENT: f64 = 2.0;

/// The strengths of the barrier that all vertices share. A strong one keeps curves sharp until they
/// have chosen their corners, a weak one lets the faces between them become flat.
pub(super) const BARRIERS: [f64; 6] = [0.01, 0.005, 0.0025, 0.00125, 0.0006, 0.0003];

/// How creases are let be.
#[derive(Clone, Copy)]
pub(crate) struct Creases<'a> {
    /// The turning angle σ, infinite while all vertices count.
    pub(super) angle: f64,
    /// Strength of the barrier that all vertices share.
    pub(super) barrier: f64,
    /// See [`thinness`].
    pub(super) thinness: &'a [f32],
}

impl Creases<'_> {
    /// The weight of a place where a curve turns by an angle with this cosine.
    pub(super) fn weight(&self, cosine: f32) -> f32 {
        let turns = cosine.clamp(-1.0, 1.0).acos() / self.angle as f32;
        let root = 1.0 + turns * turns;
        1.0 / (root * root)
    }
}

/// 1 at the vertices on curves around a single lattice point, inside or outside, and 0 elsewhere.
///
/// They lie on parts one voxel thin. Nothing would keep such a part from shrinking if only corners
/// were left of it, so there all vertices count.
pub(super) fn thinness(surface: &Surface) -> Vec<f32> {
    let mut thinness = vec![0.0; surface.vertex_count()];
    let ends = (0..surface.slice_count()).map(|k| surface.slice_vertices(k).end as usize);
    parallel::pieces(&mut thinness, ends, |k, thinness| {
        for (thinness, crossing) in thinness.iter_mut().zip(surface.slice_crossings(k)) {
            let ends = [crossing.inside(), crossing.outside()];
            let planes = [1, 2].map(|shift| [crossing.axis(), (crossing.axis() + shift) % 3]);
            let is_thin = planes
                .into_iter()
                .any(|plane| ends.into_iter().any(|end| is_alone(surface.volume(), end, plane)));
            *thinness = f32::from(is_thin);
        }
    });
    thinness
}

/// Whether the eight lattice points around one in the plane of two axes all lie on the other side.
/// What lies beyond the border goes on there.
fn is_alone(volume: &Occupancy, point: [usize; 3], [u, v]: [usize; 2]) -> bool {
    let (dims, is_inside) = (volume.grid().dims(), volume.get(point));
    let steps = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [a, b]));
    steps.filter(|&step| step != [0, 0]).all(|[a, b]| {
        let mut there = point;
        there[u] = point[u].wrapping_add_signed(a);
        there[v] = point[v].wrapping_add_signed(b);
        there[u] < dims[u] && there[v] < dims[v] && volume.get(there) != is_inside
    })
}
