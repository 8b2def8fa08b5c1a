//! What overlapping tiles find, put together.
//!
//! Two tiles know different surroundings, and where long waves pass from one to the other they find different
//! positions at the points where they meet. Taken from either, the surface would have a step there. So positions
//! go over from the ones to the others: a tile has a share in every vertex that it moves, which falls linearly
//! over the points that others move too, and the shares in a vertex have the sum one.

use crate::optimize::real::Real;
use crate::optimize::settings::Settings;
use crate::optimize::tile::{HALO, Tile, TilePoints};

/// The sum of the weights along an axis.
const WEIGHTS: usize = 4 * HALO;
/// Position 1 with all the weights of three axes. In whole units the order of adding does not matter.
const ONE: f64 = (1u32 << 31) as f64;

/// Adds a tile's share in the positions of all vertices.
pub(super) fn add<R: Real>(tile: &Tile, x: &[R], all: &mut [u32]) {
    let unit = ONE / WEIGHTS.pow(3) as f64;
    let share = |(low, x): ([usize; 3], &R)| {
        let weight: usize = (0..3).map(|d| weight(&tile.points, d, low[d])).product();
        (x.to_f64() * unit * weight as f64).round() as u32
    };
    let lows = tile.part.crossings().map(|crossing| crossing.low());
    let shares: Vec<u32> = lows.zip(x).map(share).collect();
    tile.part.for_each_row(&tile.points.free, |here, there| {
        all[there].iter_mut().zip(&shares[here]).for_each(|(all, share)| *all += share);
    });
}

/// The weight along an axis of a tile in vertices whose grid edges start at `point`, one that it moves.
fn weight(points: &TilePoints, axis: usize, point: usize) -> usize {
    let (own, free) = (&points.own[axis], &points.free[axis]);
    let mut weight = WEIGHTS;
    if !free.contains(&point) {
        return 0;
    }
    if free.start < own.start {
        weight = weight.min(2 * (point + HALO - own.start) + 1);
    }
    if own.end < free.end {
        weight = weight.min(2 * (own.end + HALO - point) - 1);
    }
    weight
}

/// Takes the positions that the shares of all tiles make together, within bounds.
pub(super) fn settle<R: Real>(shares: &[u32], bounds: [f64; 2], x: &mut [R]) {
    let new = shares.iter().map(|&share| R::from_f64(position(share, bounds)));
    x.iter_mut().zip(new).for_each(|(x, new)| *x = new);
}

fn position(share: u32, [low, high]: [f64; 2]) -> f64 {
    (f64::from(share) / ONE).clamp(low, high)
}

/// These positions.
pub(crate) fn positions(settings: &Settings, shares: &[u32]) -> Vec<f32> {
    let mut x = vec![0.0; shares.len()];
    settle(shares, settings.bounds(), &mut x);
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::optimize::tile::Tiling;
    use crate::surface::Surface;
    use crate::volume::{Border, FaceRule, Occupancy, phantom};

    #[test]
    fn shares_of_all_tiles_make_the_whole() {
        // Blocks cut into many tiles beside blocks that are one; and a block of two points at an end.
        let plates = |[i, _, k]: [usize; 3]| i / 2 % 2 == 0 && k < 150;
        let grid = Grid::new([300, 66, 200], [1.0; 3]).unwrap();
        let plates = Occupancy::from_fn(grid, plates);
        let rod = Occupancy::from_fn(Grid::new([129, 9, 9], [1.0; 3]).unwrap(), |_| true);
        for volume in [plates, rod, phantom::sphere(150).unwrap()] {
            let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
            let x: Vec<f32> = (0..surface.vertex_count()).map(|v| v as f32 * 0.618 % 1.0).collect();
            let tiles = Tiling::of(&surface).tiles(&surface, &surface.points());
            assert!(tiles.len() > 1);
            let mut shares = vec![0; x.len()];
            for points in tiles {
                let tile = Tile::cut(&surface, points);
                add(&tile, &tile.read(&x, f32::NAN), &mut shares);
            }
            for (share, &x) in shares.into_iter().zip(&x) {
                assert!((position(share, [0.0, 1.0]) - f64::from(x)).abs() < 2e-9);
            }
        }
    }
}
