//! Each stage by itself, on phantoms: `cargo bench -p shrouds`, then perhaps a filter such as
//! `-- surface` or `-- solve/default/sphere128`.
//!
//! `SHROUDS_BENCH_SIZES=256,512` takes these sizes instead of 64 and 128. Threads are as many as the
//! machine has; `RAYON_NUM_THREADS=1` gives the time of one.

mod operations;
mod presets;

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::network::Network;
use shrouds::optimize::optimize;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::voxelize::Rule;
use shrouds::{Error, Occupancy, Select, TriMesh, voxelize};

use presets::presets;

/// A phantom with what each stage takes.
struct Case {
    name: String,
    volume: Occupancy,
    values: Vec<u8>,
    surface: Surface,
    network: Network,
}

fn cases() -> impl Iterator<Item = Case> {
    type Make = fn(usize) -> Result<Occupancy, Error>;
    // A gyroid of 128³ has eight times the vertices of the others.
    const SHAPES: [(&str, Make, &[usize]); 3] = [
        ("sphere", phantom::sphere, &[64, 128]),
        ("tori", phantom::linked_tori, &[64, 128]),
        ("gyroid", phantom::gyroid, &[64]),
    ];
    let chosen = chosen_sizes();
    SHAPES.into_iter().flat_map(move |(shape, make, usual)| {
        let sizes = chosen.clone().unwrap_or_else(|| usual.to_vec());
        sizes.into_iter().map(move |size| {
            let volume = make(size).expect("a phantom of this size");
            Case::new(format!("{shape}{size}"), volume)
        })
    })
}

pub(crate) fn chosen_sizes() -> Option<Vec<usize>> {
    let chosen = std::env::var("SHROUDS_BENCH_SIZES").ok()?;
    let sizes: Result<_, _> = chosen.split(',').map(|size| size.trim().parse()).collect();
    Some(sizes.expect("SHROUDS_BENCH_SIZES: whole numbers with commas between"))
}

impl Case {
    fn new(name: String, volume: Occupancy) -> Self {
        let [nx, ny, nz] = volume.grid().dims();
        let mut values = Vec::with_capacity(nx * ny * nz);
        for (j, k) in (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))) {
            let row = volume.row(j, k);
            values.extend((0..nx).map(|i| (row[i / 64] >> (i % 64) & 1) as u8));
        }
        let surface = extract(&volume);
        let network = Network::trace(&surface);
        Self { name, volume, values, surface, network }
    }
}

fn extract(volume: &Occupancy) -> Surface {
    Surface::extract(volume, FaceRule::default(), Border::default()).expect("a phantom fits")
}

fn stages(criterion: &mut Criterion) {
    for case in cases() {
        before_the_optimum(criterion, &case);
        from_the_network_on(criterion, &case);
        back_to_voxels(criterion, &case);
    }
}

/// Work that begins with voxels; the throughput is theirs.
fn before_the_optimum(criterion: &mut Criterion, case: &Case) {
    let Case { name, volume, values, surface, .. } = case;
    let voxels = Throughput::Elements(values.len() as u64);
    let mut group = criterion.benchmark_group("bits");
    group.throughput(voxels.clone()).bench_function(name, |bencher| {
        bencher.iter(|| {
            let grid = volume.grid().clone();
            Occupancy::from_values(grid, black_box(values), &Select::NonZero)
        });
    });
    group.finish();
    let mut group = criterion.benchmark_group("surface");
    group.throughput(voxels).bench_function(name, |bencher| {
        bencher.iter(|| extract(black_box(volume)));
    });
    group.finish();
    let mut group = criterion.benchmark_group("network");
    group.throughput(Throughput::Elements(surface.vertex_count() as u64));
    group.bench_function(name, |bencher| bencher.iter(|| Network::trace(black_box(surface))));
    group.finish();
}

/// Work on vertices; the throughput is theirs.
fn from_the_network_on(criterion: &mut Criterion, case: &Case) {
    let Case { name, surface, network, .. } = case;
    let vertices = Throughput::Elements(surface.vertex_count() as u64);
    for (preset, settings) in presets() {
        let mut group = criterion.benchmark_group(format!("solve/{preset}"));
        group.throughput(vertices.clone()).bench_function(name, |bencher| {
            let settings = &settings.optimize;
            bencher.iter(|| {
                optimize(black_box(surface), settings, &mut |_| ControlFlow::Continue(()))
            });
        });
        group.finish();
    }
    let mut group = criterion.benchmark_group("mesh");
    let delta = vec![0.5; surface.vertex_count()];
    for (kind, word) in [(MeshKind::Primal, "primal"), (MeshKind::Dual, "dual")] {
        group.throughput(vertices.clone()).bench_function(format!("{word}/{name}"), |bencher| {
            let fitted = Triangles::Fitted;
            bencher.iter(|| TriMesh::place(surface, network, black_box(&delta), kind, fitted));
        });
    }
    group.finish();
}

/// The mesh becomes the volume again, whole and with one of a hundred triangles missing; the throughput
/// is that of triangles.
fn back_to_voxels(criterion: &mut Criterion, case: &Case) {
    let Case { name, volume, surface, .. } = case;
    let whole = TriMesh::midpoint(surface);
    let mut broken = whole.clone();
    let mut number = 0;
    broken.triangles.retain(|_| {
        number += 1;
        number % 100 != 0
    });
    let mut group = criterion.benchmark_group("voxelize");
    group.throughput(Throughput::Elements(whole.triangles.len() as u64));
    for (kind, mesh) in [("closed", &whole), ("holes", &broken)] {
        group.bench_function(format!("{kind}/{name}"), |bencher| {
            bencher.iter(|| voxelize(black_box(mesh), volume.grid(), Rule::NonZero));
        });
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = stages, operations::operations
}
criterion_main!(all);
