//! What an observer sees of the optimisation, and starts from δ that are given.

#![allow(clippy::unwrap_used)]

mod common;

use std::ops::ControlFlow;

use proptest::prelude::*;
use shrouds::Error;
use shrouds::energy::Linear;
use shrouds::optimize::{Optimum, Preset, Settings, Solver, Start, Status, optimize};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, Occupancy, phantom};

const PRESETS: [Preset; 3] = [Preset::Fast, Preset::Default, Preset::Exact];

fn surface_of(volume: &Occupancy) -> Surface {
    Surface::extract(volume, FaceRule::Separate, Border::Closed).unwrap()
}

fn solve(surface: &Surface, settings: &Settings) -> Optimum {
    optimize(surface, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// The result, and the δ at every call.
fn watch(surface: &Surface, settings: &Settings) -> (Optimum, Vec<Vec<f32>>) {
    let mut seen = Vec::new();
    let optimum = optimize(surface, settings, &mut |now| {
        seen.push(now.positions.deltas());
        ControlFlow::Continue(())
    });
    (optimum.unwrap(), seen)
}

fn in_single(delta: &[f64]) -> Vec<f32> {
    delta.iter().map(|&delta| delta as f32).collect()
}

fn ways() -> Vec<Settings> {
    let mut ways: Vec<Settings> =
        PRESETS.map(|preset| Settings { preset, ..Settings::default() }).into();
    ways.push(Settings { solver: Solver::Sweeps, tolerance: Some(1e-4), ..Settings::default() });
    ways
}

#[test]
fn the_observer_sees_every_step_and_changes_nothing() {
    let surface = surface_of(&phantom::linked_tori(24).unwrap());
    for settings in ways() {
        let (watched, seen) = watch(&surface, &settings);
        assert_eq!(watched, solve(&surface, &settings));
        assert_eq!(seen.len(), watched.report.iterations);
        assert_eq!(seen.last(), Some(&in_single(&watched.delta)));
        assert!(seen.windows(2).any(|pair| pair[0] != pair[1]) || seen.len() == 1);
    }
}

#[test]
fn the_observer_sees_the_gradient() {
    let surface = surface_of(&phantom::linked_tori(24).unwrap());
    for settings in ways().into_iter().filter(|settings| settings.preset != Preset::Exact) {
        let mut gradients = Vec::new();
        let optimum = optimize(&surface, &settings, &mut |now| {
            gradients.extend(now.gradient);
            ControlFlow::Continue(())
        });
        let report = optimum.unwrap().report;
        assert_eq!(gradients.len(), report.iterations);
        assert_eq!(gradients.last(), Some(&report.projected_gradient));
        let stopped = optimize(&surface, &settings, &mut |_| ControlFlow::Break(()));
        assert_eq!(gradients[0], stopped.unwrap().report.projected_gradient);
    }
}

#[test]
fn a_surface_of_many_tiles_is_seen_too() {
    let surface = surface_of(&phantom::gyroid(200).unwrap());
    assert!(surface.vertex_count() > 500_000);
    for preset in [Preset::Fast, Preset::Default] {
        let (watched, seen) = watch(&surface, &Settings { preset, ..Settings::default() });
        assert_eq!(seen.last(), Some(&in_single(&watched.delta)));
        assert!(seen.len() > 1);
    }
}

#[test]
fn what_was_seen_when_the_work_was_stopped_is_the_result() {
    let surface = surface_of(&phantom::linked_tori(24).unwrap());
    for settings in ways() {
        for calls in 1..3 {
            let mut seen = Vec::new();
            let mut left = calls;
            let optimum = optimize(&surface, &settings, &mut |now| {
                seen = now.positions.deltas();
                left -= 1;
                if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let Optimum { delta, report, .. } = optimum.unwrap();
            assert_eq!(seen, in_single(&delta));
            if left == 0 {
                assert_eq!((report.status, report.iterations), (Status::Cancelled, calls));
            }
        }
    }
}

#[test]
fn from_the_optimum_there_is_no_way_to_go() {
    for size in [20, 24] {
        let surface = surface_of(&phantom::linked_tori(size).unwrap());
        // The weights of bending are frozen where the sweeps began; those of the paper's energy stay.
        let paper = Some(Linear::default().into());
        for (solver, energy) in [(Solver::Newton, None), (Solver::Sweeps, paper)] {
            let exact = Settings { preset: Preset::Exact, solver, energy, ..Settings::default() };
            let optimum = solve(&surface, &exact);
            assert_eq!(optimum.report.status, Status::Converged);
            let start = Start::Given(optimum.delta.as_slice().into());
            let again = solve(&surface, &Settings { start, ..exact.clone() });
            assert_eq!(again.report.status, Status::Converged);
            let [before, now] = [&optimum, &again].map(|optimum| optimum.report.iterations);
            assert!(now <= 4 && 3 * now <= before, "{solver:?}: {now} steps after {before}");
            let squares = optimum.delta.iter().zip(&again.delta).map(|(a, b)| (a - b).powi(2));
            let rms = (squares.sum::<f64>() / optimum.delta.len() as f64).sqrt();
            assert!(rms <= exact.tolerance(), "{solver:?}: {rms}");
        }
    }
}

#[test]
fn given_deltas_that_fit_no_vertex_are_refused() {
    let surface = surface_of(&phantom::sphere(12).unwrap());
    let count = surface.vertex_count();
    for (start, part) in [
        (vec![0.5; count - 1], "one for each vertex"),
        (vec![f64::NAN; count], "between 0 and 1"),
        (vec![1.5; count], "between 0 and 1"),
    ] {
        let settings = Settings { start: Start::Given(start.into()), ..Settings::default() };
        let error = optimize(&surface, &settings, &mut |_| ControlFlow::Continue(())).unwrap_err();
        assert!(matches!(error, Error::Setting { .. }));
        assert!(error.to_string().contains(part), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn given_deltas_are_where_the_work_starts(
        (volume, seed) in (common::volumes(), any::<u64>())
    ) {
        let surface = surface_of(&volume);
        let none = |start| Settings { start, max_iterations: Some(0), ..Settings::default() };
        let random = solve(&surface, &none(Start::Random(seed))).delta;
        let given = solve(&surface, &none(Start::Given(random.as_slice().into()))).delta;
        prop_assert!(random.iter().zip(&given).all(|(a, b)| (a - b).abs() < 1e-7));
    }
}
