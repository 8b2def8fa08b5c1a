//! Where the crossings start.

use crate::materials::interfaces::Interfaces;
use crate::optimize::Start;
use crate::parallel;
use crate::random::uniform;
use crate::surface::Crossing;

/// Weights of a lattice point, its neighbours and theirs along an axis.
const WEIGHTS: [i32; 5] = [1, 4, 6, 4, 1];
const REACH: usize = 2;
/// Places along x that are looked at together: those around both ends of a grid edge, and more.
const WINDOW: usize = 8;

/// Positions of the crossings along their grid edges, from the low end, within the bounds.
pub(super) fn positions(interfaces: &Interfaces, start: &Start, bounds: [f64; 2]) -> Vec<f32> {
    let crossings = interfaces.crossings();
    let mut x = vec![0.5; crossings.len()];
    match *start {
        // What is given is refused before.
        Start::Midpoint | Start::Given(_) => {}
        Start::Blur => parallel::fill(&mut x, |v| blur(interfaces, v)),
        Start::Inside => parallel::fill(&mut x, |v| crossings[v].from_low(1.0) as f32),
        Start::Outside => parallel::fill(&mut x, |v| crossings[v].from_low(0.0) as f32),
        Start::Random(seed) => parallel::fill(&mut x, |v| uniform(seed, v as u64) as f32),
    }
    let [low, high] = bounds.map(|bound| bound as f32);
    x.iter_mut().for_each(|x| *x = x.clamp(low, high));
    x
}

/// Where both labels of a crossing, blurred by about a voxel, are as strong as each other.
fn blur(interfaces: &Interfaces, v: usize) -> f32 {
    let crossing = interfaces.crossings()[v];
    let [low, high] = balances(interfaces, crossing).map(|balance| balance as f32);
    // If they would be so far away, a thin part has blurred away.
    const FAR: f32 = 0.5;
    let passing = low / (low - high);
    if (-FAR..=1.0 + FAR).contains(&passing) { passing.clamp(0.04, 0.96) } else { 0.5 }
}

/// By how much the first label outweighs the second around both ends of a crossing's grid edge.
fn balances(interfaces: &Interfaces, crossing: Crossing) -> [i32; 2] {
    let labels = interfaces.labels();
    let (dims, strides, ranks) = (labels.grid().dims(), labels.strides(), labels.ranks());
    let (low, pair) = (crossing.low(), interfaces.labels_at(crossing));
    let step = |axis: usize| usize::from(axis == crossing.axis());
    // Sums over rows for each of eight places along x, seen from both ends.
    let mut sums = [[0; WINDOW]; 2];
    for z in 0..WEIGHTS.len() + step(2) {
        for y in 0..WEIGHTS.len() + step(1) {
            let at = [low[0].wrapping_sub(REACH), low[1] + y, low[2] + z];
            let [_, j, k] = at.map(|index| index.wrapping_sub(REACH));
            if j >= dims[1] || k >= dims[2] {
                continue;
            }
            let row = j * strides[1] + k * strides[2];
            let row = window(&ranks[row..row + dims[0]], at[0]);
            for (end, sums) in sums.iter_mut().enumerate() {
                let weight = weight(y, end * step(1)) * weight(z, end * step(2));
                for (sum, rank) in sums.iter_mut().zip(row) {
                    *sum += if rank == pair[0] { weight } else { 0 };
                    *sum -= if rank == pair[1] { weight } else { 0 };
                }
            }
        }
    }
    [0, 1].map(|end| (0..WINDOW).map(|n| weight(n, end * step(0)) * sums[end][n]).sum())
}

/// The weight of place `n` of a window, for a point this many places beyond the one it is around.
#[inline(always)]
fn weight(n: usize, shift: usize) -> i32 {
    WEIGHTS.get(n.wrapping_sub(shift)).copied().unwrap_or_default()
}

/// Eight ranks of a row from a place on, which may lie before it. What is not there has none.
#[inline(always)]
fn window(row: &[u32], first: usize) -> [u32; WINDOW] {
    match row.get(first..first.wrapping_add(WINDOW)) {
        Some(found) => std::array::from_fn(|n| found[n]),
        None => {
            std::array::from_fn(|n| row.get(first.wrapping_add(n)).copied().unwrap_or(u32::MAX))
        }
    }
}
