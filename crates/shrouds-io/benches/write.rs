//! Mesh files, written to the folder for temporary files: `cargo bench -p shrouds-io`.
//!
//! The throughput is in bytes of the file.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shrouds::volume::phantom;
use shrouds::{Settings, optimize, shroud};
use shrouds_io::{MeshOptions, write_mesh};

fn write(criterion: &mut Criterion) {
    let volume = phantom::sphere(128).expect("a phantom of this size");
    // Where the vertices start: how well they lie does not change the size of the file.
    let start = optimize::Settings { max_iterations: Some(0), ..Default::default() };
    let settings = Settings { optimize: start, ..Settings::default() };
    let mesh = shroud(&volume, &settings).expect("a phantom has a shroud").mesh;
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let mut group = criterion.benchmark_group("write");
    for format in ["ply", "stl", "obj"] {
        let path = folder.path().join("mesh").with_extension(format);
        let write = || write_mesh(&path, &mesh, &MeshOptions::default()).expect("it is written");
        write();
        let size = path.metadata().expect("the file is there").len();
        group.throughput(Throughput::Bytes(size)).bench_function(format, |b| b.iter(write));
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = write
}
criterion_main!(all);
