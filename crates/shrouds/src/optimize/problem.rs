//! The energy of all planar curves as a function of the positions along the grid edges.

mod weights;

use std::iter::Sum;
use std::ops::{Add, Range};

use crate::energy::{CurveEnergy, Energy, LANES, Support};
use crate::network::{Network, REPEATED};
use crate::optimize::barrier::{Barrier, Shared};
use crate::optimize::bounds::Bounds;
use crate::optimize::crease::Creases;
use crate::optimize::mean::{CellGrid, MeanEnergy};
use crate::optimize::real::Real;
use crate::optimize::settings::Settings;
use crate::optimize::strip::{Lengths, STRIP, Strip};
use crate::optimize::thin::Voxels;
use crate::parallel::{self, NONE};
use crate::surface::Surface;

pub(crate) use weights::power_of_root;

/// What a problem is made of besides the curves.
#[derive(Clone, Copy)]
pub(crate) struct Conditions<'a> {
    pub(crate) energy: &'a Energy,
    /// Of the lattice, in units of the smallest one.
    pub(crate) spacing: [f64; 3],
    /// Between what the positions must stay, and the interval of each; empty if there are none.
    pub(crate) bounds: [f64; 2],
    pub(crate) intervals: &'a [[f64; 2]],
    /// See [`flatness`](crate::optimize::flat::flatness).
    pub(crate) flatness: &'a [f32],
    pub(crate) creases: Option<Creases<'a>>,
    /// What says which parts are thin, unless the problem is told itself.
    pub(crate) voxels: Option<Voxels<'a>>,
    /// The mean energy of the vertices of the whole surface, where the problem has a part of it only:
    /// what the barrier follows must not depend on where the surface is cut.
    pub(crate) mean_energy: Option<&'a MeanEnergy>,
    /// In what the energies are gathered that the barrier follows on the way to convergence.
    pub(crate) cells: Option<CellGrid>,
    /// What pulls every vertex up its grid edge, or nothing.
    pub(crate) forces: Option<&'a [f32]>,
}

impl<'a> Conditions<'a> {
    pub(crate) fn new(
        surface: &'a Surface,
        settings: &Settings,
        energy: &'a Energy,
        flatness: &'a [f32],
    ) -> Self {
        let grid = surface.grid();
        let spacing = grid.spacing().map(|h| h / grid.min_spacing());
        let bounds = settings.bounds();
        Self {
            energy,
            spacing,
            bounds,
            intervals: &[],
            flatness,
            creases: None,
            voxels: Some(Voxels::of(surface)),
            mean_energy: None,
            cells: None,
            forces: None,
        }
    }
}

/// The function to minimise. Weights and barrier depend on the surface; they are frozen while
/// solving and refreshed by [`Problem::freeze`]. Lengths are in units of the smallest spacing.
pub(crate) struct Problem<'a, R> {
    pub(crate) network: &'a Network,
    energy: &'a Energy,
    pub(crate) parts: Vec<WeightedPart<'a, R>>,
    pub(crate) lengths: Lengths<R>,
    pub(crate) bounds: Bounds<R>,
    pub(crate) barrier: Barrier,
    /// What the shared part of it follows at every vertex; nothing for the mean energy of them all.
    means: Option<Vec<f32>>,
    /// How surely every vertex lies on a flat face along the grid.
    flatness: Vec<f32>,
    creases: Option<Creases<'a>>,
    /// See [`Creases`]; empty without them.
    thinness: Vec<f32>,
    /// Whether a vertex must stay where it is.
    pub(crate) is_fixed: Vec<bool>,
    /// Whether a vertex does not count in sums, and whether there is one that does not.
    pub(super) is_foreign: Vec<bool>,
    has_foreign: bool,
}

/// A measure with the weight of its ρ at every place, 0 where a vertex that it needs is missing.
pub(crate) struct WeightedPart<'a, R> {
    pub(crate) measure: &'a dyn CurveEnergy,
    weight: f64,
    /// By vertex; none stands for 1.
    factors: Option<Vec<f32>>,
    weights: Vec<R>,
}

/// The value of the energy, and the part of it that stands at vertices that are not foreign.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Value {
    pub(crate) all: f64,
    pub(crate) own: f64,
}

impl Add for Value {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { all: self.all + other.all, own: self.own + other.own }
    }
}

impl Sum for Value {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::default(), |sum, term| sum + term)
    }
}

impl<'a, R: Real> Problem<'a, R> {
    /// The problem with weights as if every slice cut the surface at a right angle, and no barrier.
    /// `local` takes what is known of the vertices of the surface to those of the network.
    pub(crate) fn new(
        network: &'a Network,
        conditions: &Conditions<'a>,
        local: impl Fn(&[f32]) -> Vec<f32>,
    ) -> Self {
        let parts = conditions.energy.parts().iter().map(|part| WeightedPart {
            measure: part.measure.as_ref(),
            weight: part.weight,
            factors: part.factors.as_deref().map(&local),
            weights: vec![R::default(); network.vertices().len()],
        });
        let mut problem = Self {
            network,
            energy: conditions.energy,
            parts: parts.collect(),
            lengths: Lengths::new(conditions.spacing),
            bounds: Bounds::new(conditions.bounds),
            flatness: local(conditions.flatness),
            creases: conditions.creases,
            thinness: conditions.creases.map(|creases| local(creases.thinness)).unwrap_or_default(),
            barrier: Barrier::none(network.vertex_count()),
            means: None,
            is_fixed: vec![false; network.vertex_count()],
            is_foreign: vec![false; network.vertex_count()],
            has_foreign: false,
        };
        problem.set_weights(&vec![[R::from_f64(1.0); 2]; network.vertex_count()], &[]);
        problem
    }

    /// Lets some vertices stay where they are.
    pub(super) fn fix(&mut self, is_fixed: Vec<bool>) {
        self.is_fixed = is_fixed;
    }

    /// Leaves some vertices out of what is summed up over the tiles of a surface.
    pub(super) fn leave_out(&mut self, is_foreign: Vec<bool>) {
        self.has_foreign = is_foreign.contains(&true);
        self.is_foreign = is_foreign;
    }

    /// Keeps the vertices in intervals of their own, where there are some.
    pub(super) fn narrow(&mut self, intervals: &[[f64; 2]]) {
        self.bounds.narrow(intervals);
        self.barrier.narrow(intervals.to_vec());
    }

    /// Pulls the vertices up their grid edges from where they are.
    pub(super) fn pull(&mut self, forces: Vec<f32>, x: &[R]) {
        self.barrier.pull(forces, x.iter().map(|x| x.to_f64()).collect());
    }

    /// The largest support of the measures.
    pub(super) fn support(&self) -> Support {
        self.energy.support()
    }

    /// Whether weights or barrier depend on the surface.
    pub(super) fn needs_freezing(&self) -> bool {
        self.has_weights() || self.energy.barrier() != 0.0
    }

    /// Whether the weights depend on the surface.
    fn has_weights(&self) -> bool {
        self.energy.has_meusnier_weights() || self.creases.is_some()
    }

    /// Sets the Meusnier weights, and the barrier from the energy they give, for the surface at `x`.
    pub(super) fn freeze(&mut self, x: &[R]) {
        self.freeze_weights(x);
        let energies = self.energies(x);
        self.set_barrier(|place| energies[place]);
    }

    /// Sets the barrier for a surface whose places have these energies.
    pub(crate) fn set_barrier(&mut self, of_place: impl Fn(usize) -> R + Sync) {
        let network = self.network;
        let of_vertex = |v| energy_of_vertex(network, v, &of_place);
        let shared = match (self.creases, &self.means) {
            (Some(creases), _) => Shared::Fixed(creases.barrier),
            (None, Some(means)) => Shared::Around(self.energy.barrier(), means),
            (None, None) => Shared::ByEnergy(self.energy.barrier()),
        };
        self.barrier.set(shared, &self.flatness, of_vertex);
    }

    /// Lets the barrier follow these mean energies around the vertices.
    pub(crate) fn follow(&mut self, means: Vec<f32>) {
        self.means = Some(means);
    }

    /// The energy of a vertex that the barrier goes by.
    pub(crate) fn energy_of_vertex(&self, v: usize, of_place: impl Fn(usize) -> R + Sync) -> f64 {
        energy_of_vertex(self.network, v, &of_place)
    }

    /// The sum over all vertices that are not foreign.
    pub(crate) fn sum_over_own_vertices(&self, of_place: impl Fn(usize) -> R + Sync) -> f64 {
        parallel::sum_blocks(self.network.vertex_count(), |range| {
            let own = range.filter(|&v| !self.is_foreign[v]);
            own.map(|v| energy_of_vertex(self.network, v, &of_place)).sum::<f64>()
        })
    }

    /// The energy at `x`, barrier included.
    pub(super) fn value(&self, x: &[R]) -> f64 {
        let energies = self.energies(x);
        let sum = parallel::sum_blocks(energies.len(), |range| {
            self.sum_over_curves(range, |place| energies[place])
        });
        (sum + self.barrier_value(x)).all
    }

    /// The energy of the curves at `x`, place by place.
    fn energies(&self, x: &[R]) -> Vec<R> {
        let mut energies = vec![R::default(); self.network.vertices().len()];
        parallel::update_blocks(&mut energies, NONE, |first, energies, []| {
            self.strips(x, first..first + energies.len(), |strip, places| {
                for part in &self.parts {
                    part.load_weights(strip, places.clone());
                    for n in (0..places.len()).step_by(LANES) {
                        let term = R::terms(part.measure, &strip.stencils(n + REPEATED));
                        let weights = strip.weights(n + REPEATED);
                        let [a, b] = term.residual;
                        let out = &mut energies[places.start - first + n..];
                        let count = LANES.min(places.len() - n);
                        for (l, out) in out.iter_mut().enumerate().take(count) {
                            *out = *out + weights[l] * (a[l] * a[l] + b[l] * b[l]);
                        }
                    }
                }
            });
            0.0
        });
        energies
    }

    /// The sum of the values of a range of places, those that repeat others left out.
    pub(super) fn sum_over_curves(
        &self,
        range: Range<usize>,
        of_place: impl Fn(usize) -> R,
    ) -> Value {
        let part = |part: Range<usize>| {
            let all = sum_of(part.clone().map(|place| of_place(place).to_f64()));
            let foreign: f64 = if self.has_foreign {
                let is_foreign = self.network.at_places(part.clone(), &self.is_foreign);
                let foreign = part.zip(is_foreign).filter(|(_, is_foreign)| *is_foreign);
                foreign.map(|(place, _)| of_place(place).to_f64()).sum()
            } else {
                0.0
            };
            Value { all, own: all - foreign }
        };
        self.network.curve_parts(range).map(part).sum()
    }

    /// The barrier of all vertices, and the work of what pulls them.
    pub(crate) fn barrier_value(&self, x: &[R]) -> Value {
        if !self.barrier.acts() {
            return Value::default();
        }
        parallel::sum_blocks(x.len(), |range| {
            let value = |v| {
                let all = self.barrier.value(v, x[v].to_f64());
                Value { all, own: if self.is_foreign[v] { 0.0 } else { all } }
            };
            range.map(value).sum()
        })
    }

    /// Calls `f` with all strips of the places in `range`, but for the very first and last places of
    /// all, which only repeat others.
    pub(super) fn strips(
        &self,
        x: &[R],
        range: Range<usize>,
        mut f: impl FnMut(&mut Strip<R>, Range<usize>),
    ) {
        let total = self.network.vertices().len();
        let end = range.end.min(total.saturating_sub(REPEATED));
        let mut strip = Strip::new();
        for start in (range.start.max(REPEATED)..end).step_by(STRIP) {
            let places = start..end.min(start + STRIP);
            let loaded = places.start - REPEATED..places.end + REPEATED;
            strip.load(self.network, loaded, &self.lengths, x);
            f(&mut strip, places);
        }
    }

    /// A mark for every place: `mark` of the smaller squared length of the chords before and after it
    /// and the cosine between them. Where a curve ends the missing neighbour lies far away.
    pub(crate) fn mark_places<M: Copy + Default + Send>(
        &self,
        x: &[R],
        mark: impl Fn(f32, f32) -> M + Sync,
    ) -> Vec<M> {
        let mut marks = vec![M::default(); self.network.vertices().len()];
        parallel::update_blocks(&mut marks, NONE, |first, marks, []| {
            self.strips(x, first..first + marks.len(), |strip, places| {
                for n in (0..places.len()).step_by(LANES) {
                    let (lengths, cosines) = strip.turnings(n + REPEATED);
                    let mut values = [M::default(); LANES];
                    for l in 0..LANES {
                        values[l] = mark(lengths[l], cosines[l]);
                    }
                    let out = places.start - first + n;
                    let count = LANES.min(places.len() - n);
                    marks[out..out + count].copy_from_slice(&values[..count]);
                }
            });
            0.0
        });
        marks
    }

    /// Whether the barrier keeps steps from reaching the bounds.
    pub(super) fn has_barrier(&self) -> bool {
        self.barrier.is_set()
    }
}

impl<R: Real> WeightedPart<'_, R> {
    /// Sets the weights of a strip whose own places are these, and of those around them.
    pub(super) fn load_weights(&self, strip: &mut Strip<R>, places: Range<usize>) {
        strip.load_weights(&self.weights[places.start - REPEATED..places.end + REPEATED]);
    }

    pub(super) fn weights(&self, places: Range<usize>) -> &[R] {
        &self.weights[places]
    }

    /// Whether it counts at none of the places of a strip, nor around them.
    pub(super) fn is_nothing(&self, places: Range<usize>) -> bool {
        let weights = &self.weights[places.start - REPEATED..places.end + REPEATED];
        weights.iter().all(|weight| *weight == R::default())
    }
}

/// The energy of a vertex from those of the places, each with what its neighbours have: on a thin
/// ribbon only the rims curve.
fn energy_of_vertex<R: Real>(
    network: &Network,
    v: usize,
    of_place: &(impl Fn(usize) -> R + Sync),
) -> f64 {
    let near = |place: u32| {
        let place = place as usize;
        let near = [place - 1, place, place + 1].map(|place| of_place(place).to_f64());
        near.into_iter().fold(0.0, f64::max)
    };
    network.places()[v].iter().map(|&place| near(place)).sum()
}

/// The sum, in partial sums side by side.
fn sum_of(values: impl Iterator<Item = f64>) -> f64 {
    let mut sums = [0.0; LANES];
    for (n, value) in values.enumerate() {
        sums[n % LANES] += value;
    }
    sums.into_iter().sum()
}
