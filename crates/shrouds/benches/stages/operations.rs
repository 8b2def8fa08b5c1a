//! Operations on volumes; the throughput is in lattice points.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use shrouds::volume::{Border, FaceRule, Interpolation, phantom};

pub(crate) fn operations(criterion: &mut Criterion) {
    for size in super::chosen_sizes().unwrap_or_else(|| vec![128]) {
        let volume = phantom::linked_tori(size).expect("a phantom of this size");
        let gyroid = phantom::gyroid(size).expect("a phantom of this size");
        let finer = gyroid.grid().spacing().map(|h| 0.8 * h);
        let finer = gyroid.grid().with_spacing(finer).expect("a lattice of this spacing");
        let mut group = criterion.benchmark_group("operation");
        group.throughput(Throughput::Elements(volume.grid().point_count() as u64));
        for (shape, volume) in [("tori", &volume), ("gyroid", &gyroid)] {
            for steps in [2.5, 20.0] {
                let by = steps * volume.grid().min_spacing();
                group.bench_function(format!("grow{steps}/{shape}{size}"), |bencher| {
                    bencher.iter(|| black_box(volume).offset(by, Border::Closed));
                });
            }
            group.bench_function(format!("components/{shape}{size}"), |bencher| {
                bencher.iter(|| black_box(volume).components(FaceRule::Separate));
            });
        }
        group.bench_function(format!("resample/gyroid{size}"), |bencher| {
            bencher.iter(|| black_box(&gyroid).resample(&finer, Interpolation::Linear));
        });
        group.finish();
    }
}
