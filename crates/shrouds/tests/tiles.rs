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
