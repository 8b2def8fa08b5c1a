//! A fixed number of steps, tile by tile: the presets `fast` and `default`.
//!
//! What the solver keeps for a vertex is many times what remains of it; worked on by tiles, that
//! stays in the processor's cache, and the memory is that of the positions alone.

use std::ops::ControlFlow;

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
    Effort { segment: count, segments: 1, reduction: 1e-3, converges: false }
}

/// What a preset does; nothing for the one that converges.
pub(super) fn passes(preset: Preset) -> Option<Passes> {
    match preset {
        Preset::Fast => Some(&[&[iterations(20)]]),
        Preset::Default => Some(&[&[iterations(10), iterations(20)], &[iterations(30)]]),
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
        let mut pass = Pass::new(passes, n + 1 == visits.len());
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
