//! Figure 1: the method in two dimensions.

use std::ops::ControlFlow;

use shrouds::optimize::{Settings, Start, minimise_vertex, optimize};
use shrouds::polygon::place;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy};

use super::panel::{paper, row};
use super::plan::plan;
use super::{Claim, Data, Figure, Table, Verdict};
use crate::failure::Failure;

pub(super) fn figure(_: &Data) -> Result<Figure, Failure> {
    let image = image()?;
    let surface = Surface::of_image(&image, FaceRule::Separate, Border::Closed)?;
    let settings = paper(Start::Midpoint);
    let solve = |limit: Option<usize>| {
        let settings = Settings { max_iterations: limit, ..settings.clone() };
        optimize(&surface, &settings, &mut |_| ControlFlow::Continue(()))
    };

    let middle = vec![0.5; surface.vertex_count()];
    let mut moved = middle.clone();
    let vertex = between(&surface, [11, 4], [12, 4]);
    if let Some(vertex) = vertex {
        moved[vertex] = minimise_vertex(&surface, &settings, &middle, vertex as u32)?;
    }
    let (swept, converged) = (solve(Some(1))?, solve(None)?);
    let [first, one] = swept.report.energy;
    let (last, sweeps) = (converged.report.energy[1], converged.report.iterations);

    let thin = place(&image, &surface, &middle);
    let states = [
        (&moved, "One vertex moved", "on the edge from (11, 4) to (12, 4)".to_owned()),
        (&swept.delta, "One sweep", format!("energy {one:.2}, from {first:.2}")),
        (&converged.delta, "Converged", format!("energy {last:.2}, {sweeps} sweeps")),
    ];
    let mut cells = Vec::new();
    for (n, (delta, title, note)) in states.iter().enumerate() {
        let mark = vertex.filter(|_| n == 0);
        let bold = place(&image, &surface, delta);
        cells.push(plan([(*title).into(), note.clone()], &image, &thin, &bold, mark)?);
    }
    let share = 100.0 * (first - one) / (first - last);
    let line = |state: &str, energy: f64| vec![state.to_owned(), format!("{energy:.3}")];
    Ok(Figure {
        name: "figure1",
        title: "The method in two dimensions",
        paper: "A midpoint separating polygon of which one vertex has been moved to its locally optimal \
                position, the polygon after one complete iteration, and the converged one.",
        data: "a blob on 19 × 15 points; the paper does not give its own".into(),
        picture: row(&cells)?,
        numbers: Table {
            head: vec!["", "energy"],
            rows: vec![line("midpoint", first), line("one sweep", one), line("converged", last)],
        },
        claims: vec![Claim {
            paper: "Only a few iterations are needed",
            measured: format!(
                "the first sweep makes {share:.0} % of the fall; {sweeps} sweeps until δ changes by less \
                 than 1e-6 of itself"
            ),
            verdict: if share > 50.0 { Verdict::InPart } else { Verdict::No },
        }],
    })
}

/// A blob on 19 × 15 points, with bulges and dents.
fn image() -> Result<Occupancy, Failure> {
    const BALLS: [[f64; 3]; 3] = [[5.6, 9.0, 4.3], [14.0, 8.2, 3.0], [8.6, 3.6, 2.3]];
    let field = |[i, j]: [f64; 2]| -> f64 {
        BALLS.iter().map(|[x, y, r]| r * r / ((i - x).powi(2) + (j - y).powi(2))).sum()
    };
    let grid = Grid::new([19, 15, 1], [1.0; 3])?;
    Ok(Occupancy::from_fn(grid, |[i, j, _]| field([i as f64, j as f64]) > 1.4))
}

/// The vertex on the grid edge between two points of the image.
fn between(surface: &Surface, a: [usize; 2], b: [usize; 2]) -> Option<usize> {
    // A closed border is a frame of points around those of the image.
    let [a, b] = [a, b].map(|[i, j]| [i + 1, j + 1, 0]);
    surface.crossings().position(|crossing| {
        let ends = [crossing.inside(), crossing.outside()];
        ends == [a, b] || ends == [b, a]
    })
}
