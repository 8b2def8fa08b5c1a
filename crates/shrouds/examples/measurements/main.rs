//! Measures shrouds of bodies whose measures are known, and prints a line of CSV for each.
//!
//! `cargo xtask measurements` makes the tables of docs/measurements.md from it. Bodies are turned at random and
//! lie anywhere between the voxels; the same seeds give the same bodies on every machine.

#![allow(missing_docs)]

#[path = "../../tests/common/bodies.rs"]
mod bodies;
mod edges;
mod measured;
mod npy;
#[path = "../../tests/common/random_bodies.rs"]
mod random_bodies;

use std::path::Path;
use std::process::ExitCode;

use bodies::{BODIES, Body, Random};
use measured::{Case, HEAD, print};
use random_bodies::Sample;
use shrouds::mesh::MeshKind;
use shrouds::optimize::Preset;

const HELP: &str = "\
Measures of shrouds of bodies with known ones, as CSV.

Usage: measurements accuracy POSITIONS     bodies of radius 5, 10, 20 and 50, all ways
       measurements edges                  boxes and thin bodies
       measurements calibration COUNT      random bodies that the errors are fitted to
       measurements judged COUNT           random bodies of other kinds that they are judged on
       measurements peers FOLDER           some bodies, with their volumes as NPY
";

/// Presets and meshes that are measured.
const PRESETS: [Preset; 2] = [Preset::Exact, Preset::Default];
const MESHES: [MeshKind; 2] = [MeshKind::Primal, MeshKind::Dual];
const SPACINGS: [[f64; 3]; 2] = [[1.0; 3], [1.0, 1.0, 3.0]];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let number = |text: &str| text.parse::<u64>();
    println!("{HEAD}");
    match (&arguments[..], arguments.get(1).map(|text| number(text))) {
        (["accuracy", _], Some(Ok(positions))) => accuracy(positions),
        (["edges"], _) => edges::edges(),
        (["calibration", _], Some(Ok(count))) => random(count, random_bodies::calibration),
        (["judged", _], Some(Ok(count))) => {
            random(count, |random| random_bodies::judged(random, 50.0))
        }
        (["peers", folder], _) => return peers(Path::new(folder)),
        _ => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

fn accuracy(positions: u64) {
    for spacing in SPACINGS {
        for radius in [5.0, 10.0, 20.0, 50.0] {
            for (name, shape) in BODIES {
                for seed in 0..positions {
                    let (body, volume) =
                        Body::random(shape(radius), spacing, &mut Random(1000 * seed + 7));
                    let case = Case { name, radius, body: &body, volume: &volume };
                    PRESETS.into_iter().for_each(|preset| print(&case, preset, &MESHES));
                }
            }
        }
    }
}

/// Bodies with their names and spacings, by the number of each.
fn random(count: u64, make: fn(&mut Random) -> Sample) {
    for seed in 0..count {
        let mut random = Random(seed * 0x5851_f42d + 99);
        let (name, shape, spacing) = make(&mut random);
        let (body, volume) = Body::random(shape, spacing, &mut random);
        let case = Case { name, radius: 0.0, body: &body, volume: &volume };
        print(&case, Preset::Exact, &MESHES[..1]);
    }
}

fn peers(folder: &Path) -> ExitCode {
    for spacing in SPACINGS {
        for radius in [10.0, 20.0] {
            for (name, shape) in BODIES {
                let (body, volume) = Body::random(shape(radius), spacing, &mut Random(42));
                let case = Case { name, radius, body: &body, volume: &volume };
                print(&case, Preset::Exact, &MESHES[..1]);
                let path = folder.join(format!("{name}-{radius}-{}.npy", spacing[2]));
                if let Err(error) = npy::write(&path, &volume) {
                    eprintln!("{}: {error}", path.display());
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    ExitCode::SUCCESS
}
