//! Every energy on volumes: noise, thin parts, nothing at all.

#![allow(clippy::unwrap_used)]

mod common;

use common::{CONVENTIONS, volumes};
use proptest::prelude::*;
use shrouds::energy::{Energy, Parameter, catalogue};
use shrouds::optimize::{self, Preset, Solver, Start, Status};
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy, Settings, shroud};

/// All measures with all parametrisations, and sums.
fn energies() -> Vec<Energy> {
    let mut texts: Vec<String> = catalogue().iter().map(|entry| entry.name.into()).collect();
    for name in ["curvature", "linear", "stretch"] {
        texts.extend(Parameter::ALL.map(|p| format!("{name}({p})")));
    }
    texts.extend(["angle(cosine)", "tension(3,foley)", "bending+0.3*variation"].map(String::from));
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn settings(energy: &Energy, faces: FaceRule, border: Border, steps: usize) -> Settings {
    let optimize = optimize::Settings {
        energy: Some(energy.clone()),
        preset: Preset::Exact,
        max_iterations: Some(steps),
        ..optimize::Settings::default()
    };
    Settings { faces, border, optimize, ..Settings::default() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    #[test]
    fn on_noise_everything_is_finite_and_on_its_side(volume in volumes(), seed in any::<u64>()) {
        for (n, energy) in energies().into_iter().enumerate() {
            let (faces, border) = CONVENTIONS[(n + seed as usize % 4) % 4];
            let mut settings = settings(&energy, faces, border, 3);
            settings.optimize.start = Start::Random(seed);
            for solver in [Solver::Newton, Solver::Sweeps] {
                settings.optimize.solver = solver;
                let shroud = shroud(&volume, &settings).unwrap();
                let margin = 0.002 - 1e-15..=0.998 + 1e-15;
                prop_assert!(shroud.delta.iter().all(|d| margin.contains(d)), "{energy}");
                let report = &shroud.report;
                prop_assert!(report.energy.iter().all(|e| e.is_finite()), "{energy}");
                for round in &report.rounds {
                    for pair in round.energies.windows(2) {
                        // At nothing the last digits are all there is.
                        prop_assert!(pair[1] <= pair[0] * (1.0 + 1e-12) + 1e-24, "{energy} {pair:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn an_empty_volume_has_an_empty_surface() {
    let volume = Occupancy::empty(Grid::new([4, 4, 4], [1.0; 3]).unwrap());
    for energy in energies() {
        let settings = settings(&energy, FaceRule::Separate, Border::Closed, 4);
        let shroud = shroud(&volume, &settings).unwrap();
        assert_eq!((shroud.report.status, shroud.delta.len()), (Status::Empty, 0), "{energy}");
    }
}

/// A point, a rod, a plate, a chain and a stair of single voxels.
fn thin_parts() -> [Occupancy; 5] {
    let of =
        |dims, f: fn([usize; 3]) -> bool| Occupancy::from_fn(Grid::new(dims, [1.0; 3]).unwrap(), f);
    [
        of([5, 5, 5], |p| p == [2; 3]),
        of([5, 5, 20], |[i, j, k]| i == 2 && j == 2 && (2..18).contains(&k)),
        of([20, 20, 5], |[i, j, k]| k == 2 && (2..18).contains(&i) && (2..18).contains(&j)),
        of([20, 20, 20], |[i, j, k]| i == j && j == k && (2..18).contains(&k)),
        of([20, 20, 5], |[i, j, k]| {
            k == 2 && (2..17).contains(&i) && (2..17).contains(&j) && (i == j || i == j + 1)
        }),
    ]
}

#[test]
fn the_catalogue_tells_the_truth_about_thin_parts() {
    for entry in catalogue() {
        let energy: Energy = entry.name.parse().unwrap();
        let shares = |preset| {
            thin_parts().map(|volume| {
                let mut settings = settings(&energy, FaceRule::Separate, Border::Closed, 100);
                settings.optimize.preset = preset;
                shroud(&volume, &settings).unwrap().mesh.volume() / volume.count() as f64
            })
        };
        // The default preset is to keep them too, though far from the minimum.
        let presets: &[Preset] = match entry.name {
            "bending" => &[Preset::Default, Preset::Exact],
            _ => &[Preset::Exact],
        };
        for &preset in presets {
            let shares = shares(preset);
            let kept = shares.iter().all(|share| (0.5..1.3).contains(share));
            assert_eq!(kept, entry.keeps_thin_parts, "{} {preset:?}: {shares:.3?}", entry.name);
        }
    }
}
