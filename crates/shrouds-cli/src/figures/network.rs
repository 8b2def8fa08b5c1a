//! Figure 2: a bust with its network, and the three families of planar curves by themselves.

use shrouds::TriMesh;
use shrouds_view::Scene;

use super::data::Fit;
use super::panel::{Look, exact, reach, row};
use super::statue::bust;
use super::{Data, Figure, Table};
use crate::console::grouped;
use crate::failure::Failure;
use crate::picture::network_lines;

const DIMS: [usize; 3] = [48, 64, 56];

pub(super) fn figure(data: &Data) -> Result<Figure, Failure> {
    let body = data.body("bust.ply", DIMS, Fit::Whole, bust)?;
    let shroud = exact(&body.volume)?;
    let families = network_lines(&shroud);
    let frame = reach(&shroud.mesh);
    let look = Look::new(-60.0, 12.0, [380, 460]);
    let scene = families.iter().fold(Scene::new(&shroud.mesh), |scene, set| scene.lines(set));
    let title = format!("{} vertices of valence four", grouped(shroud.delta.len() as u64));
    let mut cells = vec![look.panel(["a: the 4*-network".into(), title], &scene, frame)?];
    let names = ["across x, red", "across y, white in a", "across z, blue"];
    let (nothing, mut rows) = (TriMesh::default(), Vec::new());
    for ((family, name), n) in families.into_iter().zip(names).zip(0..) {
        let mut lines = family;
        if n == 1 {
            // White lines on white paper are not seen.
            lines.colour = [150; 3];
        }
        let count = grouped(lines.segments.len() as u64);
        let note = format!("{count} segments");
        let caption = [format!("b: {name}"), note];
        cells.push(look.panel(caption, &Scene::new(&nothing).lines(&lines), frame)?);
        rows.push(vec![name.to_owned(), count]);
    }
    Ok(Figure {
        name: "figure2",
        title: "The 4*-network of a bust",
        paper: "A bust of Max Planck with its 4*-network, and the three orthogonal families of planar \
                curves it consists of: red, white and blue.",
        data: format!("{}, on {} × {} × {} points", body.source, DIMS[0], DIMS[1], DIMS[2]),
        picture: row(&cells)?,
        numbers: Table { head: vec!["family", "segments"], rows },
        claims: Vec::new(),
    })
}
