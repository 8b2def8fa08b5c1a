//! The optimisation against invariants, brute force and itself.

#![allow(clippy::unwrap_used)]

mod common;

use std::ops::ControlFlow;

use common::{CONVENTIONS, volumes};
use proptest::prelude::*;
use shrouds::energy::{
    Bending, Curvature, CurveEnergy, CurveFormula, Energy, Linear, Parameter, Point2, Scalar,
    Variation,
};
use shrouds::network::Network;
use shrouds::optimize::{Preset, Report, Settings, Solver, Start, Status, VolumeRule, optimize};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Error, Grid, Occupancy};

fn energies() -> Vec<Energy> {
    let mut all: Vec<Energy> = vec![
        Bending.into(),
        Variation.into(),
        Energy::from(Bending) + 0.3 * Energy::from(Variation),
    ];
    for parameter in [Parameter::Uniform, Parameter::Chord, Parameter::Centripetal] {
        all.push(Curvature { parameter }.into());
        all.push(Linear { parameter }.into());
    }
    all
}

fn run_on(
    volume: &Occupancy,
    rule: FaceRule,
    border: Border,
    settings: &Settings,
) -> (Vec<f64>, Report) {
    let surface = Surface::extract(volume, rule, border).unwrap();
    let optimum = optimize(&surface, settings, &mut |_| ControlFlow::Continue(())).unwrap();
    (optimum.delta, optimum.report)
}

/// Settings that go on until they converge.
fn exact() -> Settings {
    Settings { preset: Preset::Exact, ..Settings::default() }
}

fn run(volume: &Occupancy, settings: &Settings) -> (Vec<f64>, Report) {
    run_on(volume, FaceRule::Separate, Border::Closed, settings)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// A small ellipsoid on an anisotropic grid.
fn egg() -> Occupancy {
    let grid = Grid::new([17, 16, 9], [1.0, 1.0, 2.0]).unwrap();
    phantom::ellipsoid(&grid, [8.1, 7.4, 8.3], [5.7, 4.6, 6.1], &phantom::IDENTITY).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn the_energy_never_rises_and_delta_keeps_its_margin(
        volume in volumes(), seed in any::<u64>(), margin in 1e-4..0.1f64
    ) {
        for (rule, border) in CONVENTIONS {
            for (n, energy) in energies().into_iter().enumerate() {
                let solver = if n % 2 == 0 { Solver::Newton } else { Solver::Sweeps };
                for solver in [Solver::Newton, solver] {
                    let settings = Settings {
                        energy: Some(energy.clone()), solver, margin,
                        start: Start::Random(seed),
                        max_iterations: Some(6),
                        ..exact()
                    };
                    let (delta, report) = run_on(&volume, rule, border, &settings);
                    for round in &report.rounds {
                        for pair in round.energies.windows(2) {
                            prop_assert!(pair[1] <= pair[0] * (1.0 + 1e-12) + 1e-24, "{solver:?} {pair:?}");
                        }
                    }
                    let within = margin - 1e-15..=1.0 - margin + 1e-15;
                    prop_assert!(delta.iter().all(|d| within.contains(d)));
                    prop_assert!(report.energy.iter().all(|e| e.is_finite()));
                }
            }
        }
    }
}

#[test]
fn sweeps_and_newton_agree_on_the_convex_energy() {
    for volume in [egg(), phantom::linked_tori(24).unwrap()] {
        let with = |solver, tolerance, start| {
            let settings = Settings {
                energy: Some(Linear::default().into()),
                solver,
                start,
                tolerance: Some(tolerance),
                max_iterations: Some(100_000),
                ..exact()
            };
            let (delta, report) = run(&volume, &settings);
            assert_eq!(report.status, Status::Converged, "{solver:?} {report:?}");
            delta
        };
        let newton = with(Solver::Newton, 1e-11, Start::Blur);
        let sweeps = with(Solver::Sweeps, 1e-12, Start::Random(7));
        let difference = largest_difference(&newton, &sweeps);
        assert!(difference < 1e-8, "apart by {difference:e}");
    }
}

#[test]
fn the_convex_energy_has_one_minimum_from_any_start() {
    let volume = phantom::linked_tori(24).unwrap();
    let from = |start| {
        let settings = Settings {
            energy: Some(Linear::default().into()),
            start,
            tolerance: Some(1e-11),
            ..exact()
        };
        let (delta, report) = run(&volume, &settings);
        assert_eq!(report.status, Status::Converged);
        delta
    };
    let first = from(Start::Blur);
    for start in [Start::Midpoint, Start::Inside, Start::Outside, Start::Random(1)] {
        let difference = largest_difference(&first, &from(start.clone()));
        assert!(difference < 1e-8, "{start:?} is {difference:e} away");
    }
}

#[test]
fn bending_ends_at_the_same_surface_from_any_start() {
    let tolerance = 1e-7;
    for volume in [phantom::sphere(32).unwrap(), egg(), phantom::linked_tori(24).unwrap()] {
        let from = |start| {
            let energy = Some(Bending.into());
            let settings = Settings { energy, start, tolerance: Some(tolerance), ..exact() };
            let (delta, report) = run(&volume, &settings);
            assert_eq!(report.status, Status::Converged);
            (delta, report.energy[1])
        };
        let (first, energy) = from(Start::Blur);
        for start in [Start::Midpoint, Start::Random(1)] {
            let (delta, other) = from(start.clone());
            let squares: f64 = first.iter().zip(&delta).map(|(a, b)| (a - b).powi(2)).sum();
            let rms = (squares / delta.len() as f64).sqrt();
            assert!(rms < 1e-5, "{start:?}: root mean square {rms:e}");
            assert!((other / energy - 1.0).abs() < 1e-6, "{start:?}: {energy} and {other}");
        }
    }
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    // More vertices than a block, so that two threads share the work.
    let volume = phantom::sphere(48).unwrap();
    let settings = Settings { max_iterations: Some(5), ..exact() };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&volume, &settings))
    };
    let (one, report) = with(1);
    assert!(one.len() > 5000);
    for threads in [2, 3] {
        let (delta, other) = with(threads);
        assert!(one.iter().zip(&delta).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!(report, other);
    }
}

#[test]
fn the_certificate_of_a_convex_energy_holds() {
    // Against runs to the last digit: the true distance to the minimum is never above the gap.
    for volume in [egg(), phantom::linked_tori(24).unwrap(), maze()] {
        let run = |solver, tolerance, max_iterations| {
            let energy = Some(Linear::default().into());
            let tolerance = Some(tolerance);
            run(&volume, &Settings { energy, solver, tolerance, max_iterations, ..exact() }).1
        };
        let minimum = run(Solver::Newton, 1e-11, Some(400));
        let gap = |report: &Report| report.energy_gap.expect("linear is convex");
        assert!(gap(&minimum) < 1e-6 * minimum.energy[1], "{minimum:?}");
        for (solver, tolerance, steps) in [
            (Solver::Newton, 0.5, None),
            (Solver::Newton, 1e-3, None),
            (Solver::Newton, 1e-6, Some(2)),
            (Solver::Sweeps, 0.1, Some(3)),
        ] {
            if solver == Solver::Sweeps && volume.count() > 10_000 {
                continue;
            }
            let report = run(solver, tolerance, steps);
            let error = report.energy[1] - minimum.energy[1];
            assert!(error <= gap(&report), "{solver:?}: {error:e} above {:e}", gap(&report));
        }
    }
    let bending = run(&egg(), &Settings { energy: Some(Bending.into()), ..exact() }).1;
    assert_eq!(bending.energy_gap, None);
    assert!((0.0..1e-3).contains(&bending.largest_gain));
}

#[test]
fn the_sum_over_curves_is_the_energy() {
    let volume = egg();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    let network = Network::trace(&surface);
    let energy = Curvature::default();
    let settings = Settings {
        energy: Some(energy.into()),
        start: Start::Random(5),
        max_iterations: Some(1),
        ..exact()
    };
    let (delta, report) = run(&volume, &settings);
    // Equation 9, straight from the polygons in space, each slice weighted by its distance to the
    // next, lengths in units of the smallest spacing.
    let spacing = surface.grid().spacing().map(|h| h / surface.grid().min_spacing());
    let mut sum = 0.0;
    for curve in network.curves() {
        let (u, v) = ((curve.axis + 1) % 3, (curve.axis + 2) % 3);
        let points: Vec<Point2> = curve
            .vertices
            .iter()
            .map(|&n| surface.crossing(n).position(delta[n as usize]))
            .map(|p| [p[u] * spacing[u], p[v] * spacing[v]])
            .collect();
        let count = points.len();
        let rho =
            |n: usize| energy.rho(&[count - 1, 0, 1, 2].map(|step| points[(n + step) % count]));
        sum += spacing[curve.axis] * (0..count).map(rho).sum::<f64>();
    }
    assert!((sum / report.energy[1] - 1.0).abs() < 1e-12, "{sum} and {}", report.energy[1]);
}

#[test]
fn a_start_is_where_it_says() {
    let volume = egg();
    let started = |start| {
        let settings = Settings { start, max_iterations: Some(0), ..exact() };
        let (delta, report) = run(&volume, &settings);
        assert_eq!((report.status, report.iterations), (Status::IterationLimit, 0));
        delta
    };
    assert!(started(Start::Midpoint).iter().all(|&d| d == 0.5));
    assert!(started(Start::Inside).iter().all(|&d| (d - 0.998).abs() < 1e-7));
    assert!(started(Start::Outside).iter().all(|&d| (d - 0.002).abs() < 1e-7));
    let random = started(Start::Random(3));
    let mean = random.iter().sum::<f64>() / random.len() as f64;
    assert!((mean - 0.5).abs() < 4.0 / (12.0 * random.len() as f64).sqrt());
    assert_ne!(random, started(Start::Random(4)));
}

#[test]
fn without_steps_the_energy_is_that_of_the_start() {
    let volume = phantom::linked_tori(24).unwrap();
    for (solver, preset) in [
        (Solver::Sweeps, Preset::Exact),
        (Solver::Newton, Preset::Fast),
        (Solver::Newton, Preset::Exact),
    ] {
        let (energy, max_iterations) = (Some(Bending.into()), Some(0));
        let settings = Settings { energy, solver, preset, max_iterations, ..Settings::default() };
        let (_, report) = run(&volume, &settings);
        assert_eq!((report.status, report.iterations), (Status::IterationLimit, 0));
        assert!(report.energy[0] > 0.0 && report.energy[0] == report.energy[1], "{report:?}");
    }
}

#[test]
fn the_blurred_start_follows_the_shape() {
    // On a ball the blurred occupancy passes one half within the blur's own shift of the surface.
    let volume = phantom::sphere(32).unwrap();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    let squared_distance = |start| {
        let settings = Settings { start, max_iterations: Some(0), ..exact() };
        let (delta, _) = run(&volume, &settings);
        let distance = |(crossing, &d): (shrouds::surface::Crossing, &f64)| {
            let p = surface.grid().point(crossing.position(d));
            let centre = [15.5 + 0.137, 15.5 + 0.071, 15.5 - 0.093];
            let r2: f64 = (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum();
            (r2.sqrt() - 0.4 * 32.0).powi(2)
        };
        surface.crossings().zip(&delta).map(distance).sum::<f64>()
    };
    assert!(squared_distance(Start::Blur) < 0.25 * squared_distance(Start::Midpoint));
}

#[test]
fn settings_out_of_range_are_refused() {
    let volume = egg();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    for settings in [
        Settings { margin: 0.0, ..exact() },
        Settings { margin: 0.2, ..exact() },
        Settings { margin: f64::NAN, ..exact() },
        Settings { tolerance: Some(0.0), ..exact() },
        Settings { tolerance: Some(f64::NAN), ..exact() },
    ] {
        let result = optimize(&surface, &settings, &mut |_| ControlFlow::Continue(()));
        assert!(matches!(result, Err(Error::Setting { .. })));
    }
}

#[test]
fn the_observer_can_stop_the_work() {
    let volume = egg();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    for solver in [Solver::Newton, Solver::Sweeps] {
        let settings = Settings { solver, tolerance: Some(1e-12), ..exact() };
        let mut seen = Vec::new();
        let report = optimize(&surface, &settings, &mut |progress| {
            seen.push(progress.iteration);
            if progress.iteration >= 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap()
        .report;
        assert_eq!(report.status, Status::Cancelled);
        assert_eq!(seen.last(), Some(&report.iterations));
        assert!((2..6).contains(&report.iterations), "stopped at the next chance: {seen:?}");
    }
}

#[test]
fn an_empty_volume_gives_an_empty_mesh() {
    let volume = Occupancy::empty(Grid::new([5, 5, 5], [1.0; 3]).unwrap());
    let shroud = shrouds::shroud(&volume, &shrouds::Settings::default()).unwrap();
    assert_eq!(shroud.report.status, Status::Empty);
    assert!(shroud.mesh.vertices.is_empty() && shroud.mesh.triangles.is_empty());
}

/// The squared length of both chords: a measure that is none of ours.
struct Length;

impl CurveFormula for Length {
    fn residual<S: Scalar>(&self, [a, b, c, _]: [Point2<S>; 4]) -> [S; 2] {
        let squared = |p: Point2<S>, q: Point2<S>| {
            (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1])
        };
        [squared(a, b).sqrt(), squared(b, c).sqrt()]
    }
}

#[test]
fn a_foreign_energy_can_be_plugged_in() {
    // Shortest curves of a single voxel: every vertex as near to it as the margin allows.
    let mut volume = Occupancy::empty(Grid::new([3, 3, 3], [1.0; 3]).unwrap());
    volume.set([1, 1, 1], true);
    for solver in [Solver::Newton, Solver::Sweeps] {
        let settings =
            Settings { energy: Some(Length.into()), solver, tolerance: Some(1e-10), ..exact() };
        let (delta, report) = run(&volume, &settings);
        assert_eq!(report.status, Status::Converged);
        assert_eq!(report.at_bound, 1.0);
        assert!(delta.iter().all(|d| (d - 0.998).abs() < 1e-12), "{delta:?}");
    }
}

/// A surface of so many vertices that it is worked on in several tiles.
fn maze() -> Occupancy {
    let volume = phantom::gyroid(80).unwrap();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    assert!(surface.vertex_count() > 100_000);
    volume
}

#[test]
fn tiles_give_the_same_bits_on_any_number_of_threads() {
    let volume = maze();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&volume, &Settings::default()))
    };
    let (one, report) = with(1);
    assert_eq!(report.status, Status::Preset);
    for threads in [2, 3] {
        let (delta, other) = with(threads);
        assert!(one.iter().zip(&delta).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!(report, other);
    }
}

#[test]
fn the_energies_of_the_tiles_add_up() {
    let volume = maze();
    let start = |preset| {
        let settings = Settings {
            energy: Some(Linear::default().into()),
            start: Start::Random(9),
            max_iterations: Some(0),
            preset,
            ..Settings::default()
        };
        run(&volume, &settings).1.energy[1]
    };
    let (whole, tiles) = (start(Preset::Exact), start(Preset::Default));
    assert!((tiles / whole - 1.0).abs() < 1e-6, "{whole} and {tiles}");
}

#[test]
fn presets_come_nearer_to_the_minimum_one_after_the_other() {
    for volume in [phantom::sphere(48).unwrap(), phantom::linked_tori(40).unwrap(), maze()] {
        let [fast, default] = [Preset::Fast, Preset::Default].map(|preset| {
            let (delta, report) = run(&volume, &Settings { preset, ..Settings::default() });
            assert_eq!(report.status, Status::Preset);
            (delta, report)
        });
        assert!(fast.1.projected_step_rms > default.1.projected_step_rms);
        assert!(fast.1.energy[1] > default.1.energy[1]);
        assert!(default.1.energy[1] < 0.5 * default.1.energy[0]);
        let within = 0.002 - 1e-7..=0.998 + 1e-7;
        assert!(default.0.iter().chain(&fast.0).all(|d| within.contains(d)));
    }
}

#[test]
fn a_preset_can_be_cut_short() {
    for (limit, expected) in [(0, 0), (1, 1), (2, 2), (3, 3), (50, 3)] {
        let settings = Settings { max_iterations: Some(limit), ..Settings::default() };
        let (_, report) = run(&egg(), &settings);
        assert_eq!(report.iterations, expected);
        let status = if limit < 3 { Status::IterationLimit } else { Status::Preset };
        assert_eq!(report.status, status, "limit {limit}");
    }
}

#[test]
fn slopes_give_the_normals_of_the_curves() {
    let oblique = [[-0.9, 0.0, 0.0, 12.0], [0.0, 1.1, 0.0, -40.0], [0.0, 0.0, 2.5, 7.5]];
    let grid = Grid::with_affine([24, 24, 12], oblique).unwrap();
    let volume = Occupancy::from_fn(grid, |[i, j, k]| {
        let p = [i as f64 - 11.6, 1.1 * (j as f64 - 11.3), 2.5 * (k as f64 - 5.6)];
        p.iter().map(|x| x * x).sum::<f64>() < 81.0
    });
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    let optimum = optimize(&surface, &exact(), &mut |_| ControlFlow::Continue(())).unwrap();
    let vertices = shrouds::mesh::place_vertices(&surface, &optimum.delta);
    let network = Network::trace(&surface);
    let expected = shrouds::mesh::network_normals(&surface, &network, &vertices);
    let found = shrouds::mesh::slope_normals(&surface, &optimum.slopes);
    for (a, b) in found.iter().zip(&expected) {
        assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-4), "{a:?} and {b:?}");
    }
}
