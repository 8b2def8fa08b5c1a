//! Where the crossings start.

use crate::materials::interfaces::Interfaces;
use crate::optimize::Start;
use crate::parallel;
use crate::random::uniform;

/// Weights of a lattice point, its neighbours and theirs along an axis.
const WEIGHTS: [i32; 5] = [1, 4, 6, 4, 1];

/// Positions of the crossings along their grid edges, from the low end, within the bounds.
pub(super) fn positions(interfaces: &Interfaces, start: &Start, bounds: [f64; 2]) -> Vec<f64> {
    let crossings = interfaces.crossings();
    let mut x = vec![0.5; crossings.len()];
    match *start {
        // What is given is refused before.
        Start::Midpoint | Start::Given(_) => {}
        Start::Blur => parallel::fill(&mut x, |v| blur(interfaces, v)),
        Start::Inside => parallel::fill(&mut x, |v| crossings[v].from_low(1.0)),
        Start::Outside => parallel::fill(&mut x, |v| crossings[v].from_low(0.0)),
        Start::Random(seed) => parallel::fill(&mut x, |v| uniform(seed, v as u64)),
    }
    x.iter_mut().for_each(|x| *x = x.clamp(bounds[0], bounds[1]));
    x
}

/// Where both labels of a crossing, blurred by about a voxel, are as strong as each other.
fn blur(interfaces: &Interfaces, v: usize) -> f64 {
    let crossing = interfaces.crossings()[v];
    let mut high = crossing.low();
    high[crossing.axis()] += 1;
    let pair = interfaces.labels_at(crossing);
    let [low, high] = [crossing.low(), high].map(|point| balance(interfaces, point, pair));
    // If they would be so far away, a thin part has blurred away.
    const FAR: f64 = 0.5;
    let passing = low / (low - high);
    if (-FAR..=1.0 + FAR).contains(&passing) { passing.clamp(0.04, 0.96) } else { 0.5 }
}

/// By how much the first label outweighs the second around a lattice point.
fn balance(interfaces: &Interfaces, point: [usize; 3], [first, second]: [u32; 2]) -> f64 {
    let labels = interfaces.labels();
    let (dims, strides, ranks) = (labels.grid().dims(), labels.strides(), labels.ranks());
    let reach = |axis: usize| {
        let (low, high) = (point[axis].saturating_sub(2), (point[axis] + 2).min(dims[axis] - 1));
        (low..=high).map(move |n| (n * strides[axis], WEIGHTS[n + 2 - point[axis]]))
    };
    let mut sum = 0;
    for (z, of_z) in reach(2) {
        for (y, of_y) in reach(1) {
            let row: i32 = reach(0)
                .map(|(x, of_x)| {
                    let rank = ranks[x + y + z];
                    of_x * (i32::from(rank == first) - i32::from(rank == second))
                })
                .sum();
            sum += of_z * of_y * row;
        }
    }
    f64::from(sum)
}
