//! The contact sheet: every surface from the same side, at the same scale.

use shrouds::mesh::place_vertices;
use shrouds::{Shroud, TriMesh};
use shrouds_view::{Cell, Picture};

use super::row::{Outcome, Row};
use crate::failure::Failure;
use crate::picture::View;
use shrouds_report::looks::bounds;

/// Pixels of each picture.
const SIZE: [u32; 2] = [480, 400];
const PAPER: [u8; 3] = [255, 255, 255];

#[derive(Default)]
pub(super) struct Sheet {
    cells: Vec<Cell>,
    /// A box around all that the vertices can reach, once it is known.
    frame: Option<[[f64; 3]; 2]>,
}

impl Sheet {
    /// Adds the picture of an energy, an empty one if it has no surface.
    pub(super) fn add(&mut self, row: &Row, shroud: Option<&Shroud>) -> Result<(), Failure> {
        self.frame = self.frame.or_else(|| shroud.and_then(reach));
        let nothing = TriMesh::default();
        let mesh = shroud.map_or(&nothing, |shroud| &shroud.mesh);
        let view = View::small(SIZE, self.frame);
        self.cells.push(Cell {
            picture: view.draw(mesh, &[])?,
            title: row.name.clone(),
            note: note(row),
        });
        Ok(())
    }

    /// About as wide as high.
    pub(super) fn finish(self) -> Result<Picture, Failure> {
        let columns = (1..).find(|columns| columns * columns >= self.cells.len() as u32);
        Ok(Picture::sheet(&self.cells, columns.unwrap_or(1), PAPER)?)
    }
}

/// The number that tells energies apart best, and whether it is that of a minimum.
fn note(row: &Row) -> String {
    let Outcome::Done(numbers) = &row.outcome else { return row.status.into() };
    let volume = numbers.volume_error.map_or("open".into(), |error| format!("{error:+.2} %"));
    match row.status {
        "converged" => format!("volume {volume}"),
        status => format!("volume {volume}, {status}"),
    }
}

/// From the outer to the inner ends of all grid edges.
fn reach(shroud: &Shroud) -> Option<[[f64; 3]; 2]> {
    let ends = [0.0, 1.0]
        .map(|delta| place_vertices(&shroud.surface, &vec![delta; shroud.surface.vertex_count()]));
    bounds(ends.into_iter().flatten())
}
