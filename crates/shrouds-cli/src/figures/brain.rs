//! Figure 8: a brain from which a piece has been taken.

use shrouds::optimize::Start;
use shrouds::volume::Operation;
use shrouds::volume::phantom::ball;
use shrouds::{Grid, Occupancy, Shroud};
use shrouds_view::Scene;

use super::data::of_field;
use super::panel::{Look, change_in_sweep, contour_lines, exact, limit, midpoint, reach, row};
use super::{Claim, Data, Figure, Table, Verdict};
use crate::console::grouped;
use crate::failure::Failure;

/// Radius of the piece that is missing, in lattice steps.
const CAVITY: f64 = 14.0;
/// Lattice steps between contours.
const STEP: f64 = 4.0;

pub(super) fn figure(data: &Data) -> Result<Figure, Failure> {
    let body = match data.volume("brain.nii.gz")? {
        Some(body) => body,
        None => of_field(Grid::new([124, 160, 124], [1.0; 3])?, folded)?,
    };
    let volume = body.volume.combine(Operation::Subtract, &cavity(&body.volume)?)?;
    let (midpoint, shroud) = (midpoint(&volume)?, exact(&volume)?);
    let contours = contour_lines(&shroud.mesh, 2, STEP * volume.grid().min_spacing())?;
    let side = Look::new(-150.0, 20.0, [440, 420]);
    let top = Look::new(-90.0, 89.9, [440, 420]);
    let frame = reach(&midpoint.mesh);
    let caption = |title: &str, note: String| [title.to_owned(), note];
    let vertices = grouped(shroud.delta.len() as u64);
    let cells = [
        side.panel(
            caption("a: the midpoint surface", format!("{vertices} vertices")),
            &Scene::new(&midpoint.mesh),
            frame,
        )?,
        side.panel(caption("b: the shroud", String::new()), &Scene::new(&shroud.mesh), frame)?,
        top.panel(
            caption("c: from above, with contours", "a cavity in front".into()),
            &Scene::new(&shroud.mesh).lines(&contours),
            frame,
        )?,
    ];
    let change = change_in_sweep(&volume, 4)?;
    let [nx, ny, nz] = volume.grid().dims();
    let limit = limit(&volume, Start::Midpoint)?;
    let state =
        |name: &str, shroud: &Shroud| vec![name.to_owned(), shroud.report.iterations.to_string()];
    Ok(Figure {
        name: "figure8",
        title: "A brain with a cavity",
        paper: "Segmented data of a human brain on 124 × 256 × 256 points: the midpoint surface, the shroud, \
                and a view from above of the region from which a tumour has been removed, with contours.",
        data: format!(
            "{} on {nx} × {ny} × {nz} points, without a ball of a radius of {CAVITY} lattice steps; not the \
             paper's brain",
            body.source
        ),
        picture: row(&cells)?,
        numbers: Table {
            head: vec!["", "iterations"],
            rows: vec![
                state("energy (7), Gauss–Newton to 1e-6", &limit),
                state("preset `exact`", &shroud),
            ],
        },
        claims: vec![Claim {
            paper: "The shroud converges in four iterations to six digits",
            measured: format!("the fourth sweep still changes δ by {change:.1e} of itself"),
            verdict: Verdict::of(change < 1e-6),
        }],
    })
}

/// A ball at the top of the volume, towards its front.
fn cavity(volume: &Occupancy) -> Result<Occupancy, Failure> {
    let [nx, ny, nz] = volume.grid().dims();
    let (i, j) = (nx / 3, 5 * ny / 8);
    let top = (0..nz).rev().find(|&k| volume.get([i, j, k])).unwrap_or(nz / 2);
    let centre = volume.grid().point([i as f64, j as f64, top as f64]);
    let radius = CAVITY * volume.grid().min_spacing();
    Ok(ball(volume.grid(), centre, radius)?)
}

/// An ellipsoid with folds, positive inside.
fn folded([x, y, z]: [f64; 3]) -> f64 {
    let away =
        ((x - 0.5).powi(2) / 0.16 + (y - 0.5).powi(2) / 0.2 + (z - 0.5).powi(2) / 0.13).sqrt();
    let folds = (31.0 * x).sin() * (27.0 * y + 4.0 * z).sin() * (33.0 * z).sin();
    1.0 - away - 0.08 * folds
}
