//! A step of a containment scene: the region grows, loses what the contact excludes, and gets its shroud. The throughput
//! is in lattice points.

use criterion::{Criterion, Throughput};
use shrouds::containment::{
    Contact, Floor, Membership, Path, Scene, Sea, SoundSpeed, Terrain, Track, Waypoint,
};
use shrouds::{Error, Grid, Settings, shroud};

use crate::presets::presets;

/// Half the side of the sea and its depth, in metres.
const HALF: f64 = 6000.0;
const DEPTH: f64 = 3000.0;

/// Both contacts of a scene, broadside over a level floor and over a rough one, with the fastest preset.
pub(crate) fn steps(criterion: &mut Criterion) {
    let (_, settings) = presets().swap_remove(0);
    for size in super::chosen_sizes().unwrap_or_else(|| vec![128]) {
        let mut group = criterion.benchmark_group("contain");
        group.throughput(Throughput::Elements(size.pow(3) as u64));
        for is_rough in [false, true] {
            let scene = scene(size, is_rough).expect("a scene that makes sense");
            let name = format!("{}{size}", if is_rough { "rough" } else { "level" });
            group.bench_function(name, |bencher| bencher.iter(|| run(&scene, &settings)));
        }
        group.finish();
    }
}

/// Both steps; returns the number of vertices.
fn run(scene: &Scene, settings: &Settings) -> usize {
    let regions = scene.steps(Membership::Centre).map(|step| step.expect("a step").region);
    regions.map(|region| shroud(&region, settings).expect("a shroud").delta.len()).sum()
}

fn scene(size: usize, is_rough: bool) -> Result<Scene, Error> {
    let (step, height) = (2.0 * HALF / (size - 1) as f64, DEPTH / (size - 1) as f64);
    let affine = [[step, 0.0, 0.0, -HALF], [0.0, step, 0.0, -HALF], [0.0, 0.0, height, -DEPTH]];
    let grid = Grid::with_affine([size; 3], affine)?;
    let (mut floor, mut sound) = (Floor::flat(2400.0), SoundSpeed::constant(1500.0)?);
    if is_rough {
        let (depth, relief, longest, shortest, seed) = (2400.0, 500.0, 6000.0, 500.0, 7);
        let terrain = Terrain { depth, relief, longest, shortest, seed };
        floor = terrain.floor([[-HALF; 2], [HALF; 2]])?;
        sound = SoundSpeed::profile(&[[0.0, 1525.0], [300.0, 1500.0], [3000.0, 1515.0]])?;
    }
    let waypoint = |time, x| Waypoint { time, position: [x, -3000.0], depth: 150.0, course: None };
    let track = Track::new(vec![waypoint(0.0, -4000.0), waypoint(300.0, -3200.0)])?;
    let contact =
        |time| Contact { time, bearing: 70.0, half_width: 3.0, path: Path::Bounce, range: None };
    Scene::new(Sea::new(grid, floor, sound)?, track, vec![contact(0.0), contact(300.0)], 2.5)
}
