//! A box of the surface solved anew while all else stays where it is.
//!
//! The same steps from the same start as for a whole surface of one tile.

use std::ops::Range;

use crate::energy::Energy;
use crate::error::Error;
use crate::optimize::flat::{ACROSS, FARTHEST, flatness_of};
use crate::optimize::mean::{CellGrid, Gathered, MeanEnergy};
use crate::optimize::plan::{self, Passes, STEPS};
use crate::optimize::problem::Conditions;
use crate::optimize::real::Real;
use crate::optimize::relax::TILE;
use crate::optimize::settings::{Preset, Settings, Start};
use crate::optimize::tile::{Tile, TilePoints, partition};
use crate::optimize::visit::visit;
use crate::optimize::{flat, start};
use crate::parallel;
use crate::surface::{Part, Region, Surface};
use crate::volume::Flips;

/// A surface whose boxes are solved anew.
pub(crate) struct Local<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) settings: &'a Settings,
    /// See [`flatness`].
    pub(crate) flatness: &'a [f32],
    /// See [`Local::find_mean_energy`].
    pub(crate) mean_energy: &'a MeanEnergy,
}

/// A box as it is solved.
pub(crate) struct Solved {
    /// The box with what is around it, and its first lattice point in the whole surface.
    piece: Surface,
    first: [usize; 3],
    /// δ of the vertices of the piece; none is not a number.
    delta: Vec<f64>,
    /// Numbers of the box's own, in the piece and in the whole.
    own: Vec<[Range<usize>; 2]>,
}

impl Solved {
    /// Brings the vertices to their order after some lattice points flipped; those that come have no δ.
    ///
    /// # Errors
    /// Those of [`Surface::flip`].
    pub(crate) fn flip(&mut self, flips: &Flips) -> Result<(), Error> {
        let renumbering = self.piece.flip(&flips.seen_from(self.first))?;
        renumbering.splice(&mut self.delta, f64::NAN);
        Ok(())
    }

    /// Where grid edges start, and by how much their vertices moved since the box was solved before.
    pub(crate) fn moves(&self, before: &Self) -> impl Iterator<Item = ([usize; 3], f64)> {
        let moved = self.delta.iter().zip(&before.delta).map(|(now, before)| (now - before).abs());
        self.piece.crossings().zip(moved).map(|(crossing, moved)| {
            let low = crossing.low();
            ([0, 1, 2].map(|d| self.first[d] + low[d]), moved)
        })
    }

    /// Moves the box's own vertices by as much as they moved since the box was solved before: so steps that
    /// left the surface short of its minimum do so as far as they did. Puts new ones where they are.
    pub(crate) fn write(&self, before: Option<&Self>, margin: f64, delta: &mut [f64]) {
        for [here, there] in &self.own {
            for (here, delta) in here.clone().zip(&mut delta[there.clone()]) {
                let (now, before) = (self.delta[here], before.map(|before| before.delta[here]));
                *delta = match before {
                    Some(before) if !before.is_nan() => {
                        (*delta + now - before).clamp(margin, 1.0 - margin)
                    }
                    _ => now,
                };
            }
        }
    }
}

/// How surely every vertex lies on a flat face along the grid.
pub(crate) fn flatness(surface: &Surface) -> Vec<f32> {
    flat::flatness(surface)
}

/// Finds flatness anew around some lattice points that changed their side. Returns boxes that hold all vertices,
/// other than those within `inner`, whose flatness changed.
pub(crate) fn update_flatness(
    surface: &Surface,
    points: &Region,
    inner: &Region,
    flatness: &mut [f32],
) -> Vec<Region> {
    let dims = surface.grid().dims();
    let widened =
        |d: usize, by: usize| points[d].start.saturating_sub(by)..dims[d].min(points[d].end + by);
    let mut changed = Vec::new();
    for axis in 0..3 {
        let bar = [0, 1, 2].map(|d| widened(d, if d == axis { FARTHEST } else { ACROSS }));
        let part = Part::cut(surface, &bar);
        let now = flatness_of(surface, part.crossings());
        let before = part.read(flatness, 0.0);
        part.write(&bar, &now, flatness);
        let moved = part.crossings().zip(before.iter().zip(&now)).filter(|(_, (a, b))| a != b);
        let mut ends: [Option<Region>; 2] = [None, None];
        for (crossing, _) in moved {
            let low = crossing.low();
            if !(0..3).all(|d| inner[d].contains(&low[d])) {
                let end = &mut ends[usize::from(low[axis] >= points[axis].start)];
                let hull = end.get_or_insert_with(|| low.map(|x| x..x + 1));
                for (range, x) in hull.iter_mut().zip(low) {
                    *range = range.start.min(x)..range.end.max(x + 1);
                }
            }
        }
        changed.extend(ends.into_iter().flatten());
    }
    changed
}

impl Local<'_> {
    /// What the barrier that all vertices share follows: the mean energy of the whole surface, and on the
    /// way to convergence that around every vertex.
    pub(crate) fn find_mean_energy(&self, delta: &[f64]) -> MeanEnergy {
        let tiles: Vec<_> = partition(self.surface, TILE, false).into_iter().flatten().collect();
        let lows = self.surface.crossings().map(|crossing| crossing.low());
        let cells = (self.settings.preset == Preset::Exact).then(|| CellGrid::of(lows));
        let found =
            parallel::blocks(tiles.len(), 1, |n| self.energies_of(&tiles[n.start], cells, delta));
        if let Some(cells) = cells {
            let mut gathered = Gathered::default();
            found.into_iter().filter_map(|(_, of_tile)| of_tile).for_each(|it| gathered.merge(it));
            return MeanEnergy::around(cells, &gathered);
        }
        let sum: f64 = found.into_iter().map(|(sum, _)| sum).sum();
        MeanEnergy::OfAll(sum / delta.len().max(1) as f64)
    }

    fn energies_of(
        &self,
        points: &TilePoints,
        cells: Option<CellGrid>,
        delta: &[f64],
    ) -> (f64, Option<Gathered>) {
        let energy = self.settings.energy();
        let tile = Tile::cut(self.surface, points.clone());
        if tile.network.vertex_count() == 0 {
            return Default::default();
        }
        let x: Vec<f32> = positions(&tile, delta);
        let conditions = Conditions { cells, ..self.conditions(&energy) };
        let found = visit(&tile, &conditions, &[&[]], 0.0, x, None);
        (found.energy_of_vertices, found.gathered)
    }

    /// Solves for the vertices whose grid edges start in a box of lattice points, between the others where
    /// `delta` has them.
    ///
    /// # Errors
    /// None in fact: those of starts that are given.
    pub(crate) fn solve(&self, own: Region, delta: &[f64]) -> Result<Solved, Error> {
        match self.settings.preset {
            Preset::Exact => self.solve_as::<f64>(own, delta),
            _ => self.solve_as::<f32>(own, delta),
        }
    }

    fn solve_as<R: Real>(&self, own: Region, delta: &[f64]) -> Result<Solved, Error> {
        let tile = Tile::cut(self.surface, TilePoints::alone(own));
        let mut x: Vec<R> = self.blurred(&tile, &positions(&tile, delta))?;
        if !x.is_empty() {
            for stage in plan::stages(self.settings, &[]) {
                let conditions = self.conditions(&stage.energy);
                x = relax(&tile, &conditions, stage.passes, x);
            }
        }
        let own = tile.own_rows();
        let deltas = tile.part.crossings().zip(x);
        let delta = deltas.map(|(crossing, x)| crossing.from_low(x.to_f64())).collect();
        let Part { piece, first, .. } = tile.part;
        Ok(Solved { piece, first, delta, own })
    }

    /// The start of all vertices of a tile that are free; the others stay.
    fn blurred<R: Real>(&self, tile: &Tile, x: &[R]) -> Result<Vec<R>, Error> {
        let grid = self.surface.grid();
        let spacing = grid.spacing().map(|h| h / grid.min_spacing());
        let bounds = self.settings.bounds();
        let blurred = start::positions(&tile.part.piece, &Start::Blur, spacing, bounds)?;
        let starts = tile.is_fixed().into_iter().zip(x).zip(blurred);
        let start = |((is_fixed, x), blurred): ((bool, &R), f32)| {
            if is_fixed { *x } else { R::from_f64(f64::from(blurred).clamp(bounds[0], bounds[1])) }
        };
        Ok(starts.map(start).collect())
    }

    fn conditions<'b>(&'b self, energy: &'b Energy) -> Conditions<'b> {
        let conditions = Conditions::new(self.surface, self.settings, energy, self.flatness);
        Conditions { mean_energy: Some(self.mean_energy), ..conditions }
    }
}

/// The positions of a tile's vertices.
fn positions<R: Real>(tile: &Tile, delta: &[f64]) -> Vec<R> {
    let deltas = tile.read(delta, 0.5);
    let positions = tile.part.crossings().zip(deltas);
    positions.map(|(crossing, delta)| R::from_f64(crossing.from_low(delta))).collect()
}

/// Where the passes lead.
fn relax<R: Real>(tile: &Tile, conditions: &Conditions, passes: Passes, mut x: Vec<R>) -> Vec<R> {
    let (tolerance, mut left) = match passes {
        Passes::Fixed(passes) => {
            return visit(tile, conditions, passes, 0.0, x, None).x;
        }
        Passes::UntilConverged { tolerance, most_steps } => (tolerance, most_steps),
    };
    loop {
        let steps = &STEPS[..STEPS.len().min(left)];
        let found = visit(tile, conditions, &[steps], tolerance, x, None);
        let made: usize = found.energies.iter().map(|energies| energies.len() - 1).sum();
        let first_move = (found.first_move / found.x.len().max(1) as f64).sqrt();
        let is_done = found.stationarity.step_rms() <= tolerance && first_move <= tolerance;
        left -= made;
        x = found.x;
        if is_done || made == 0 || left == 0 {
            return x;
        }
    }
}
