//! Figure 6: a bone on 32 × 96 × 32 points.

use shrouds_view::Scene;

use super::data::Fit;
use super::panel::{Look, exact, midpoint, reach, row};
use super::{Data, Figure, Table};
use crate::console::grouped;
use crate::failure::Failure;
use crate::picture::network_lines;

/// The paper's bone lies along its second axis; ours stands along z.
const DIMS: [usize; 3] = [32, 32, 96];

pub(super) fn figure(data: &Data) -> Result<Figure, Failure> {
    let body = data.body("femur.ply", DIMS, Fit::Stretched, bone)?;
    let (midpoint, shroud) = (midpoint(&body.volume)?, exact(&body.volume)?);
    let look = Look::new(-60.0, 8.0, [300, 560]);
    let frame = reach(&midpoint.mesh);
    let lines = network_lines(&shroud);
    let scene = lines.iter().fold(Scene::new(&shroud.mesh), |scene, set| scene.lines(set));
    let vertices = grouped(shroud.delta.len() as u64);
    let cells = [
        look.panel(
            ["The midpoint surface".into(), String::new()],
            &Scene::new(&midpoint.mesh),
            frame,
        )?,
        look.panel(["The shroud".into(), String::new()], &Scene::new(&shroud.mesh), frame)?,
        look.panel(
            ["... with its 4*-network".into(), format!("{vertices} vertices")],
            &scene,
            frame,
        )?,
    ];
    let inside = grouped(body.volume.count());
    Ok(Figure {
        name: "figure6",
        title: "A bone on 32 × 32 × 96 points",
        paper: "The midpoint surface of a chimpanzee's tibia on 32 × 96 × 32 points, and its optimal shroud \
                with the 4*-network.",
        data: format!("{}, stretched to fill the lattice; not the paper's bone", body.source),
        picture: row(&cells)?,
        numbers: Table {
            head: vec!["voxels inside", "vertices"],
            rows: vec![vec![inside, vertices]],
        },
        claims: Vec::new(),
    })
}

/// A shaft with a head on each end, positive inside.
fn bone([x, y, z]: [f64; 3]) -> f64 {
    let away = ((x - 0.5).powi(2) + (y - 0.5).powi(2)).sqrt();
    let shaft = 0.16 - away + (0.03 - 0.5 * (0.06 - z.min(1.0 - z)).max(0.0));
    let head = |c: [f64; 3], r: f64| {
        r - ((x - c[0]).powi(2) + (y - c[1]).powi(2) + (3.0 * (z - c[2])).powi(2)).sqrt()
    };
    let heads =
        [head([0.36, 0.5, 0.88], 0.3), head([0.64, 0.46, 0.9], 0.28), head([0.5, 0.5, 0.12], 0.3)];
    heads.into_iter().fold(shaft, f64::max)
}
