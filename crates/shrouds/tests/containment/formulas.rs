//! A level floor and water of constant speed: the region is the cone and its mirror image.

use shrouds::Occupancy;
use shrouds::containment::{Array, Contact, Floor, Membership, Path, Scene, Sea, SoundSpeed};

use crate::generator::{Random, lattice, track};

/// Whether a point is heard: by the angle between the axis and the direction to it or to its image.
fn is_heard(array: &Array, contact: &Contact, floor: f64, point: [f64; 3]) -> bool {
    let angle_to = |z: f64| {
        let to = [point[0] - array.position[0], point[1] - array.position[1], z + array.depth];
        let along = to[0] * array.axis[0] + to[1] * array.axis[1];
        let length = to.iter().map(|x| x * x).sum::<f64>().sqrt();
        (along / length).acos().to_degrees()
    };
    let fits = |angle: f64| (angle - contact.bearing).abs() <= contact.half_width;
    let distance = (point[0] - array.position[0]).hypot(point[1] - array.position[1]);
    let direct = fits(angle_to(point[2]));
    let bounce = fits(angle_to(-2.0 * floor - point[2]));
    let in_range = contact.range.is_none_or(|[low, high]| (low..=high).contains(&distance));
    let heard = match contact.path {
        Path::Direct => direct,
        Path::Bounce => bounce,
        Path::Either => direct || bounce,
    };
    heard && in_range && point[2] <= 0.0 && point[2] >= -floor
}

fn case(random: &mut Random, n: usize) -> (Scene, f64) {
    let floor = random.between(1500.0, 2300.0);
    let grid = lattice([0, 1].map(|_| random.between(100.0, 190.0)), random.between(60.0, 120.0));
    let sound = SoundSpeed::constant(1480.0).unwrap();
    let sea = Sea::new(grid, Floor::flat(floor), sound).unwrap();
    let contact = Contact {
        time: random.between(0.0, 1800.0),
        bearing: [random.between(0.0, 180.0), 90.0, 0.0, 180.0][[0, 0, 0, 0, 1, 2, 3][n % 7]],
        half_width: random.between(1.0, 15.0),
        path: [Path::Direct, Path::Bounce, Path::Either][n % 3],
        range: n
            .is_multiple_of(4)
            .then(|| [random.between(0.0, 900.0), random.between(1000.0, 4000.0)]),
    };
    (Scene::new(sea, track(random), vec![contact], 4.0).unwrap(), floor)
}

#[test]
fn the_region_is_the_cone_and_its_mirror_image_point_by_point() {
    let random = &mut Random::new(1);
    let mut found = 0;
    for n in 0..84 {
        let (scene, floor) = case(random, n);
        let step = scene.steps(Membership::Centre).next().unwrap().unwrap();
        let grid = scene.sea().grid();
        let expected = Occupancy::from_fn(grid.clone(), |index| {
            let point = grid.point(index.map(|n| n as f64));
            is_heard(&step.array, &scene.contacts()[0], floor, point)
        });
        assert_eq!(step.region.count(), expected.count(), "{n}: {:?}", scene.contacts());
        assert_eq!(step.region, expected, "{n}: {:?}", scene.contacts());
        found += expected.count();
    }
    assert!(found > 100_000);
}

#[test]
fn the_one_sided_region_has_every_cell_with_a_point_of_the_cone_and_few_more() {
    let random = &mut Random::new(2);
    for n in 0..21 {
        let (scene, floor) = case(random, n);
        let step = scene.steps(Membership::Cell).next().unwrap().unwrap();
        let grid = scene.sea().grid();
        // So many places in the cell; or in a box three times as wide, where the annulus may be thinner
        // than they are far apart.
        let reaches = |index: [usize; 3], width: f64, more: f64| {
            let contact = scene.contacts()[0];
            let contact = Contact { half_width: contact.half_width + more, ..contact };
            (0..343).any(|m| {
                let part = [m % 7, m / 7 % 7, m / 49].map(|part| f64::from(part) / 6.0 - 0.5);
                let place = std::array::from_fn(|d| index[d] as f64 + width * part[d]);
                is_heard(&step.array, &contact, floor, grid.point(place))
            })
        };
        let [nx, ny, nz] = grid.dims();
        for m in (0..grid.point_count()).step_by(97) {
            let index = [m % nx, m / nx % ny, m / nx / ny % nz];
            let inside = step.region.get(index);
            assert!(inside || !reaches(index, 1.0, 0.0), "{n}: {index:?} is missing");
            assert!(!inside || reaches(index, 3.0, 1.5), "{n}: {index:?} is too much");
        }
    }
}
