//! The comparison as a table for people.

use super::Comparison;
use super::row::{Multistart, Numbers, Outcome, Row};
use crate::console::{aligned, grouped, number};

const NONE: &str = "-";

/// A column: its two lines of heading, and what it shows of a row.
struct Column {
    heading: [&'static str; 2],
    show: fn(&Numbers) -> String,
}

const USUAL: [Column; 10] = [
    Column { heading: ["", "steps"], show: |n| n.iterations.to_string() },
    Column { heading: ["time", "s"], show: |n| format!("{:.2}", n.seconds) },
    Column { heading: ["energy", "first"], show: |n| number(n.value.first) },
    Column { heading: ["energy", "last"], show: |n| number(n.value.last) },
    Column { heading: ["volume", "%"], show: |n| optional(n.volume_error, |x| format!("{x:+.2}")) },
    Column { heading: ["", "area"], show: |n| number(n.area) },
    Column { heading: ["rough", "degrees"], show: |n| format!("{:.2}", n.roughness) },
    Column { heading: ["move", "edges"], show: |n| format!("{:.3}", n.largest_move) },
    Column { heading: ["bound", "%"], show: |n| format!("{:.2}", 100.0 * n.at_bound) },
    Column { heading: ["wrong", "side"], show: |n| n.wrong_side.to_string() },
];

const AGAINST_TRUTH: [Column; 2] = [
    Column { heading: ["distance", "RMS"], show: |n| optional(n.distance, |x| format!("{x:.4}")) },
    Column { heading: ["normals", "degrees"], show: |n| optional(n.normal, |x| format!("{x:.2}")) },
];

const MULTISTART: [Column; 3] = [
    Column { heading: ["starts", "RMS"], show: |n| starts(n, |s| s.difference.rms) },
    Column { heading: ["starts", "largest"], show: |n| starts(n, |s| s.difference.max) },
    Column { heading: ["starts", "energy %"], show: |n| starts(n, |s| 100.0 * s.spread) },
];

fn optional(value: Option<f64>, show: impl Fn(f64) -> String) -> String {
    value.map_or(NONE.into(), show)
}

fn starts(numbers: &Numbers, value: impl Fn(&Multistart) -> f64) -> String {
    optional(numbers.multistart.as_ref().map(value), |x| match x {
        1e-4.. => format!("{x:.4}"),
        _ => format!("{x:.0e}"),
    })
}

/// Title, table and what its columns mean.
pub(super) fn table(comparison: &Comparison) -> String {
    let rows = &comparison.energies;
    let any = |has: fn(&Numbers) -> bool| {
        rows.iter().any(|row| matches!(&row.outcome, Outcome::Done(numbers) if has(numbers)))
    };
    let (truth, multistart) = (any(|n| n.distance.is_some()), any(|n| n.multistart.is_some()));
    let mut columns: Vec<&Column> = USUAL.iter().collect();
    columns.extend(AGAINST_TRUTH.iter().filter(|_| truth));
    columns.extend(MULTISTART.iter().filter(|_| multistart));

    let heading = |line: usize| {
        let names = [["", ""], ["energy", "status"]][line];
        let rest = columns.iter().map(|column| column.heading[line]);
        names.into_iter().chain(rest).map(str::to_owned).collect::<Vec<_>>()
    };
    let mut lines = vec![heading(0), heading(1)];
    lines.extend(rows.iter().map(|row| cells(row, &columns)));
    let mut text = vec![title(comparison), String::new()];
    text.extend(aligned(&lines, 2));
    text.push(String::new());
    text.extend(rows.iter().filter_map(error));
    text.extend(notes(rows, truth, multistart));
    text.join("\n")
}

fn title(comparison: &Comparison) -> String {
    let input = &comparison.input;
    let [nx, ny, nz] = input.lattice.dims;
    let preset =
        comparison.settings.preset.map_or("sweeps".into(), |preset| format!("preset {}", preset));
    format!(
        "{}: {} voxels inside, of {nx} × {ny} × {nz}; {preset}",
        input.file,
        grouped(input.inside)
    )
}

fn cells(row: &Row, columns: &[&Column]) -> Vec<String> {
    let mark = if row.keeps_thin_parts { "" } else { " *" };
    let mut cells = vec![format!("{}{mark}", row.name), row.status.to_owned()];
    match &row.outcome {
        Outcome::Done(numbers) => cells.extend(columns.iter().map(|column| (column.show)(numbers))),
        Outcome::Failed { .. } => cells.extend(columns.iter().map(|_| NONE.to_owned())),
    }
    cells
}

fn error(row: &Row) -> Option<String> {
    match &row.outcome {
        Outcome::Failed { error } => Some(format!("{}: {error}", row.name)),
        Outcome::Done(_) => None,
    }
}

fn notes(rows: &[Row], truth: bool, multistart: bool) -> Vec<String> {
    let mut notes = vec![
        "volume: of the mesh against the count of voxels. rough: angle between neighbouring triangles, RMS weighted",
        "by edge length. move: the largest from the middle of a grid edge. bound: share of vertices at an end of theirs.",
    ];
    if truth {
        notes.push("distance, normals: RMS over the area, against the true surface, in voxels and degrees.");
    }
    if multistart {
        notes.push("starts: how far results of random starts lie from the one shown, in edge lengths; spread of their energies.");
    }
    if rows.iter().any(|row| !row.keeps_thin_parts) {
        notes.push("* may destroy parts one voxel thin.");
    }
    notes.into_iter().map(str::to_owned).collect()
}
