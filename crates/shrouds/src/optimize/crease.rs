//! Creases: edges that stay sharp between faces that become flat.
//!
//! Every convex curve turns by 2π in all, so that an energy convex in the turning angle cannot tell a
//! corner from an arc. One that levels off can. Here the squares of the energy are weighted by
//! `1/(1 + (θ/σ)²)²`, θ being the turning angle when the weights are frozen, which makes the sum one of
//! Geman and McClure: a vertex that turns by much more than σ counts next to nothing.

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
    /// See [`of_single_points`](crate::optimize::thin::of_single_points).
    ///
    /// Nothing would keep a part one voxel thin from shrinking if only corners were left of it, so there
    /// all vertices count.
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
