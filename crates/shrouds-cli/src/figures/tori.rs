//! Figure 3: two linked tori on 24³ points.

use shrouds::TriMesh;
use shrouds::optimize::Start;
use shrouds::volume::phantom::linked_tori;
use shrouds_view::Scene;

use super::panel::{Look, exact, midpoint, row, swept, swept_to_the_limit};
use super::{Claim, Data, Figure, Table, Verdict};
use crate::console::number;
use crate::failure::Failure;
use crate::truth::Body;

const SIZE: usize = 24;

pub(super) fn figure(_: &Data) -> Result<Figure, Failure> {
    let volume = linked_tori(SIZE)?;
    let one = swept(&volume, Start::Midpoint, 1)?;
    let (limit, ours) = (swept_to_the_limit(&volume)?, exact(&volume)?);
    let ([first, second], last) = (one.report.energy, limit.report.energy[1]);
    let (sweeps, steps) = (limit.report.iterations, ours.report.iterations);
    let states = [
        ("a: the midpoint surface", midpoint(&volume)?, Some(first), 0),
        ("b: one sweep", one, Some(second), 1),
        ("c: the limit", limit, Some(last), sweeps),
        ("ours: preset exact", ours, None, steps),
    ];
    let look = Look::new(-70.0, 35.0, [420, 380]);
    let (mut cells, mut rows) = (Vec::new(), Vec::new());
    for (title, state, energy, iterations) in &states {
        let [distance, normal] = errors(&state.mesh);
        let note = format!("off by {distance:.3} voxels, {normal:.1} degrees");
        cells.push(look.panel([(*title).into(), note], &Scene::new(&state.mesh), None)?);
        rows.push(vec![
            (*title).to_owned(),
            energy.map_or("–".into(), number),
            iterations.to_string(),
            format!("{distance:.3}"),
            format!("{normal:.1}"),
        ]);
    }
    let share = 100.0 * (first - second) / (first - last);
    Ok(Figure {
        name: "figure3",
        title: "Two linked tori on 24³ points",
        paper: "The midpoint surface of points inside one of two linked tori, the surface after one \
                complete iteration, and the limit.",
        data: "the phantom `tori`, by formula".into(),
        picture: row(&cells)?,
        numbers: Table {
            head: vec!["", "energy (7)", "iterations", "distance RMS, voxels", "normal RMS, °"],
            rows,
        },
        claims: vec![
            Claim {
                paper: "One complete iteration shows most of what the limit does",
                measured: format!(
                    "the first sweep makes {share:.0} % of the fall of the energy (7)"
                ),
                verdict: Verdict::of(share > 50.0),
            },
            Claim {
                paper: "Only a few iterations are needed",
                measured: format!("{sweeps} sweeps until δ changes by less than 1e-6 of itself"),
                verdict: Verdict::of(sweeps <= 10),
            },
        ],
    })
}

fn errors(mesh: &TriMesh) -> [f64; 2] {
    let errors = Body::of_phantom("tori", SIZE).and_then(|body| body.errors(mesh));
    errors.map_or([f64::NAN; 2], |errors| [errors.distance, errors.normal])
}
