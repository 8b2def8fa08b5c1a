//! The optimisation within intervals of δ that are known beforehand.

#![allow(clippy::unwrap_used)]

mod common;

use std::ops::ControlFlow;
use std::sync::Arc;

use common::{CONVENTIONS, volumes};
use proptest::prelude::*;
use shrouds::energy::{Bending, Energy, Linear, Variation};
use shrouds::optimize::{Crease, Optimum, Preset, Settings, Solver, Start, VolumeRule};
use shrouds::optimize::{minimise_vertex, optimize};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Error, Grid, Occupancy};

fn closed(volume: &Occupancy) -> Surface {
    Surface::extract(volume, FaceRule::Separate, Border::Closed).unwrap()
}

fn run(surface: &Surface, settings: &Settings) -> Optimum {
    optimize(surface, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// All ways to solve, with few iterations.
fn ways() -> Vec<Settings> {
    let usual = || Settings { max_iterations: Some(6), ..Settings::default() };
    let presets = [Preset::Fast, Preset::Default, Preset::Exact];
    let mut ways: Vec<Settings> =
        presets.map(|preset| Settings { preset, ..usual() }).into_iter().collect();
    ways.push(Settings { solver: Solver::Sweeps, ..usual() });
    ways.push(Settings { crease: Some(Crease::default()), max_iterations: None, ..usual() });
    let energies: [Energy; 2] = [Linear::default().into(), Variation.into()];
    for energy in energies {
        ways.push(Settings { energy: Some(energy), preset: Preset::Exact, ..usual() });
    }
    ways.push(Settings { start: Start::Random(5), energy: Some(Bending.into()), ..usual() });
    ways
}

/// The interval of this number of bits that holds each δ.
fn around(delta: &[f64], bits: i32) -> Arc<[[f64; 2]]> {
    let count = f64::from(2).powi(bits);
    let step = |delta: &f64| (delta * count).floor().min(count - 1.0);
    delta.iter().map(|delta| [0.0, 1.0].map(|end| (step(delta) + end) / count)).collect()
}

/// Numbers from 0 to 1.
fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 31)
    };
    (0..count).map(|_| next()).collect()
}

fn assert_within(delta: &[f64], intervals: &[[f64; 2]]) {
    for (delta, [low, high]) in delta.iter().zip(intervals) {
        assert!(low < delta && delta < high, "{delta} in {low}..{high}");
    }
}

#[test]
fn the_whole_grid_edge_changes_no_bit() {
    let volumes =
        [phantom::linked_tori(24).unwrap(), phantom::noise(&grid([9; 3]), 0.4, 3).unwrap()];
    for volume in &volumes {
        let surface = closed(volume);
        let whole: Arc<[[f64; 2]]> = vec![[0.0, 1.0]; surface.vertex_count()].into();
        for settings in ways() {
            let none = run(&surface, &settings);
            let all = Settings { intervals: Some(whole.clone()), ..settings.clone() };
            assert_eq!(run(&surface, &all), none);
        }
    }
}

fn grid(dims: [usize; 3]) -> Grid {
    Grid::new(dims, [1.0, 0.8, 2.0]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn every_vertex_stays_in_its_interval(
        volume in volumes(), seed in any::<u64>(), bits in 0i32..=8
    ) {
        for (faces, border) in CONVENTIONS {
            let surface = Surface::extract(&volume, faces, border).unwrap();
            let intervals = around(&random(surface.vertex_count(), seed), bits);
            for settings in ways() {
                let found =
                    run(&surface, &Settings { intervals: Some(intervals.clone()), ..settings });
                assert_within(&found.delta, &intervals);
                for round in &found.report.rounds {
                    for pair in round.energies.windows(2) {
                        prop_assert!(pair[1] <= pair[0] * (1.0 + 1e-12) + 1e-24, "{pair:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn tiles_keep_to_their_intervals() {
    let surface = closed(&phantom::sphere(190).unwrap());
    assert!(surface.vertex_count() > 100_000);
    let intervals = around(&random(surface.vertex_count(), 1), 3);
    let settings = Settings { intervals: Some(intervals.clone()), ..Settings::default() };
    assert_within(&run(&surface, &settings).delta, &intervals);
}

/// δ of a ball's own surface.
fn of_ball(surface: &Surface, centre: [f64; 3], radius: f64) -> Vec<f64> {
    let level = |point: [f64; 3]| {
        radius * radius - (0..3).map(|k| (point[k] - centre[k]).powi(2)).sum::<f64>()
    };
    let delta = |crossing: shrouds::surface::Crossing| {
        let ends = [crossing.outside(), crossing.inside()];
        let [outside, inside] = ends.map(|end| surface.grid().point(end.map(|x| x as f64)));
        let at = |t: f64| level(std::array::from_fn(|k| (1.0 - t) * outside[k] + t * inside[k]));
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if at(middle) > 0.0 { high = middle } else { low = middle }
        }
        low
    };
    surface.crossings().map(delta).collect()
}

#[test]
fn what_is_known_brings_it_to_the_true_surface() {
    let (centre, radius) = ([14.2, 13.7, 14.1], 10.3);
    let grid = Grid::new([29; 3], [1.0; 3]).unwrap();
    let volume = Occupancy::from_fn(grid, |point| {
        (0..3).map(|k| (point[k] as f64 - centre[k]).powi(2)).sum::<f64>() <= radius * radius
    });
    let surface = closed(&volume);
    let truth = of_ball(&surface, centre, radius);
    let error = |delta: &mut dyn Iterator<Item = f64>| {
        let squares: f64 = delta.zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / truth.len() as f64).sqrt()
    };
    for bits in [1, 2, 4] {
        let intervals = around(&truth, bits);
        let settings = Settings {
            preset: Preset::Exact,
            intervals: Some(intervals.clone()),
            ..Settings::default()
        };
        let found = run(&surface, &settings).delta;
        let middles = error(&mut intervals.iter().map(|[low, high]| 0.5 * (low + high)));
        let found = error(&mut found.into_iter());
        assert!(found < 0.4 * middles, "{bits} bits: {found}, middles {middles}");
    }
}

#[test]
fn one_vertex_alone_stays_in_its_interval() {
    let surface = closed(&phantom::linked_tori(20).unwrap());
    let delta = vec![0.5; surface.vertex_count()];
    let intervals = around(&random(delta.len(), 9), 4);
    let settings = Settings { intervals: Some(intervals.clone()), ..Settings::default() };
    for v in [0, 100, delta.len() - 1] {
        let found = minimise_vertex(&surface, &settings, &delta, v as u32).unwrap();
        assert_within(&[found], &intervals[v..=v]);
    }
}

#[test]
fn what_are_no_intervals_is_refused() {
    let surface = closed(&phantom::linked_tori(20).unwrap());
    let count = surface.vertex_count();
    let refused = |intervals: Vec<[f64; 2]>, volume, part: &str| {
        let settings = Settings { intervals: Some(intervals.into()), volume, ..Default::default() };
        let error = optimize(&surface, &settings, &mut |_| ControlFlow::Continue(())).unwrap_err();
        assert!(matches!(error, Error::Setting { .. }));
        assert!(error.to_string().contains(part), "{error}");
    };
    let whole = vec![[0.0, 1.0]; count];
    refused(whole[1..].to_vec(), VolumeRule::Free, "one for each vertex");
    refused(whole.clone(), VolumeRule::Keep, "free where intervals are given");
    // The last one lies within the margin of 0.002.
    let odd = [[0.7, 0.3], [-0.1, 0.5], [0.5, 1.1], [f64::NAN, 1.0], [0.5, 0.5], [0.0, 0.0025]];
    for odd in odd {
        let mut intervals = whole.clone();
        intervals[count / 2] = odd;
        refused(intervals, VolumeRule::Free, "0.001 wide");
    }
}
