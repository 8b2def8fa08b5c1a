//! Topology and bit planes of phantoms, packed and unpacked in memory: `cargo bench -p shrouds-codec`.
//!
//! The throughput of topology is in voxels, that of planes in vertices, all planes of each.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shrouds::volume::phantom::named;
use shrouds::{Settings as ShroudSettings, shroud};
use shrouds_codec::geometry::{decode, encode};
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

fn planes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("planes");
    for (name, size) in [("ball", 128), ("gyroid", 128)] {
        let volume = named(name, size).expect("a phantom of this size").volume;
        let shroud = shroud(&volume, &ShroudSettings::default()).expect("it has a shroud");
        group.throughput(Throughput::Elements(shroud.delta.len() as u64));
        for count in [1, 2, 8] {
            let coded = || encode(&shroud.surface, &shroud.delta, count).expect("they are coded");
            let planes = coded();
            let payloads: Vec<(&[u8], u32)> =
                planes.payloads.iter().map(|(payload, sum)| (&payload[..], *sum)).collect();
            group.bench_function(format!("code {count} {name}{size}"), |b| b.iter(coded));
            group.bench_function(format!("decode {count} {name}{size}"), |b| {
                b.iter(|| decode(&shroud.surface, &planes.settings, &payloads));
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
    targets = topology, planes
}
criterion_main!(all);
