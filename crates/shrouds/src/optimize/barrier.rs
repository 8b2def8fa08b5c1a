//! What keeps vertices off the ends of their grid edges, thin parts alive and flat faces flat, and what
//! pulls each of them with a force of its own.

use crate::parallel;

/// The largest strength that all vertices share.
const SHARED_CAP: f64 = 0.01;
/// Strength for each unit of the energy at the vertex itself where that is above 1, as on parts of one
/// voxel; below, the share falls with the energy, so that smooth surfaces know nothing of it.
const OWN_SHARE: f64 = 0.4;
/// Strength at a vertex on a flat face along the grid.
const ON_FLAT_FACES: f64 = 1.5;

/// The sum of `−μ·log(4·x·(1 − x))` over the vertices, each with its own strength μ.
///
/// What energies and voxels leave open a vertex decides for the middle of its grid edge. The shared
/// part of the strength follows the mean energy, of all vertices or of those around, which says how far
/// the shape is from what the energy likes best. The others stand where an energy that falls with growing
/// size would lift a part as far as it can: around parts about one voxel thin, which curve strongly, and on flat faces
/// along the grid, whose borders do. Where a vertex is known to lie in an interval, that takes the place
/// of its grid edge: the rougher the shape, the nearer to the middle it stays.
pub(crate) struct Barrier {
    strengths: Vec<f32>,
    is_set: bool,
    /// By vertex; empty if all have the whole grid edge.
    intervals: Vec<[f64; 2]>,
    /// See [`Barrier::pull`]; empty where nothing pulls.
    forces: Vec<f32>,
    anchors: Vec<f64>,
}

/// The part of the strength that all vertices share.
#[derive(Clone, Copy)]
pub(super) enum Shared<'a> {
    /// This part of their mean energy, see
    /// [`CurveFormula::barrier`](crate::energy::CurveFormula::barrier).
    ByEnergy(f64),
    /// This part of the mean energy around every vertex, which is known.
    Around(f64, &'a [f32]),
    /// Whatever their energy.
    Fixed(f64),
}

impl Barrier {
    pub(super) fn none(vertices: usize) -> Self {
        Self {
            strengths: vec![0.0; vertices],
            is_set: false,
            intervals: Vec::new(),
            forces: Vec::new(),
            anchors: Vec::new(),
        }
    }

    /// Lets the vertices have an interval of their grid edges each.
    pub(super) fn narrow(&mut self, intervals: Vec<[f64; 2]>) {
        self.intervals = intervals;
    }

    /// Sets the strengths for vertices that lie so surely on flat faces and have these energies.
    pub(super) fn set(
        &mut self,
        shared: Shared<'_>,
        flatness: &[f32],
        energy_of: impl Fn(usize) -> f64 + Sync,
    ) {
        let (Shared::ByEnergy(strength) | Shared::Around(strength, _) | Shared::Fixed(strength)) =
            shared;
        self.is_set = strength > 0.0;
        if !self.is_set {
            return;
        }
        let count = self.strengths.len();
        let mean = || {
            let sum = parallel::sum_blocks(count, |range| range.map(&energy_of).sum::<f64>());
            sum / count.max(1) as f64
        };
        let (everywhere, part, means) = match shared {
            Shared::ByEnergy(part) => ((part * mean()).min(SHARED_CAP), 0.0, &[][..]),
            Shared::Around(part, means) => (0.0, part, means),
            Shared::Fixed(strength) => (strength, 0.0, &[][..]),
        };
        let around = |mean: &f32| (part * f64::from(*mean)).min(SHARED_CAP);
        parallel::fill(&mut self.strengths, |v| {
            let energy = energy_of(v);
            let own = OWN_SHARE * energy * energy.min(1.0);
            let shared = means.get(v).map_or(everywhere, around);
            (shared + own + ON_FLAT_FACES * f64::from(flatness[v])) as f32
        });
    }

    /// Pulls every vertex up its grid edge with a force that does not change: subtracts the work they
    /// do, which is 0 with the vertices at `anchors`.
    pub(super) fn pull(&mut self, forces: Vec<f32>, anchors: Vec<f64>) {
        (self.forces, self.anchors) = (forces, anchors);
    }

    /// Whether it holds vertices off the ends.
    pub(super) fn is_set(&self) -> bool {
        self.is_set
    }

    /// Whether it has a value other than 0.
    pub(super) fn acts(&self) -> bool {
        self.is_set || !self.forces.is_empty()
    }

    pub(crate) fn value(&self, v: usize, x: f64) -> f64 {
        let work = match self.forces.get(v) {
            Some(&force) => f64::from(force) * (x - self.anchors[v]),
            None => 0.0,
        };
        let x = match self.intervals.get(v) {
            Some([start, end]) => (x - start) / (end - start),
            None => x,
        };
        -f64::from(self.strengths[v]) * (4.0 * x * (1.0 - x)).ln() - work
    }

    /// Slope and curvature.
    #[inline]
    pub(super) fn slopes(&self, v: usize, x: f64) -> (f64, f64) {
        let strength = f64::from(self.strengths[v]);
        let [start, end] = self.intervals.get(v).copied().unwrap_or([0.0, 1.0]);
        let (low, high) = (1.0 / (x - start), 1.0 / (end - x));
        let force = self.forces.get(v).map_or(0.0, |&force| f64::from(force));
        (strength * (high - low) - force, strength * (low * low + high * high))
    }
}
