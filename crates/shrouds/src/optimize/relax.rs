//! Passes over the surface, tile by tile.
//!
//! What the solver keeps for a vertex is many times what remains of it; worked on by tiles, that
//! stays in the processor's cache, and the memory is that of the positions alone.

use crate::optimize::conjugate::Effort;
use crate::optimize::mean::{CellGrid, Gathered, MeanEnergy};
use crate::optimize::plan::{Passes, STEPS};
use crate::optimize::problem::Conditions;
use crate::optimize::progress::{Observer, Positions, Progress};
use crate::optimize::real::Real;
use crate::optimize::report::{Round, Stationarity, Status};
use crate::optimize::shares;
use crate::optimize::tile::{Tile, TilePoints, Tiling, partition};
use crate::optimize::visit::{Moment, Visit, Watch, visit};
use crate::parallel;
use crate::surface::Surface;

/// Vertices per tile, about: enough that little is worked on twice, few enough for the cache.
pub(super) const TILE: usize = 50_000;
/// Tiles worked on between two calls of the observer.
pub(super) const GROUP: usize = 8;

/// What is known of a surface after the passes.
pub(super) struct Relaxed {
    pub(super) rounds: Vec<Round>,
    pub(super) stationarity: Stationarity,
    /// See [`Problem::slopes`](crate::optimize::problem::Problem::slopes).
    pub(super) slopes: Vec<[f32; 2]>,
    /// See [`Conditions`].
    pub(super) mean_energy: Option<MeanEnergy>,
}

impl Relaxed {
    pub(super) fn new(vertices: usize) -> Self {
        Self {
            rounds: Vec::new(),
            stationarity: Stationarity::default(),
            slopes: vec![[0.0; 2]; vertices],
            mean_energy: None,
        }
    }

    /// Takes in what the visit of a tile brought to a pass besides the positions.
    fn finish<R>(&mut self, pass: &mut Pass, tile: &Tile, visit: Visit<R>) {
        tile.write(&visit.slopes, &mut self.slopes);
        pass.add(visit);
    }

    /// Steps that were made.
    pub(super) fn steps(&self) -> usize {
        self.rounds.iter().map(|round| round.energies.len() - 1).sum()
    }

    pub(super) fn status(&self) -> Status {
        self.rounds.last().map_or(Status::Empty, |round| round.status)
    }
}

/// Makes the passes, at most `most_steps` steps of them.
pub(super) fn relax<R: Real>(
    surface: &Surface,
    conditions: &Conditions,
    passes: Passes,
    most_steps: usize,
    x: &mut [R],
    observer: &mut Observer,
) -> Relaxed {
    let relaxed = Relaxed::new(x.len());
    let lows = surface.crossings().map(|crossing| crossing.low());
    let cells = passes.converge().then(|| CellGrid::of(lows));
    let conditions = &Conditions { cells, ..*conditions };
    let mut work = Work { surface, conditions, least: 0.0, mean_energy: None, relaxed };
    match passes {
        Passes::Fixed(passes) => work.make_all(passes, most_steps, x, observer),
        Passes::UntilConverged { tolerance, most_steps: own_most } => {
            work.converge(tolerance, most_steps.min(own_most), x, observer);
        }
    }
    Relaxed { mean_energy: work.mean_energy, ..work.relaxed }
}

/// A surface with what was found out about it so far.
struct Work<'a> {
    surface: &'a Surface,
    conditions: &'a Conditions<'a>,
    /// See [`visit`].
    least: f64,
    /// As the last pass found it.
    mean_energy: Option<MeanEnergy>,
    relaxed: Relaxed,
}

impl Work<'_> {
    /// Whether the surface is not cut, so that no pass depends on what others did to its surroundings.
    fn is_one_tile(&self, vertices: usize) -> bool {
        vertices <= TILE + TILE / 2
    }

    /// Makes some passes and no more.
    fn make_all<R: Real>(
        &mut self,
        passes: &[&'static [Effort]],
        most_steps: usize,
        x: &mut [R],
        observer: &mut Observer,
    ) {
        let mut left = most_steps;
        let shorten = |steps: &&'static [Effort]| {
            let steps = &steps[..left.min(steps.len())];
            left -= steps.len();
            steps
        };
        let whole: usize = passes.iter().map(|steps| steps.len()).sum();
        let end = if most_steps < whole { Status::IterationLimit } else { Status::Preset };
        let passes: Vec<&[Effort]> = passes.iter().map(shorten).collect();
        let visits: Vec<&[&[Effort]]> =
            if self.is_one_tile(x.len()) { vec![&passes] } else { passes.chunks(1).collect() };
        for (n, passes) in visits.iter().enumerate() {
            let status = if n + 1 == visits.len() { end } else { Status::IterationLimit };
            let pass = Pass::new(passes, status);
            let (surface, done) = (self.surface, self.relaxed.steps());
            let pass = self.make(pass, passes, n % 2 == 1, x, &mut |moment| {
                let share = Some((n as f64 + moment.share) / visits.len() as f64);
                observer(progress(surface, moment, done, 0.0, share)).is_break()
            });
            if self.take(pass, x.len()) == Status::Cancelled {
                return;
            }
        }
    }

    /// Makes passes until one finds next to nothing to do.
    fn converge<R: Real>(
        &mut self,
        tolerance: f64,
        most_steps: usize,
        x: &mut [R],
        observer: &mut Observer,
    ) {
        self.least = tolerance;
        let look = self.look(x);
        self.follow(&look, x.len());
        let mut was_short = true;
        for n in 0.. {
            let (surface, done) = (self.surface, self.relaxed.steps());
            let steps = &STEPS[..STEPS.len().min(most_steps - done)];
            let pass = Pass::new(&[steps], Status::IterationLimit);
            let mut pass = self.make(pass, &[steps], n % 2 == 1, x, &mut |moment| {
                observer(progress(surface, moment, done, tolerance, None)).is_break()
            });
            pass.drop_idle_steps();
            let is_stationary = pass.stationarity.step_rms() <= tolerance;
            let first_move = (pass.first_move / x.len() as f64).sqrt();
            if pass.status != Status::Cancelled && !steps.is_empty() {
                pass.status = match () {
                    () if is_stationary && first_move <= tolerance && was_short => {
                        Status::Converged
                    }
                    () if pass.steps() == 0 => Status::Stalled,
                    () => Status::IterationLimit,
                };
            }
            was_short = pass.steps() < steps.len();
            let is_last =
                pass.status != Status::IterationLimit || done + pass.steps() >= most_steps;
            self.take(pass, x.len());
            if is_last {
                break;
            }
        }
        if self.conditions.energy.is_convex() {
            // How far from the minimum it can be.
            self.relaxed.stationarity = self.look(x).stationarity;
            self.relaxed.stationarity.is_certain = true;
        }
    }

    /// Looks at the surface, all of it as it is now.
    fn look<R: Real>(&mut self, x: &mut [R]) -> Pass {
        let pass = Pass::new(&[&[]], Status::default());
        self.make(pass, &[&[]], false, x, &mut |_| false)
    }

    /// Visits all tiles, `shifted` against those of the pass before. `watch` is told after every step of
    /// the only tile, or after some tiles.
    fn make<R: Real>(
        &mut self,
        mut pass: Pass,
        passes: &[&[Effort]],
        shifted: bool,
        x: &mut [R],
        watch: &mut Watch<R>,
    ) -> Pass {
        let (surface, least) = (self.surface, self.least);
        let mean_energy = self.mean_energy.as_ref().or(self.conditions.mean_energy);
        let conditions = Conditions { mean_energy, ..*self.conditions };
        if self.is_one_tile(x.len()) {
            let tile = Tile::cut(surface, TilePoints::all(surface));
            let own = tile.read(x, R::from_f64(0.5));
            let visit = visit(&tile, &conditions, passes, least, own, Some(watch));
            tile.write(&visit.x, x);
            self.relaxed.finish(&mut pass, &tile, visit);
            return pass;
        }
        // On the way to convergence what one tile finds is the surroundings of the next. Tiles of the
        // lattice know nothing of each other, and do not depend on the extent of the surface.
        let converges = conditions.cells.is_some();
        let colours: Vec<Vec<TilePoints>> = match converges {
            true => partition(surface, TILE, shifted).into(),
            false => vec![Tiling::of(surface).tiles(surface, &surface.points())],
        };
        let mut shares = vec![0; if converges { 0 } else { x.len() }];
        let groups: Vec<&[TilePoints]> = colours.iter().flat_map(|c| c.chunks(GROUP)).collect();
        for (done, tiles) in groups.iter().enumerate() {
            for (tile, visit) in visit_all(surface, &conditions, tiles, passes, least, x) {
                match converges {
                    true => tile.write(&visit.x, x),
                    false => shares::add(&tile, &visit.x, &mut shares),
                }
                self.relaxed.finish(&mut pass, &tile, visit);
            }
            if done + 1 == groups.len() {
                shares::settle(&shares, conditions.bounds, x);
            }
            if watch(pass.moment((done + 1) as f64 / groups.len() as f64, x)) {
                pass.status = Status::Cancelled;
                break;
            }
        }
        pass
    }

    /// Takes in what a pass over so many vertices brought.
    fn take(&mut self, pass: Pass, vertices: usize) -> Status {
        let status = pass.status;
        self.follow(&pass, vertices);
        self.relaxed.stationarity = pass.stationarity;
        self.relaxed.rounds.extend(pass.into_rounds());
        status
    }

    /// Lets the barrier of the next pass follow the energies that one over so many vertices found.
    fn follow(&mut self, pass: &Pass, vertices: usize) {
        if let (Some(cells), Some(gathered)) = (self.conditions.cells, &pass.gathered) {
            self.mean_energy = Some(MeanEnergy::around(cells, gathered));
        } else if !self.is_one_tile(vertices) {
            let mean = pass.energy_of_vertices.mean(vertices as u64);
            self.mean_energy = Some(MeanEnergy::OfAll(mean));
        }
    }
}

/// The work on some tiles, none of which knows what the others find.
pub(super) fn visit_all<'a, R: Real>(
    surface: &'a Surface,
    conditions: &Conditions,
    tiles: &[TilePoints],
    passes: &[&[Effort]],
    least: f64,
    x: &[R],
) -> Vec<(Tile<'a>, Visit<R>)> {
    parallel::blocks(tiles.len(), 1, |range| {
        let tile = Tile::cut(surface, tiles[range.start].clone());
        let own = tile.read(x, R::from_f64(0.5));
        let visit = visit(&tile, conditions, passes, least, own, None);
        (tile, visit)
    })
}

/// A sum of energies that does not depend on the order of adding: in whole units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct EnergySum(pub(crate) u64);

impl EnergySum {
    const UNITS: f64 = (1u64 << 24) as f64;

    /// Adds the energy of a tile.
    pub(crate) fn add(&mut self, energy: f64) {
        self.0 += (energy * Self::UNITS).round() as u64;
    }

    /// The mean over so many vertices.
    pub(crate) fn mean(self, vertices: u64) -> f64 {
        self.0 as f64 / Self::UNITS / vertices.max(1) as f64
    }
}

/// What the tiles of some passes brought so far.
struct Pass {
    /// For each pass the sums over the tiles before it and after every step.
    energies: Vec<Vec<f64>>,
    /// The most steps that a tile made in the last of them.
    most_steps: usize,
    /// See [`Visit::first_move`].
    first_move: f64,
    /// See [`Visit::energy_of_vertices`].
    energy_of_vertices: EnergySum,
    /// See [`Visit::gathered`].
    gathered: Option<Gathered>,
    stationarity: Stationarity,
    status: Status,
}

impl Pass {
    fn new(passes: &[&[Effort]], status: Status) -> Self {
        Self {
            energies: passes.iter().map(|steps| vec![0.0; steps.len() + 1]).collect(),
            most_steps: 0,
            first_move: 0.0,
            energy_of_vertices: EnergySum::default(),
            gathered: None,
            stationarity: Stationarity::default(),
            status,
        }
    }

    fn add<R>(&mut self, visit: Visit<R>) {
        self.first_move += visit.first_move;
        self.energy_of_vertices.add(visit.energy_of_vertices);
        if let Some(of_tile) = visit.gathered {
            self.gathered.get_or_insert_default().merge(of_tile);
        }
        let steps = visit.energies.last().map_or(0, |energies| energies.len() - 1);
        self.most_steps = self.most_steps.max(steps);
        let passes = visit.energies.len();
        for (sums, found) in self.energies.iter_mut().zip(visit.energies) {
            for (n, sum) in sums.iter_mut().enumerate() {
                // A tile that could not go lower stays where it is.
                *sum += found[n.min(found.len() - 1)];
            }
        }
        self.stationarity.add(visit.stationarity);
        if visit.is_cancelled {
            self.status = Status::Cancelled;
            self.energies.truncate(passes);
            self.drop_idle_steps();
        }
    }

    /// Steps of the last pass so far.
    fn steps(&self) -> usize {
        self.most_steps
    }

    /// Forgets the steps at the end that no tile made.
    fn drop_idle_steps(&mut self) {
        if let Some(energies) = self.energies.last_mut() {
            energies.truncate(self.most_steps + 1);
        }
    }

    fn moment<'a, R>(&self, share: f64, x: &'a [R]) -> Moment<'a, R> {
        let energy = self.energies.last().and_then(|e| e.last()).copied().unwrap_or_default();
        let step_rms = self.stationarity.step_rms();
        let gradient = (share >= 1.0).then(|| self.stationarity.gradient());
        Moment { steps: self.most_steps, share, energy, step_rms, gradient, x }
    }

    fn into_rounds(self) -> impl Iterator<Item = Round> {
        let last = self.energies.len() - 1;
        let status = self.status;
        self.energies.into_iter().enumerate().map(move |(n, energies)| Round {
            energies,
            status: if n == last { status } else { Status::IterationLimit },
        })
    }
}

/// What the observer is told of a moment that so many steps came before.
fn progress<'a, R: Real>(
    surface: &'a Surface,
    moment: Moment<'a, R>,
    done: usize,
    tolerance: f64,
    share_done: Option<f64>,
) -> Progress<'a> {
    let Moment { steps, energy, step_rms, gradient, x, .. } = moment;
    let (iteration, change) = (done + steps, step_rms);
    let positions = Positions::new(surface, x);
    Progress { iteration, energy, change, gradient, tolerance, share_done, positions }
}
