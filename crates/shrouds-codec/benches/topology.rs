//! Topology of phantoms, packed and unpacked in memory: `cargo bench -p shrouds-codec`.
//!
//! The throughput is in voxels.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shrouds::volume::phantom::named;
use shrouds_codec::{Profile, Settings, pack, unpack};

fn topology(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("topology");
    for (name, size) in [("ball", 128), ("gyroid", 128)] {
        let volume = named(name, size).expect("a phantom of this size").volume;
        group.throughput(Throughput::Elements(volume.grid().point_count() as u64));
        for profile in [Profile::Fast, Profile::Dense] {
            let settings = Settings { profile, ..Settings::default() };
            let packed = || {
                let mut bytes = Vec::new();
                pack(&volume, &settings, &mut bytes).expect("it is packed");
                bytes
            };
            let bytes = packed();
            let title = |what: &str| format!("{what} {profile:?} {name}{size}").to_lowercase();
            group.bench_function(title("pack"), |b| b.iter(packed));
            group.bench_function(title("unpack"), |b| {
                b.iter(|| unpack(&bytes[..]).expect("it is unpacked"));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = topology
}
criterion_main!(all);
