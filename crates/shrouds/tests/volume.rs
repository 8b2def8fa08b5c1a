//! Volume keeping: the mesh that comes out is measured anew and held against counted voxels.

#![allow(clippy::unwrap_used)]

mod common;

use common::volumes;
use proptest::prelude::*;
use shrouds::check::{CheckSettings, check};
use shrouds::energy::{Energy, Linear, Parameter};
use shrouds::mesh::MeshKind;
use shrouds::optimize::{Preset, Solver, Status, VolumeRule};
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Error, Grid, Occupancy, Settings, Shroud, TriMesh, shroud};

fn keep() -> Settings {
    let mut settings = Settings::default();
    settings.optimize.volume = VolumeRule::Keep;
    settings
}

fn keep_exactly() -> Settings {
    let mut settings = keep();
    settings.optimize.preset = Preset::Exact;
    settings
}

/// A volume of these lattice points.
fn inside(grid: &Grid, is_inside: impl Fn([usize; 3]) -> bool) -> Occupancy {
    let [nx, ny, _] = grid.dims();
    let points = (0..grid.point_count()).map(|n| [n % nx, n / nx % ny, n / (nx * ny)]);
    let bits: Vec<bool> = points.map(is_inside).collect();
    Occupancy::from_slice(grid.clone(), &bits, |inside| inside).unwrap()
}

fn cube(n: usize) -> Grid {
    Grid::new([n; 3], [1.0; 3]).unwrap()
}

/// The volumes of the mesh's components in the order of their first vertices.
fn volumes_of(mesh: &TriMesh) -> Vec<f64> {
    let mut first: Vec<usize> = (0..mesh.vertices.len()).collect();
    // Names of neighbours sink until none does any more.
    loop {
        let before = first.clone();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| v as usize);
            let least = corners.map(|v| first[v]).into_iter().min().unwrap();
            corners.into_iter().for_each(|v| first[v] = least);
        }
        if first == before {
            break;
        }
    }
    let roots: Vec<usize> = (0..first.len()).filter(|&v| first[v] == v).collect();
    let part = |root: usize| {
        let own = mesh.triangles.iter().filter(|t| first[t[0] as usize] == root);
        TriMesh {
            vertices: mesh.vertices.clone(),
            triangles: own.copied().collect(),
            normals: vec![],
        }
    };
    roots.into_iter().map(|root| part(root).volume()).collect()
}

/// Makes the shroud and judges it: every component has its volume or says that it is held, all of them
/// have that of the voxels, and the voxels are separated. Returns it with how many are held.
fn judged(name: &str, volume: &Occupancy, settings: &Settings) -> (Shroud, usize) {
    let shroud = shroud(volume, settings).unwrap();
    let unit = volume.grid().voxel_volume();
    let volumes = &shroud.report.volumes;
    let targets: f64 = volumes.iter().map(|volume| volume.target).sum();
    let count = volume.count() as f64;
    assert!((targets / unit - count).abs() < 1e-9 * count.max(1.0), "{name}: {targets}");
    let found = volumes_of(&shroud.mesh);
    assert_eq!(found.len(), volumes.len(), "{name}");
    for (found, volume) in found.iter().zip(volumes) {
        assert!((found / volume.reached - 1.0).abs() < 1e-9, "{name}: {found}, {volume:?}");
        assert!(volume.is_held || volume.relative_error() <= 1e-9, "{name}: {volume:?}");
        assert!(volume.multiplier.is_finite(), "{name}: {volume:?}");
    }
    let margin = settings.optimize.margin - 1e-12;
    assert!(shroud.delta.iter().all(|delta| (margin..=1.0 - margin).contains(delta)), "{name}");
    let checks = CheckSettings { faces: settings.faces, ..CheckSettings::default() };
    let report = check(&shroud.mesh, volume, &checks).unwrap();
    assert!(report.is_clean(), "{name}: {:?}", report.problems());
    let held = volumes.iter().filter(|volume| volume.is_held).count();
    (shroud, held)
}

#[test]
fn every_phantom_keeps_its_volume() {
    let mut linear = keep();
    linear.optimize.energy = Some(Energy::from(Linear { parameter: Parameter::Uniform }));
    for name in phantom::NAMES {
        let volume = phantom::named(name, 14).unwrap().volume;
        for (energy, settings) in [("bending", keep()), ("linear", linear.clone())] {
            let (_, held) = judged(&format!("{name}, {energy}"), &volume, &settings);
            assert_eq!(held, 0, "{name}, {energy}");
        }
        if name != "noise" {
            let (_, held) = judged(&format!("{name}, exact"), &volume, &keep_exactly());
            assert_eq!(held, 0, "{name}, exact");
        }
    }
}

#[test]
fn parts_one_voxel_thin_keep_theirs() {
    let grid = cube(9);
    type Inside<'a> = &'a dyn Fn([usize; 3]) -> bool;
    let parts: [(&str, Inside); 4] = [
        ("chain", &|[i, j, k]| i == j && j == k && (2..7).contains(&i)),
        ("stair", &|[i, j, k]| k == 4 && (2..7).contains(&i) && (i == j || i == j + 1)),
        ("tunnel", &|[i, j, k]| [i, j, k].iter().all(|n| (1..8).contains(n)) && [i, j] != [4, 4]),
        ("frame", &|[i, j, k]| {
            k == 4
                && [i, j].iter().all(|n| (2..7).contains(n))
                && [i, j].iter().any(|n| [2, 6].contains(n))
        }),
    ];
    for (name, part) in parts {
        for faces in [FaceRule::Separate, FaceRule::Join] {
            for settings in [keep(), keep_exactly()] {
                let settings = Settings { faces, ..settings };
                let (_, held) = judged(name, &inside(&grid, part), &settings);
                assert_eq!(held, 0, "{name}");
            }
        }
    }
}

/// The square of the distance from the middle of a cube of 15 points.
fn from_middle(point: [usize; 3]) -> i32 {
    point.iter().map(|&n| (n as i32 - 7).pow(2)).sum()
}

#[test]
fn a_cavity_keeps_its_own_volume() {
    let volume = inside(&cube(15), |p| (6..36).contains(&from_middle(p)));
    let hole = inside(&cube(15), |p| from_middle(p) < 6).count() as f64;
    let (shroud, held) = judged("cavity", &volume, &keep_exactly());
    let targets: Vec<f64> = shroud.report.volumes.iter().map(|volume| volume.target).collect();
    assert_eq!(held, 0);
    assert_eq!(targets, [volume.count() as f64 + hole, -hole]);
}

#[test]
fn components_keep_theirs_one_by_one() {
    let grid = cube(16);
    let near = |p: [usize; 3], middle: usize| -> i32 {
        p.iter().map(|&n| (n as i32 - middle as i32).pow(2)).sum()
    };
    let volume = inside(&grid, |p| near(p, 5) <= 14 || near(p, 12) <= 3);
    let counts = [(5, 14), (12, 3)].map(|(m, r)| inside(&grid, |p| near(p, m) <= r).count() as f64);
    let (shroud, _) = judged("two balls", &volume, &keep());
    let targets: Vec<f64> = shroud.report.volumes.iter().map(|volume| volume.target).collect();
    assert_eq!(targets, counts);
}

#[test]
fn the_frame_of_the_world_does_not_matter() {
    let affine = [[-0.9, 0.2, 0.1, 120.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];
    let oblique = Grid::with_affine([15; 3], affine).unwrap();
    assert!(oblique.is_mirrored());
    for grid in [oblique, Grid::new([15; 3], [0.5, 1.0, 3.0]).unwrap()] {
        let volume = inside(&grid, |p| (3..36).contains(&from_middle(p)));
        for settings in [keep(), keep_exactly()] {
            let (shroud, held) = judged("frame", &volume, &settings);
            assert_eq!((shroud.report.volumes.len(), held), (2, 0));
        }
    }
}

#[test]
fn what_the_bounds_hold_says_so() {
    // With the largest margin the octahedron around a voxel has at most 4/3·0.9³ of its volume.
    let mut settings = keep();
    settings.optimize.margin = 0.1;
    let volume = phantom::named("point", 5).unwrap().volume;
    let (shroud, held) = judged("point", &volume, &settings);
    assert_eq!(held, 1);
    let reached = shroud.report.volumes[0].reached;
    assert!((reached - 4.0 / 3.0 * 0.9f64.powi(3)).abs() < 1e-9, "{reached}");
}

#[test]
fn the_result_is_stationary_under_its_multipliers() {
    let volume = phantom::linked_tori(24).unwrap();
    let (kept, _) = judged("tori", &volume, &keep_exactly());
    assert_eq!(kept.report.status, Status::Converged);
    assert!(kept.report.projected_step_rms <= 5e-4);
    let mut free = keep_exactly();
    free.optimize.volume = VolumeRule::Free;
    let free = shroud(&volume, &free).unwrap();
    assert!(free.report.volumes.is_empty());
    // The free tori are too small; to grow them costs energy, more for each unit of volume.
    let gained: f64 = volumes_of(&kept.mesh).iter().sum::<f64>() - free.mesh.volume();
    let cost = kept.report.energy[1] - free.report.energy[1];
    assert!(gained > 10.0 && cost > 0.0, "{gained}, {cost}");
    for volume in &kept.report.volumes {
        assert!((0.5..4.0).contains(&(volume.multiplier * gained / cost)), "{volume:?}, {cost}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let volume = phantom::named("noise", 14).unwrap().volume;
    let results = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let shroud = pool.install(|| shroud(&volume, &keep())).unwrap();
        (shroud.delta, shroud.mesh, shroud.report)
    });
    assert_eq!(results[0], results[1]);
}

#[test]
fn nothing_inside_has_nothing_to_keep() {
    let shroud = shroud(&inside(&cube(4), |_| false), &keep()).unwrap();
    assert_eq!(shroud.report.status, Status::Empty);
    assert!(shroud.mesh.triangles.is_empty() && shroud.report.volumes.is_empty());
}

#[test]
fn what_cannot_be_kept_is_refused() {
    let volume = phantom::sphere(8).unwrap();
    let mut sweeps = keep();
    sweeps.optimize.solver = Solver::Sweeps;
    let open = Settings { border: Border::Open, ..keep() };
    let dual = Settings { mesh: MeshKind::Dual, ..keep() };
    for settings in [sweeps, open, dual] {
        let error = shroud(&volume, &settings).unwrap_err();
        assert!(matches!(error, Error::Setting { name: "volume", .. }), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn random_voxels_keep_their_volume(volume in volumes(), join: bool) {
        let faces = if join { FaceRule::Join } else { FaceRule::Separate };
        judged("random", &volume, &Settings { faces, ..keep() });
    }
}
