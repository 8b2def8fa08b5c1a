//! Surfaces of several tiles.

use shrouds::optimize::{Preset, Settings as Solver, Status};
use shrouds::{Settings, shroud, volume::phantom};

/// A gyroid cut by a ball: smooth within, sharp where it ends, so that tiles are unlike each other. The
/// passes cut it at other places each time, and must all seek the same surface.
#[test]
fn passes_over_shifted_tiles_come_to_rest() {
    let volume = phantom::gyroid(128).unwrap();
    let optimize = Solver { preset: Preset::Exact, ..Solver::default() };
    let found = shroud(&volume, &Settings { optimize, ..Settings::default() }).unwrap();
    let vertices = found.delta.len();
    assert!(vertices > 100_000, "{vertices} vertices are one tile");
    assert_eq!(found.report.status, Status::Converged, "{:?}", found.report.iterations);
}

#[test]
fn where_a_body_lies_in_its_volume_does_not_matter() {
    let volume = phantom::linked_tori(24).unwrap().padded(2).unwrap();
    let optimize = Solver { preset: Preset::Exact, ..Solver::default() };
    let settings = Settings { optimize, ..Settings::default() };
    let here = shroud(&volume, &settings).unwrap();
    let there = shroud(&volume.padded_by([[3, 1], [5, 2], [1, 6]]).unwrap(), &settings).unwrap();
    assert_eq!(here.delta, there.delta);
}
