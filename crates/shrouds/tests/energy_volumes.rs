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

#[test]
fn the_exact_preset_keeps_rods_of_all_lengths_and_voxels_of_all_shapes() {
    let share = |counts: [usize; 3], spacing: [f64; 3]| {
        let grid = Grid::new(counts.map(|n| n + 4), spacing).unwrap();
        let block = |point: [usize; 3]| (0..3).all(|d| (2..2 + counts[d]).contains(&point[d]));
        let volume = Occupancy::from_fn(grid, block);
        let optimize =
            optimize::Settings { preset: Preset::Exact, ..optimize::Settings::default() };
        let shroud = shroud(&volume, &Settings { optimize, ..Settings::default() }).unwrap();
        assert_eq!(shroud.report.status, Status::Converged, "{counts:?} {spacing:?}");
        let middle = [0, 1, 2].map(|d| spacing[d] * (1.5 + counts[d] as f64 / 2.0));
        let vertices = &shroud.mesh.vertices;
        for d in 0..3 {
            let mean = vertices.iter().map(|v| v[d]).sum::<f64>() / vertices.len() as f64;
            assert!((mean - middle[d]).abs() < 0.01 * spacing[d], "{counts:?} {spacing:?}: {mean}");
        }
        let voxels = (counts.iter().product::<usize>() as f64) * spacing.iter().product::<f64>();
        shroud.mesh.volume() / voxels
    };
    for counts in [[2, 1, 1], [1, 3, 1], [1, 1, 8], [24, 1, 1], [1, 60, 1], [2, 2, 24], [2, 2, 2]] {
        let share = share(counts, [1.0; 3]);
        assert!((0.5..1.3).contains(&share), "{counts:?}: {share}");
    }
    // A voxel that is not a cube has curves of unlike sizes.
    for spacing in [[1.0, 1.0, 3.0], [2.0, 0.5, 3.0], [1.0, 10.0, 100.0]] {
        let share = share([1; 3], spacing);
        assert!((0.4..1.3).contains(&share), "{spacing:?}: {share}");
    }
}
