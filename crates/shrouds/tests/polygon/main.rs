//! Polygons of images against formulas, brute force and an exact count of sides.

#![allow(clippy::unwrap_used)]

mod chains;
#[path = "../common/mod.rs"]
mod common;
mod judge;

use std::f64::consts::PI;
use std::ops::ControlFlow;

use chains::Chains;
use common::CONVENTIONS;
use judge::{hold, wrong_side};
use proptest::prelude::*;
use shrouds::energy::{
    Bending, Curvature, CurveEnergy, CurveFormula, Linear, Point2, Scalar, Variation,
};
use shrouds::optimize::{self, Preset, Solver, Start, Status, minimise_vertex, optimize};
use shrouds::polygon::{Polygon, Separation, place, separate};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Error, Grid, Occupancy, Settings};

fn grid(nx: usize, ny: usize) -> Grid {
    Grid::new([nx, ny, 1], [1.0; 3]).unwrap()
}

fn image(nx: usize, ny: usize, inside: impl Fn(usize, usize) -> bool + Sync) -> Occupancy {
    Occupancy::from_fn(grid(nx, ny), |[i, j, _]| inside(i, j))
}

/// Random images, some of whose rows cross a word boundary.
fn images() -> impl Strategy<Value = Occupancy> {
    (prop_oneof![4 => 1usize..12, 1 => 62usize..68], 1usize..12, 0.1..0.9f64).prop_flat_map(
        |(nx, ny, density)| {
            proptest::collection::vec(proptest::bool::weighted(density), nx * ny).prop_map(
                move |bits| {
                    let grid = Grid::new([nx, ny, 1], [1.0, 1.5, 0.1]).unwrap();
                    Occupancy::from_slice(grid, &bits, |inside| inside).unwrap()
                },
            )
        },
    )
}

fn exact(energy: impl CurveEnergy + 'static) -> Settings {
    let preset = Preset::Exact;
    let energy = Some(energy.into());
    Settings {
        optimize: optimize::Settings { preset, energy, ..Default::default() },
        ..Default::default()
    }
}

/// A disc of this radius about a point off the lattice.
fn disc(radius: f64) -> (Occupancy, [f64; 2]) {
    let size = 2 * radius as usize + 5;
    let centre = [size as f64 / 2.0 + 0.13, size as f64 / 2.0 - 0.29];
    let inside = |i, j| (i as f64 - centre[0]).hypot(j as f64 - centre[1]) < radius;
    (image(size, size, inside), centre)
}

fn is_allowed(image: &Occupancy, border: Border) -> bool {
    border == Border::Closed || image.grid().dims()[..2].iter().all(|&n| n > 1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn every_lattice_point_is_on_its_side(image in images(), seed in 0..1000u64) {
        for (faces, border) in CONVENTIONS {
            if !is_allowed(&image, border) {
                continue;
            }
            for (start, preset, solver) in [
                (Start::Blur, Preset::Default, Solver::Newton),
                (Start::Midpoint, Preset::Exact, Solver::Newton),
                (Start::Random(seed), Preset::Exact, Solver::Sweeps),
            ] {
                let optimize = optimize::Settings {
                    start, preset, solver, max_iterations: Some(30), ..Default::default()
                };
                let settings = Settings { faces, border, optimize, ..Settings::default() };
                let found = separate(&image, &settings).unwrap();
                hold(&image, &found, faces, border);
            }
        }
    }

    #[test]
    fn polygons_are_cut_alike_wherever_they_lie(image in images()) {
        // The same image as a slice across each axis of a volume: the same polygons.
        let [nx, ny, _] = image.grid().dims();
        let found = separate(&image, &Settings::default()).unwrap();
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let (mut dims, mut spacing) = ([4; 3], [7.0; 3]);
            (dims[u], dims[v]) = (nx, ny);
            (spacing[u], spacing[v]) = (1.0, 1.5);
            let volume = Occupancy::from_fn(Grid::new(dims, spacing).unwrap(), |index| {
                index[axis] == 2 && image.get([index[u], index[v], 0])
            });
            let slice = volume.slice(axis, 2).unwrap();
            let there = separate(&slice, &Settings::default()).unwrap();
            prop_assert_eq!(&there.delta, &found.delta);
            for (a, b) in there.polygons.iter().zip(&found.polygons) {
                prop_assert_eq!(&a.index, &b.index);
                prop_assert!((a.area - b.area).abs() < 1e-12 * (1.0 + b.area.abs()));
                for (p, q) in a.points.iter().zip(&b.points) {
                    prop_assert!((p[axis] - 14.0).abs() < 1e-12);
                    prop_assert!((p[u] - q[0]).abs() < 1e-12 && (p[v] - q[1]).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn the_convex_energy_ends_at_the_minimum_of_projected_gradients() {
    let shapes: [(&str, Occupancy); 5] = [
        ("pixel", image(1, 1, |_, _| true)),
        ("angle", image(4, 4, |i, j| i == 0 || j == 0)),
        ("ring", image(5, 5, |i, j| i % 4 == 0 || j % 4 == 0)),
        ("diagonal", image(5, 5, |i, j| i == j)),
        ("steps", image(9, 4, |i, j| 2 * j <= i)),
    ];
    for (name, image) in shapes {
        for faces in [FaceRule::Separate, FaceRule::Join] {
            let mut settings = Settings { faces, ..exact(Linear::default()) };
            settings.optimize.tolerance = Some(1e-9);
            let found = separate(&image, &settings).unwrap();
            let chains = Chains::new(&found);
            // 16·Σ|P₀ − 2·P₁ + P₂|²; the matrix of the differences has a norm of at most 4, squared 16.
            let mut x = vec![0.5; found.delta.len()];
            for _ in 0..100_000 {
                let second: Vec<_> = (0..x.len()).map(|v| chains.second(&x, v)).collect();
                for v in 0..x.len() {
                    let [a, c] = chains.neighbours[v];
                    let slope = |k: usize| {
                        chains.moves[v][k] * (second[a][k] - 2.0 * second[v][k] + second[c][k])
                    };
                    x[v] = (x[v] - (slope(0) + slope(1)) / 16.0).clamp(0.002, 0.998);
                }
            }
            let wanted = chains.delta(&x);
            let far = wanted.iter().zip(&found.delta).map(|(a, b)| (a - b).abs());
            let far = far.fold(0.0, f64::max);
            assert!(far < 1e-4, "{name}, {faces:?}: {far}");
            let energy = chains.energy(&Linear::default(), &x);
            let [_, last] = found.report.energy;
            assert!((last / energy - 1.0).abs() < 1e-7, "{name}, {faces:?}: {last}, {energy}");
            assert_eq!(found.report.status, Status::Converged, "{name}, {faces:?}");
        }
    }
}

#[test]
fn one_pixel_has_the_least_energy_of_all_places() {
    // Equation 6 is not convex: a walk over all places of the four vertices.
    const STEPS: usize = 20;
    let settings = exact(Curvature::default());
    let found = separate(&image(1, 1, |_, _| true), &settings).unwrap();
    let chains = Chains::new(&found);
    let place = |n: usize| 0.002 + 0.996 * n as f64 / STEPS as f64;
    let mut least = f64::INFINITY;
    for n in 0..(STEPS + 1).pow(4) {
        let x = [0, 1, 2, 3].map(|k| place(n / (STEPS + 1).pow(k) % (STEPS + 1)));
        least = least.min(chains.energy(&Curvature::default(), &x));
    }
    let [_, last] = found.report.energy;
    assert!(last <= least * (1.0 + 1e-9), "{last}, {least}");
}

/// Bending without its barrier.
struct Weighted;

impl CurveFormula for Weighted {
    fn residual<S: Scalar>(&self, points: [Point2<S>; 4]) -> [S; 2] {
        Bending.residual(points)
    }

    fn meusnier_exponent(&self) -> f64 {
        5.0
    }
}

#[test]
fn the_energy_is_that_of_the_polygons_alone() {
    // No term of a curve across the image: the sum over the polygons is all of it.
    // The plane of an image is across its polygons, so Meusnier weights are 1.
    let (image, _) = disc(6.4);
    let compare = |mut settings: Settings, measure: &dyn CurveEnergy| {
        settings.optimize.start = Start::Random(5);
        let found = separate(&image, &settings).unwrap();
        let chains = Chains::new(&found);
        let energy = chains.energy(measure, &chains.delta(&found.delta));
        assert!((found.report.energy[1] / energy - 1.0).abs() < 1e-12);
        found
    };
    compare(exact(Weighted), &Weighted);
    let settings = exact(Curvature::default());
    let found = compare(settings.clone(), &Curvature::default());
    // And it does not depend on how far slices lie apart.
    let far = Grid::new(image.grid().dims(), [1.0, 1.0, 0.01]).unwrap();
    let far = Occupancy::from_fn(far, |index| image.get(index));
    let settings = Settings {
        optimize: optimize::Settings { start: Start::Random(5), ..settings.optimize },
        ..settings
    };
    assert_eq!(separate(&far, &settings).unwrap().delta, found.delta);
}

#[test]
fn a_disc_is_round() {
    for radius in [5.3, 20.4, 61.7] {
        let (image, centre) = disc(radius);
        let about = |p: &[f64; 2]| (p[0] - centre[0]).hypot(p[1] - centre[1]);
        let rms = |polygon: &Polygon| {
            let squares = polygon.index.iter().map(|p| (about(p) - radius).powi(2));
            (squares.sum::<f64>() / polygon.index.len() as f64).sqrt()
        };
        let found = separate(&image, &exact(Bending)).unwrap();
        assert_eq!(found.report.status, Status::Converged);
        let [polygon] = &found.polygons[..] else { panic!("one polygon") };
        let circularity = 4.0 * PI * polygon.area / polygon.length.powi(2);
        let middle = Surface::of_image(&image, FaceRule::Separate, Border::Closed).unwrap();
        let middle = place(&image, &middle, &vec![0.5; found.delta.len()]);
        let of_same_area = (polygon.area / PI).sqrt();
        assert!((of_same_area - radius).abs() < 0.02, "{of_same_area} for {radius}");
        assert!(circularity > 0.995 && circularity < 1.0, "{circularity}");
        assert!(rms(polygon) < 0.3 * rms(&middle[0]));
    }
}

#[test]
fn thin_images() {
    for settings in [exact(Bending), exact(Linear::default()), exact(Variation)] {
        let areas = |image: &Occupancy| {
            let found = separate(image, &settings).unwrap();
            hold(image, &found, FaceRule::Separate, Border::Closed);
            found.polygons.iter().map(|polygon| polygon.area).collect::<Vec<_>>()
        };
        let count = |image: &Occupancy| areas(image).len();
        assert_eq!(count(&image(1, 1, |_, _| true)), 1);
        assert_eq!(count(&image(5, 4, |i, j| (i, j) == (2, 2))), 1);
        assert_eq!(count(&image(6, 5, |_, _| true)), 1);
        assert_eq!(count(&image(9, 1, |i, _| i % 3 == 0)), 3);
        assert_eq!(count(&image(1, 70, |_, j| j != 20)), 2);
        assert_eq!(count(&image(9, 5, |_, j| j == 2)), 1);
        assert_eq!(count(&image(5, 5, |i, j| (i, j) != (2, 2))), 2);
        assert!(areas(&image(5, 5, |i, j| (i, j) != (2, 2)))[1] < 0.0);
    }
}

#[test]
fn nothing_to_separate_is_fine() {
    let settings = Settings::default();
    let found = separate(&image(4, 3, |_, _| false), &settings).unwrap();
    assert!(found.polygons.is_empty() && found.delta.is_empty());
    assert_eq!(found.report.status, Status::Empty);
    let open = Settings { border: Border::Open, ..settings };
    assert!(separate(&image(4, 3, |_, _| true), &open).unwrap().polygons.is_empty());
    // Half a plane: one line from border to border.
    let half = separate(&image(4, 3, |_, j| j > 0), &open).unwrap();
    assert_eq!((half.polygons.len(), half.polygons[0].closed), (1, false));
    assert!((half.polygons[0].length - 3.0).abs() < 0.01);
}

#[test]
fn what_is_no_image_is_refused() {
    let volume = Occupancy::empty(Grid::new([4, 4, 2], [1.0; 3]).unwrap());
    let settings = Settings::default();
    assert_eq!(separate(&volume, &settings).unwrap_err(), Error::NotAnImage { slices: 2 });
    assert_eq!(volume.slice(2, 2), Err(Error::NoSlice { axis: 'z', index: 2, last: 1 }));
    let open = Settings { border: Border::Open, ..settings };
    let line = image(4, 1, |i, _| i > 1);
    assert_eq!(separate(&line, &open).unwrap_err(), Error::NoCells { dims: [4, 1, 1] });
}

#[test]
fn a_vertex_alone_goes_where_the_energy_is_least() {
    let (image, _) = disc(5.3);
    for settings in [exact(Linear::default()), exact(Curvature::default()), exact(Bending)] {
        let surface = Surface::of_image(&image, FaceRule::Separate, Border::Closed).unwrap();
        let middle = vec![0.5; surface.vertex_count()];
        for v in [0, 7, 20] {
            let delta = minimise_vertex(&surface, &settings.optimize, &middle, v).unwrap();
            assert!((0.002..=0.998).contains(&delta));
            let energy = settings.optimize.energy();
            let measure = &energy.parts()[0].measure;
            if measure.barrier() > 0.0 {
                continue;
            }
            let found = Separation {
                polygons: place(&image, &surface, &middle),
                delta: middle.clone(),
                surface: surface.clone(),
                report: separate(&image, &settings).unwrap().report,
            };
            let chains = Chains::new(&found);
            let at = |delta: f64| {
                let mut moved = middle.clone();
                moved[v as usize] = delta;
                chains.energy(measure.as_ref(), &chains.delta(&moved))
            };
            let least = (0..=2000).map(|n| at(0.002 + 0.996 * f64::from(n) / 2000.0));
            assert!(at(delta) <= least.fold(f64::INFINITY, f64::min) * (1.0 + 1e-12));
        }
    }
}

#[test]
fn figure_1_one_vertex_then_a_sweep_then_the_optimum() {
    // Energies of the three states of the figure, without weights and barrier.
    let (image, _) = disc(4.6);
    let surface = Surface::of_image(&image, FaceRule::Separate, Border::Closed).unwrap();
    let settings = optimize::Settings {
        energy: Some(Linear::default().into()),
        solver: Solver::Sweeps,
        start: Start::Midpoint,
        ..Default::default()
    };
    let run = |settings: &optimize::Settings| {
        optimize(&surface, settings, &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let sweep = run(&optimize::Settings { max_iterations: Some(1), ..settings.clone() });
    let last = run(&settings);
    assert_eq!((sweep.report.iterations, last.report.status), (1, Status::Converged));

    // Moving one vertex after the other is the first sweep.
    let mut delta = vec![0.5; surface.vertex_count()];
    let mut energies = Vec::new();
    for v in 0..delta.len() {
        delta[v] = minimise_vertex(&surface, &settings, &delta, v as u32).unwrap();
        let polygons = place(&image, &surface, &delta);
        assert_eq!(wrong_side(&image, &polygons, Border::Closed), 0);
        energies.push(sum_of_second_differences(&polygons));
    }
    let far = delta.iter().zip(&sweep.delta).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 1e-12, "{far}");
    let [first, swept] = sweep.report.energy;
    let [_, least] = last.report.energy;
    assert!(energies.windows(2).all(|pair| pair[1] <= pair[0] + 1e-12));
    assert!(energies[0] <= first && swept < energies[0] && least < swept);
    assert!((energies[delta.len() - 1] / swept - 1.0).abs() < 1e-12);
}

/// Equation 7 with a uniform parameter.
fn sum_of_second_differences(polygons: &[Polygon]) -> f64 {
    let at = |polygon: &Polygon, n: usize, k: usize| {
        let count = polygon.index.len();
        let [a, b, c] = [n, n + 1, n + 2].map(|n| polygon.index[n % count][k]);
        16.0 * (a - 2.0 * b + c).powi(2)
    };
    let of = |p: &Polygon| (0..p.index.len()).map(|n| at(p, n, 0) + at(p, n, 1)).sum::<f64>();
    polygons.iter().map(of).sum()
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    // Enough vertices for several tiles.
    let noise = image(400, 300, |i, j| (i * i + 3 * i * j + 7 * j * j) % 11 < 5);
    let run = |threads: usize, settings: &Settings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| separate(&noise, settings).unwrap())
    };
    let mut short = exact(Bending);
    short.optimize.max_iterations = Some(2);
    for settings in [Settings::default(), short] {
        let (one, three) = (run(1, &settings), run(3, &settings));
        assert!(one.delta.len() > 80_000);
        assert_eq!(one.delta, three.delta);
        assert_eq!(one.polygons, three.polygons);
        assert_eq!(one.report, three.report);
    }
}
