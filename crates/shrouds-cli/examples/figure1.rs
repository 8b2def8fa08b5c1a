//! Figure 1 of the paper: the method in two dimensions, in three states.
//!
//! `cargo run --release --example figure1 [FILE]` writes them side by side to FILE, `figure1.svg` if
//! none is given.

use std::error::Error;
use std::ops::ControlFlow;

use shrouds::optimize::{Settings, Solver, Start, Status, minimise_vertex, optimize};
use shrouds::polygon::{Polygon, place};
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy};
use shrouds_io::write_atomically;
use shrouds_view::Plan;

fn main() -> Result<(), Box<dyn Error>> {
    let image = image()?;
    let surface = Surface::of_image(&image, FaceRule::Separate, Border::Closed)?;
    let settings =
        Settings { solver: Solver::Sweeps, start: Start::Midpoint, ..Settings::default() };

    // The midpoint polygon, with the point between (11, 4) and (12, 4) where the energy is least.
    let middle = vec![0.5; surface.vertex_count()];
    let vertex = between(&surface, [11, 4], [12, 4]).ok_or("no vertex there")?;
    let mut one_moved = middle.clone();
    one_moved[vertex] = minimise_vertex(&surface, &settings, &middle, vertex as u32)?;

    let one_sweep = Settings { max_iterations: Some(1), ..settings.clone() };
    let solve =
        |settings: &Settings| optimize(&surface, settings, &mut |_| ControlFlow::Continue(()));
    let swept = solve(&one_sweep)?;
    let converged = solve(&settings)?;

    let [thin, moved, swept_polygons, final_polygons] =
        [&middle, &one_moved, &swept.delta, &converged.delta]
            .map(|delta| place(&image, &surface, delta));
    let mark = point_of(&moved, vertex as u32).ok_or("no such point")?;
    let energies = [swept.report.energy[0], swept.report.energy[1], converged.report.energy[1]];
    let is_converged = converged.report.status == Status::Converged;
    let state = if is_converged { "Converged" } else { "Not converged" };
    let titles = [
        "One point moved to where the energy is least".to_owned(),
        format!("One sweep: energy {:.2}, from {:.2}", energies[1], energies[0]),
        format!("{}: energy {:.2}, {} sweeps", state, energies[2], converged.report.iterations),
    ];
    let panel = |n: usize| Plan::new(&image).title(&titles[n]).thin(&thin);
    let panels = [
        panel(0).bold(&moved).mark(mark),
        panel(1).bold(&swept_polygons),
        panel(2).bold(&final_polygons),
    ];
    let path = std::env::args().nth(1).unwrap_or_else(|| "figure1.svg".into());
    let svg = Plan::svg(&panels);
    write_atomically(&path, |writer| writer.write_all(svg.as_bytes()))?;
    println!("{path}: {}", titles.join("; "));
    Ok(())
}

/// A blob on 19 × 15 points, with bulges and dents.
fn image() -> Result<Occupancy, shrouds::Error> {
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

/// Where a vertex lies, in indices of the image.
fn point_of(polygons: &[Polygon], vertex: u32) -> Option<[f64; 2]> {
    polygons.iter().find_map(|polygon| {
        let n = polygon.vertices.iter().position(|&v| v == vertex)?;
        Some(polygon.index[n])
    })
}
