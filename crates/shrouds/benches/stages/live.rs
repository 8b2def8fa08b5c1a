//! Updates of a live shroud; the throughput is in vertices of the whole surface.

use std::ops::Range;

use criterion::{BatchSize, Criterion, Throughput};
use shrouds::volume::phantom;
use shrouds::{LiveShroud, Occupancy};

use crate::presets::presets;

const RADIUS: usize = 5;

/// A ball is added to the surface of a sphere and taken away again, and the mesh made where that changes it.
pub(crate) fn updates(criterion: &mut Criterion) {
    for size in super::chosen_sizes().unwrap_or_else(|| vec![128]) {
        let volume = phantom::sphere(size).expect("a phantom of this size");
        for (preset, settings) in presets() {
            let mut live = LiveShroud::new(&volume, &settings).expect("settings for live shrouds");
            let vertex = live.delta().len() as u32 / 3;
            let centre = live.surface().crossing(vertex).inside().map(|x| x - 1);
            let (region, with_ball) = with_ball(&volume, centre);
            let volumes = [&with_ball, &volume];
            let mut turn = 0;
            let mut group = criterion.benchmark_group(format!("update/{preset}"));
            group.throughput(Throughput::Elements(live.delta().len() as u64));
            group.bench_function(format!("sphere{size}"), |bencher| {
                let next = || {
                    turn += 1;
                    volumes[(turn - 1) % 2]
                };
                let update = |volume: &Occupancy| {
                    let change = live.update(volume, region.clone()).expect("a region within");
                    change.cells.into_iter().map(|cells| live.mesh(cells)).collect::<Vec<_>>()
                };
                bencher.iter_batched(next, update, BatchSize::PerIteration);
            });
            group.finish();
        }
    }
}

/// The volume with a ball, and the box that holds it.
fn with_ball(volume: &Occupancy, centre: [usize; 3]) -> ([Range<usize>; 3], Occupancy) {
    let mut volume = volume.clone();
    let dims = volume.grid().dims();
    let region: [_; 3] = std::array::from_fn(|d| {
        centre[d].saturating_sub(RADIUS)..dims[d].min(centre[d] + RADIUS + 1)
    });
    for k in region[2].clone() {
        for (i, j) in region[1].clone().flat_map(|j| region[0].clone().map(move |i| (i, j))) {
            let point = [i, j, k];
            let square: usize = (0..3).map(|d| point[d].abs_diff(centre[d]).pow(2)).sum();
            if square <= RADIUS * RADIUS {
                volume.set([i, j, k], true);
            }
        }
    }
    (region, volume)
}
