//! Where the vertices start.

use crate::optimize::settings::Start;
use crate::parallel;
use crate::random::uniform;
use crate::surface::Surface;
use crate::volume::{Border, Occupancy};

/// Positions from the low end of every grid edge, in [0, 1].
pub(super) fn positions(volume: &Occupancy, surface: &Surface, start: &Start) -> Vec<f64> {
    let mut x = vec![0.5; surface.vertex_count()];
    match *start {
        Start::Midpoint => {}
        Start::Blur => blur(volume, surface, &mut x),
        Start::Random(seed) => parallel::fill(&mut x, |v| uniform(seed, v as u64)),
    }
    x
}

/// Weights of the binomial filter: a blur by one voxel (variance 1) that stays in integers.
const BINOMIAL: [u32; 5] = [1, 4, 6, 4, 1];

/// Where the occupancy, blurred by one voxel along every axis, passes one half on the way from one
/// end of the grid edge to the other.
fn blur(volume: &Occupancy, surface: &Surface, x: &mut [f64]) {
    // The surface's lattice has one more layer than the volume when the border is closed.
    let margin = isize::from(surface.border() == Border::Closed);
    let window_sums: [u32; 32] =
        std::array::from_fn(|bits| (0..5).map(|n| BINOMIAL[n] * (bits >> n & 1) as u32).sum());
    let blurred = |point: [usize; 3]| {
        let [i, j, k] = point.map(|p| p as isize - margin);
        let mut sum = 0;
        for (b, weight_b) in BINOMIAL.iter().enumerate() {
            for (a, weight_a) in BINOMIAL.iter().enumerate() {
                let rows = [j + a as isize - 2, k + b as isize - 2];
                let bits = window(volume, surface.border(), i - 2, rows);
                sum += weight_a * weight_b * window_sums[bits];
            }
        }
        // Half of the sum of all weights, 16³, is the threshold.
        f64::from(sum) - 2048.0
    };
    let crossings: Vec<_> = surface.crossings().collect();
    parallel::fill(x, |v| {
        let crossing = crossings[v];
        let mut high = crossing.low();
        high[crossing.axis()] += 1;
        let (a, b) = (blurred(crossing.low()), blurred(high));
        // A thin part may blur away: then the crossing of the line lies beyond an end.
        if a == b { 0.5 } else { (a / (a - b)).clamp(0.02, 0.98) }
    });
}

/// Five bits of row `(j, k)` from index `i` on. Beyond a closed border all is outside; beyond an
/// open one the last points are repeated.
fn window(volume: &Occupancy, border: Border, i: isize, [j, k]: [isize; 2]) -> usize {
    let dims = volume.grid().dims().map(|n| n as isize);
    let within = |p: isize, axis: usize| (0..dims[axis]).contains(&p);
    if border == Border::Closed && !(within(j, 1) && within(k, 2)) {
        return 0;
    }
    let row = volume.row(j.clamp(0, dims[1] - 1) as usize, k.clamp(0, dims[2] - 1) as usize);
    (0..5).fold(0, |bits, n| {
        let p = i + n;
        let inside = match border {
            Border::Closed if !within(p, 0) => 0,
            _ => {
                let p = p.clamp(0, dims[0] - 1) as usize;
                row[p / 64] >> (p % 64) & 1
            }
        };
        bits | (inside as usize) << n
    })
}
