//! A target that goes its way, and is heard with errors, is where the regions say it can be.

use shrouds::containment::{Contact, Membership, Path, Scene, Sea, Track};
use shrouds::optimize::Preset;
use shrouds::voxelize::Rule;
use shrouds::{Grid, Settings, shroud, voxelize};

use crate::generator::{HALF, Random, sea, track};
use crate::tracer;

/// Fastest way of the target, in m/s.
const SPEED: f64 = 2.0;

/// A scene, and where the target is at every contact.
struct Told {
    scene: Scene,
    places: Vec<[f64; 3]>,
}

/// A random scene with contacts simulated from a target, which goes from lattice point to lattice point or
/// anywhere.
fn told(seed: u64, on_lattice: bool) -> Told {
    let random = &mut Random::new(seed);
    let sea = sea(random, seed as usize % 4, seed as usize / 4 % 3);
    let track = track(random);
    let start = [random.between(-2000.0, 2000.0), random.between(-2000.0, 2000.0), -700.0];
    let mut place = snapped(&sea, start, on_lattice);
    let (mut contacts, mut places) = (Vec::new(), Vec::new());
    let mut time = 0.0;
    for _ in 0..5 {
        let later = time + random.between(60.0, 250.0);
        place = moved(random, &sea, place, SPEED * (later - time), on_lattice);
        time = later;
        if let Some(contact) = contact(random, &sea, &track, time, place) {
            contacts.push(contact);
            places.push(place);
        }
    }
    assert!(contacts.len() > 1, "{seed}: {} contacts", contacts.len());
    Told { scene: Scene::new(sea, track, contacts, SPEED).unwrap(), places }
}

fn contact(
    random: &mut Random,
    sea: &Sea,
    track: &Track,
    time: f64,
    place: [f64; 3],
) -> Option<Contact> {
    let array = track.at(time).unwrap();
    let first = random.below(2);
    let (path, angles) = [0, 1].into_iter().find_map(|n| {
        let path = [Path::Direct, Path::Bounce][(first + n) % 2];
        let angles = tracer::angles(sea, &array, place, path);
        (!angles.is_empty()).then_some((path, angles))
    })?;
    let angle = angles[random.below(angles.len())];
    let half_width = random.between(0.5, 6.0);
    let error = random.between(-0.999, 0.999) * half_width;
    let path = if random.below(4) == 0 { Path::Either } else { path };
    let bearing = (angle + error).clamp(0.0, 180.0);
    Some(Contact { time, bearing, half_width, path, range: None })
}

/// Another place in the sea that is so near.
fn moved(
    random: &mut Random,
    sea: &Sea,
    from: [f64; 3],
    distance: f64,
    on_lattice: bool,
) -> [f64; 3] {
    loop {
        let to = from.map(|x| x + random.between(-distance, distance));
        let to = snapped(sea, to, on_lattice);
        let square = (0..3).map(|d| (to[d] - from[d]).powi(2)).sum::<f64>();
        let floor = sea.floor().depth([to[0], to[1]]);
        let in_sea = to[0].abs() < HALF - 200.0 && to[1].abs() < HALF - 200.0;
        if square <= distance * distance && in_sea && to[2] < -1.0 && to[2] > 1.0 - floor {
            return to;
        }
    }
}

fn snapped(sea: &Sea, place: [f64; 3], on_lattice: bool) -> [f64; 3] {
    if on_lattice { sea.grid().point(nearest(sea, place).map(|n| n as f64)) } else { place }
}

fn nearest(sea: &Sea, place: [f64; 3]) -> [usize; 3] {
    let inverse = sea.grid().inverse_affine();
    inverse.map(|row| {
        let index = row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3];
        index.round() as usize
    })
}

/// Whether a point is within a closed mesh.
fn is_within(mesh: &shrouds::TriMesh, [x, y, z]: [f64; 3]) -> bool {
    let affine = [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]];
    let point = Grid::with_affine([1; 3], affine).unwrap();
    voxelize(mesh, &point, Rule::NonZero).unwrap().volume.count() == 1
}

#[test]
fn a_target_on_lattice_points_never_leaves_the_region() {
    for seed in 0..100 {
        let Told { scene, places } = told(seed, true);
        let steps: Vec<_> = scene.steps(Membership::Centre).map(Result::unwrap).collect();
        assert_eq!(steps.len(), places.len(), "{seed}: a region is empty");
        for (n, (step, place)) in steps.iter().zip(&places).enumerate() {
            let at = nearest(scene.sea(), *place);
            let contact = scene.contacts()[n];
            assert!(
                step.region.get(at),
                "{seed}: contact {n}, {contact:?}, {:?}",
                scene.sea().floor()
            );
            assert!(step.region.count() <= step.grown, "{seed}: contact {n}");
        }
    }
}

#[test]
fn a_target_anywhere_never_leaves_the_one_sided_region_nor_its_shroud() {
    let mut settings = Settings::default();
    settings.optimize.preset = Preset::Fast;
    for seed in 100..200 {
        let Told { scene, places } = told(seed, false);
        let steps: Vec<_> = scene.steps(Membership::Cell).map(Result::unwrap).collect();
        assert_eq!(steps.len(), places.len(), "{seed}: a region is empty");
        for (n, (step, place)) in steps.iter().zip(&places).enumerate() {
            let at = nearest(scene.sea(), *place);
            assert!(step.region.get(at), "{seed}: contact {n} of {:?}", scene.contacts()[n]);
            if seed % 5 == 0 {
                let surface = shroud(&step.enclosing().unwrap(), &settings).unwrap();
                assert!(is_within(&surface.mesh, *place), "{seed}: shroud of contact {n}");
            }
        }
    }
}
