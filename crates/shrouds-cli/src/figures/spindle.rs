//! Figure 7: a scaffold of thin tubes like a meiotic spindle, on 29 × 121 × 28 points.

use std::f64::consts::{PI, TAU};

use shrouds::Grid;
use shrouds_view::Scene;

use super::data::of_field;
use super::panel::{Look, column, contour_lines, exact, midpoint, reach};
use super::{Data, Figure, Table};
use crate::failure::Failure;

/// The paper's spindle lies along its second axis; ours along x.
const DIMS: [usize; 3] = [121, 29, 28];
const TUBES: usize = 7;
/// Radius of a tube, and that of the bundle at its middle, in lattice steps.
const TUBE: f64 = 1.5;
const BUNDLE: f64 = 10.0;

pub(super) fn figure(_: &Data) -> Result<Figure, Failure> {
    let body = of_field(Grid::new(DIMS, [1.0; 3])?, tubes)?;
    let (midpoint, shroud) = (midpoint(&body.volume)?, exact(&body.volume)?);
    let look = Look::new(-75.0, 25.0, [760, 260]);
    let frame = reach(&midpoint.mesh);
    let contours = contour_lines(&shroud.mesh, 0, 1.0)?;
    let scenes = [
        ("The midpoint surface", Scene::new(&midpoint.mesh)),
        ("The shroud with contours", Scene::new(&shroud.mesh).lines(&contours)),
    ];
    let mut cells = Vec::new();
    for (title, scene) in &scenes {
        cells.push(look.panel([(*title).into(), String::new()], scene, frame)?);
    }
    let parts = shrouds::check::structure(&shroud.mesh)?.components.len();
    let volume = shrouds::measure::integrals(&shroud.mesh)?.volume;
    let voxels = body.volume.count() as f64;
    Ok(Figure {
        name: "figure7",
        title: "A scaffold of thin tubes on 121 × 29 × 28 points",
        paper: "Confocal microscopy of a meiotic spindle on 29 × 121 × 28 points, segmented, and its shroud with \
                contours that show how fair it is.",
        data: format!(
            "{TUBES} tubes of a radius of {TUBE} lattice steps, by formula; not the paper's spindle"
        ),
        picture: column(&cells)?,
        numbers: Table {
            head: vec!["voxels inside", "volume of the shroud", "parts"],
            rows: vec![vec![format!("{voxels}"), format!("{volume:.0}"), parts.to_string()]],
        },
        claims: Vec::new(),
    })
}

/// Tubes from pole to pole, wound a little about each other; positive inside.
fn tubes(unit: [f64; 3]) -> f64 {
    let [x, y, z]: [f64; 3] = std::array::from_fn(|a| unit[a] * (DIMS[a] - 1) as f64);
    let along = (x - 4.0) / (DIMS[0] as f64 - 9.0);
    let beyond = (along.clamp(0.0, 1.0) - along) * (DIMS[0] as f64 - 9.0);
    let t = along.clamp(0.0, 1.0);
    let wide = BUNDLE * (PI * t).sin().powf(0.8);
    let nearest = (0..TUBES)
        .map(|n| {
            let angle = TAU * n as f64 / TUBES as f64 + 1.2 * t + 0.13;
            let middle = [(DIMS[1] - 1) as f64 / 2.0, (DIMS[2] - 1) as f64 / 2.0];
            let away = [y - middle[0] - wide * angle.cos(), z - middle[1] - wide * angle.sin()];
            (away[0].powi(2) + away[1].powi(2) + beyond.powi(2)).sqrt()
        })
        .fold(f64::INFINITY, f64::min);
    TUBE - nearest
}
