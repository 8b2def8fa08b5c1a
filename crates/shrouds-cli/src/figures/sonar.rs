//! Figures 9 to 11: where a target can be that a towed array hears.

use shrouds::containment::{Extent, Membership, Step};
use shrouds_view::Cell;

use super::panel::{exact, row};
use super::{Claim, Data, Figure, Table, Verdict};
use crate::console::grouped;
use crate::failure::Failure;
use crate::picture::View;
use crate::scene::{self, Painter, Told};

const REGION: [u8; 3] = [222, 184, 128];
/// Pixels of a panel.
const SIZE: [u32; 2] = [560, 420];
/// In cubic metres.
const CUBIC_KILOMETRE: f64 = 1e9;

pub(super) fn figure_9(_: &Data) -> Result<Figure, Failure> {
    let told = scene::example("figure9")?;
    figure(
        &told,
        Words {
            name: "figure9",
            title: "An annulus that the sea floor reflects",
            paper: "The geometry of towed sonar: the target is known to be in the reflected annulus.",
            data: "`examples/scenes/figure9.toml`: one contact by way of a level floor",
        },
    )
}

pub(super) fn figure_10(_: &Data) -> Result<Figure, Failure> {
    let told = scene::example("figure10")?;
    figure(
        &told,
        Words {
            name: "figure10",
            title: "What the shape of the sea floor does to it",
            paper: "The effect of the bathymetry on the containment region, an artist's rendition.",
            data: "`examples/scenes/figure10.toml`: the same over a fractal terrain, computed",
        },
    )
}

pub(super) fn figure_11(_: &Data) -> Result<Figure, Failure> {
    let told = scene::example("figure11")?;
    figure(
        &told,
        Words {
            name: "figure11",
            title: "A containment region over time",
            paper: "The region that contains the target as an enumerated volume, displayed with its optimal \
                separating surface.",
            data: "`examples/scenes/figure11.toml`: contacts on a target of which only the bearing is heard",
        },
    )
}

/// What is said of a scene.
struct Words {
    name: &'static str,
    title: &'static str,
    paper: &'static str,
    data: &'static str,
}

/// The first, the middle and the last region, as far as there are so many.
fn figure(told: &Told, words: Words) -> Result<Figure, Failure> {
    let painter = Painter::new(told, View::small(SIZE, None), REGION);
    let steps = told.scene.steps(Membership::Centre).collect::<Result<Vec<Step>, _>>()?;
    let last = steps.len().saturating_sub(1);
    let mut shown = vec![0, last / 2, last];
    shown.dedup();
    let (mut cells, mut rows) = (Vec::new(), Vec::new());
    for (n, step) in steps.iter().enumerate() {
        let Some(extent) = Extent::of(&step.region) else { continue };
        let volume = format!("{:.2}", extent.volume / CUBIC_KILOMETRE);
        let points = grouped(extent.points);
        if shown.contains(&n) {
            let picture = painter.draw(step, &exact(&step.region)?.mesh)?;
            let title = format!("contact {}, after {:.0} s", n + 1, step.time);
            cells.push(Cell { picture, title, note: format!("{volume} km3") });
        }
        rows.push(vec![(n + 1).to_string(), format!("{:.0}", step.time), points, volume]);
    }
    Ok(Figure {
        name: words.name,
        title: words.title,
        paper: words.paper,
        data: words.data.into(),
        picture: row(&cells)?,
        numbers: Table { head: vec!["contact", "time, s", "points inside", "volume, km³"], rows },
        claims: shrinking(&steps).into_iter().collect(),
    })
}

/// That the region gets smaller by what is heard, where there is more than one contact.
fn shrinking(steps: &[Step]) -> Option<Claim> {
    if steps.len() < 2 {
        return None;
    }
    let smaller = steps.iter().filter(|step| step.region.count() < step.grown).count();
    Some(Claim {
        paper: "Each new annulus is intersected with the region grown since the one before",
        measured: format!(
            "{smaller} of {} intersections take something away, none adds",
            steps.len()
        ),
        verdict: Verdict::of(steps.iter().all(|step| step.region.count() <= step.grown)),
    })
}
