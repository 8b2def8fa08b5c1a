//! A fixed number of steps, tile by tile: the presets `fast` and `default`.
//!
//! What the solver keeps for a vertex is many times what remains of it; worked on by tiles, that
//! stays in the processor's cache, and the memory is that of the positions alone.

use crate::optimize::conjugate::Effort;
use crate::optimize::newton::Newton;
use crate::optimize::problem::{Conditions, Problem};
use crate::optimize::report::{Round, Stationarity, Status};
use crate::optimize::settings::{Observer, Preset, Progress};
use crate::optimize::tile::{Tile, TileRows, partition};
use crate::parallel;
use crate::surface::Surface;

/// Vertices per tile, about: enough that little is worked on twice, few enough for the cache.
const TILE: usize = 50_000;
/// Tiles worked on between two calls of the observer.
const GROUP: usize = 8;

/// The steps of the passes over all tiles; weights and barrier are frozen anew for each pass.
pub(super) type Passes = &'static [&'static [Effort]];

const fn iterations(count: usize) -> Effort {
    Effort { segment: count, segments: 1, reduction: 1e-3, repairs: true, converges: false }
}

/// What a preset does; nothing for the one that converges.
pub(super) fn passes(preset: Preset) -> Option<Passes> {
    const FAST: Passes = &[&[iterations(20)]];
    // What goes wrong in the first step the next one mends.
    const FIRST: Effort = Effort { repairs: false, ..iterations(10) };
    const DEFAULT: Passes = &[&[FIRST, iterations(20)], &[iterations(30)]];
    match preset {
        Preset::Fast => Some(FAST),
        Preset::Default => Some(DEFAULT),
        Preset::Exact => None,
    }
}

/// What is known of a surface after the passes.
pub(super) struct Relaxed {
    pub(super) rounds: Vec<Round>,
    pub(super) stationarity: Stationarity,
    /// See [`Problem::slopes`].
    pub(super) slopes: Vec<[f32; 2]>,
}

/// What working on a tile brought.
struct Visit {
    x: Vec<f32>,
    /// The energy of the tile's own vertices, for each pass that was made, before it and after every
    /// step.
    energies: Vec<Vec<f64>>,
    stationarity: Stationarity,
    slopes: Vec<[f32; 2]>,
}

/// Makes the passes, at most `most_steps` steps of them.
pub(super) fn relax(
    surface: &Surface,
    conditions: &Conditions,
    passes: Passes,
    most_steps: usize,
    x: &mut [f32],
    observer: &mut Observer,
) -> Relaxed {
    let mut left = most_steps;
    let shorten = |steps: &&'static [Effort]| {
        let steps = &steps[..left.min(steps.len())];
        left -= steps.len();
        steps
    };
    let whole: usize = passes.iter().map(|steps| steps.len()).sum();
    let end = if most_steps < whole { Status::IterationLimit } else { Status::Preset };
    let passes: Vec<&[Effort]> = passes.iter().map(shorten).collect();
    let mut relaxed = Relaxed {
        rounds: Vec::new(),
        stationarity: Stationarity::default(),
        slopes: vec![[0.0; 2]; x.len()],
    };
    // A surface of one tile is not cut, and no pass depends on what others did to its surroundings.
    let is_one_tile = x.len() <= TILE + TILE / 2;
    let visits: Vec<&[&[Effort]]> =
        if is_one_tile { vec![&passes] } else { passes.chunks(1).collect() };
    for (n, passes) in visits.iter().enumerate() {
        let colours = match is_one_tile {
            true => [vec![TileRows::all(surface)], Vec::new(), Vec::new(), Vec::new()],
            false => partition(surface, TILE, n % 2 == 1),
        };
        let mut pass =
            Pass::new(passes, if n + 1 == visits.len() { end } else { Status::IterationLimit });
        let groups: Vec<&[TileRows]> = colours.iter().flat_map(|c| c.chunks(GROUP)).collect();
        for (done, tiles) in groups.iter().enumerate() {
            let found = parallel::blocks(tiles.len(), 1, |range| {
                let tile = Tile::cut(surface, tiles[range.start].clone());
                let visit = visit(&tile, conditions, passes, x);
                (tile, visit)
            });
            for (tile, visit) in found {
                tile.write(&visit.x, x);
                tile.write(&visit.slopes, &mut relaxed.slopes);
                pass.add(visit);
            }
            let fraction = (done + 1) as f64 / groups.len() as f64;
            let progress = pass.progress(n, visits.len(), fraction);
            if observer(progress).is_break() {
                pass.status = Status::Cancelled;
                break;
            }
        }
        let cancelled = pass.status == Status::Cancelled;
        relaxed.stationarity = pass.stationarity;
        relaxed.rounds.extend(pass.into_rounds());
        if cancelled {
            break;
        }
    }
    relaxed
}

/// Works on one tile: the steps of some passes, weights and barrier frozen anew for each.
fn visit(tile: &Tile, conditions: &Conditions, passes: &[&[Effort]], x: &[f32]) -> Visit {
    let mut x = tile.read(x);
    let mut problem = Problem::new(&tile.network, conditions);
    problem.fix(tile.is_fixed());
    let mut newton = Newton::new(&tile.network);
    let mut energies = Vec::new();
    for steps in passes {
        problem.freeze_weights(&x);
        let mut energy = newton.model.linearise_with_new_barrier(&mut problem, &x);
        let mut own = vec![energy.own];
        for effort in *steps {
            let Some(lower) = newton.step(&problem, &mut x, energy, effort) else { break };
            energy = lower;
            own.push(energy.own);
        }
        energies.push(own);
    }
    let stationarity = Stationarity::of(&newton.model, &x, problem.bounds, &problem.is_fixed);
    let slopes = problem.slopes(&x);
    Visit { x, energies, stationarity, slopes }
}

/// What the tiles of some passes brought so far.
struct Pass {
    /// For each pass the sums over the tiles before it and after every step.
    energies: Vec<Vec<f64>>,
    stationarity: Stationarity,
    status: Status,
}

impl Pass {
    fn new(passes: &[&[Effort]], status: Status) -> Self {
        Self {
            energies: passes.iter().map(|steps| vec![0.0; steps.len() + 1]).collect(),
            stationarity: Stationarity::default(),
            status,
        }
    }

    fn add(&mut self, visit: Visit) {
        for (sums, found) in self.energies.iter_mut().zip(visit.energies) {
            for (n, sum) in sums.iter_mut().enumerate() {
                // A tile that could not go lower stays where it is.
                *sum += found[n.min(found.len() - 1)];
            }
        }
        self.stationarity.add(visit.stationarity);
    }

    fn progress(&self, pass: usize, passes: usize, fraction: f64) -> Progress {
        Progress {
            iteration: pass + 1,
            energy: self.energies.last().and_then(|e| e.last()).copied().unwrap_or_default(),
            change: self.stationarity.step_rms(),
            tolerance: 0.0,
            share_done: Some((pass as f64 + fraction) / passes as f64),
        }
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
