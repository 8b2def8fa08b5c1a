//! What one step does to a region.

use proptest::prelude::*;
use shrouds::containment::{Contact, Extent, Membership, Path, Scene, Step};
use shrouds::optimize::{Preset, Start};
use shrouds::volume::Operation;
use shrouds::voxelize::Rule;
use shrouds::{Occupancy, Settings, shroud, voxelize};

use crate::generator::{Random, sea, track};

fn scene(seed: u64, speed: f64, contacts: usize) -> Scene {
    let random = &mut Random::new(seed);
    let (floor, water) = (random.below(4), random.below(3));
    let sea = sea(random, floor, water);
    let track = track(random);
    let contacts = (0..contacts).map(|n| Contact {
        time: 200.0 * n as f64,
        bearing: random.between(30.0, 150.0),
        half_width: random.between(10.0, 40.0),
        path: [Path::Direct, Path::Bounce, Path::Either][random.below(3)],
        range: None,
    });
    Scene::new(sea, track, contacts.collect(), speed).unwrap()
}

fn steps(scene: &Scene, membership: Membership) -> Vec<Step> {
    scene.steps(membership).map(Result::unwrap).collect()
}

fn is_part(a: &Occupancy, b: &Occupancy) -> bool {
    a.combine(Operation::Subtract, b).unwrap().count() == 0
}

/// Every lattice point so near to a point of a region that a target can get there.
fn reached(scene: &Scene, region: &Occupancy, distance: f64, between_cells: bool) -> Occupancy {
    let grid = region.grid();
    let [nx, ny, _] = grid.dims();
    let spacing = grid.spacing();
    let points: Vec<[usize; 3]> = (0..grid.point_count())
        .map(|n| [n % nx, n / nx % ny, n / nx / ny])
        .filter(|index| region.get(*index))
        .collect();
    let water = scene.sea().water(membership(between_cells));
    Occupancy::from_fn(grid.clone(), |index| {
        water.get(index)
            && points.iter().any(|point| {
                let square = (0..3).map(|d| {
                    let steps = index[d].abs_diff(point[d]) as f64;
                    let steps = if between_cells { (steps - 1.0).max(0.0) } else { steps };
                    (steps * spacing[d]).powi(2)
                });
                square.sum::<f64>() <= distance * distance * (1.0 + 1e-6)
            })
    })
}

fn membership(cells: bool) -> Membership {
    if cells { Membership::Cell } else { Membership::Centre }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_intersection_makes_a_region_grow(seed: u64, speed in 0.0..4.0, cells: bool) {
        let scene = scene(seed, speed, 5);
        let steps = steps(&scene, membership(cells));
        let water = scene.sea().water(membership(cells));
        for (n, step) in steps.iter().enumerate() {
            prop_assert!(step.region.count() <= step.grown);
            prop_assert!(is_part(&step.region, &water));
            prop_assert!(!step.is_empty() || n + 1 == steps.len());
            if speed == 0.0 && n > 0 {
                prop_assert!(is_part(&step.region, &steps[n - 1].region));
            }
        }
    }

    #[test]
    fn the_one_sided_region_holds_the_other(seed: u64, speed in 0.0..4.0) {
        let scene = scene(seed, speed, 4);
        let (centre, cell) = (steps(&scene, Membership::Centre), steps(&scene, Membership::Cell));
        for (centre, cell) in centre.iter().zip(&cell) {
            prop_assert!(is_part(&centre.region, &cell.region));
        }
    }
}

#[test]
fn a_region_at_rest_only_loses() {
    for cells in [false, true] {
        let steps = steps(&scene(5, 0.0, 5), membership(cells));
        assert!(steps.len() > 1);
        assert!(steps.windows(2).all(|pair| is_part(&pair[1].region, &pair[0].region)));
    }
}

#[test]
fn growth_reaches_what_the_target_can_reach_and_no_more() {
    for (seed, cells) in [(11, false), (11, true), (12, false), (12, true)] {
        let mut contacts = scene(seed, 1.7, 1).contacts().to_vec();
        contacts[0].half_width = 2.0;
        contacts.push(Contact { time: 150.0, bearing: 90.0, half_width: 180.0, ..contacts[0] });
        contacts[1].path = Path::Either;
        let all = scene(seed, 1.7, 1);
        let scene = Scene::new(all.sea().clone(), all.track().clone(), contacts, 1.7).unwrap();
        let steps = steps(&scene, membership(cells));
        let expected = reached(&scene, &steps[0].region, 1.7 * 150.0, cells);
        assert_eq!(steps[1].grown, expected.count(), "{seed} {cells}");
        assert!(steps[1].grown > steps[0].region.count() && !steps[0].is_empty());
    }
}

#[test]
fn a_contradiction_empties_the_region_and_ends_the_steps() {
    let scene = scene(21, 1.0, 1);
    let first =
        Contact { bearing: 20.0, half_width: 5.0, path: Path::Direct, ..scene.contacts()[0] };
    let second = Contact { time: 1.0, bearing: 160.0, ..first };
    let contacts = vec![first, second, Contact { time: 2.0, ..first }];
    let scene = Scene::new(scene.sea().clone(), scene.track().clone(), contacts, 1.0).unwrap();
    // The cells around the array are heard at every bearing; the points are not.
    let steps = steps(&scene, Membership::Centre);
    assert_eq!(steps.iter().map(Step::is_empty).collect::<Vec<_>>(), [false, true]);
    assert_eq!(steps[1].contact, 1);
    assert_eq!(Extent::of(&steps[1].region), None);
}

#[test]
fn a_shroud_of_the_enclosing_volume_contains_every_cell() {
    let scene = scene(31, 1.5, 2);
    let step = steps(&scene, Membership::Cell).remove(1);
    let volume = step.enclosing().unwrap();
    let grid = step.region.grid();
    let [nx, ny, nz] = grid.dims();
    for start in [Start::Blur, Start::Inside, Start::Random(3)] {
        let mut settings = Settings::default();
        settings.optimize.preset = Preset::Fast;
        // As it starts: vertices anywhere.
        settings.optimize.max_iterations = (start != Start::Blur).then_some(0);
        settings.optimize.start = start.clone();
        let surface = shroud(&volume, &settings).unwrap();
        // The corners of all cells make a lattice, half a step away from that of the region.
        let mut affine = grid.affine();
        affine.iter_mut().for_each(|row| row[3] -= 0.5 * (row[0] + row[1] + row[2]));
        let corners = shrouds::Grid::with_affine([nx + 1, ny + 1, nz + 1], affine).unwrap();
        let within = voxelize(&surface.mesh, &corners, Rule::NonZero).unwrap().volume;
        for n in 0..grid.point_count() {
            let [i, j, k] = [n % nx, n / nx % ny, n / nx / ny];
            let all = (0..8).all(|c| within.get([i + c % 2, j + c / 2 % 2, k + c / 4]));
            assert!(all || !step.region.get([i, j, k]), "{start:?} {i} {j} {k}");
        }
    }
}

#[test]
fn the_same_bits_on_one_thread_and_on_three() {
    let scene = scene(41, 1.5, 3);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| steps(&scene, Membership::Cell).pop().unwrap().region)
    };
    assert_eq!(on(1), on(3));
}
