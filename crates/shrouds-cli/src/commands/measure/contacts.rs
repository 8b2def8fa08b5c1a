//! How large the faces are in which labels touch each other and the outside.

use serde::Serialize;
use shrouds::contact::contact_area;
use shrouds::mesh::MeshKind;
use shrouds::volume::Border;

use super::body::shares;
use super::volumes::Name;
use crate::failure::Failure;
use crate::label_map::LabelMap;
use crate::progress::Progress;
use crate::settings::Job;
use crate::work;

/// Voxels around a face that decide where it lies.
const MARGIN: usize = 8;

/// The face between two labels.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Contact {
    pub(super) label: i128,
    pub(super) name: String,
    pub(super) other: i128,
    pub(super) other_name: String,
    /// In squared world units.
    pub(super) area: f64,
}

/// All faces.
pub(super) struct Contacts {
    pub(super) between: Vec<Contact>,
    outside: Vec<(i128, f64)>,
}

impl Contacts {
    /// The area in which a label touches the outside.
    pub(super) fn outside_of(&self, label: Option<i128>) -> f64 {
        self.outside.iter().find(|(one, _)| Some(*one) == label).map_or(0.0, |(_, area)| *area)
    }
}

/// The faces of labels, which are given with their numbers.
pub(super) fn find(
    map: &LabelMap,
    names: &[(u16, Name)],
    job: &Job,
    progress: &Progress,
) -> Result<Contacts, Failure> {
    let mut between = Vec::new();
    let pairs = map.neighbours();
    let count = pairs.len();
    progress.stage("finding the faces between labels");
    for (n, ([a, b], window)) in pairs.iter().enumerate() {
        progress.part(&format!("contact {} of {count}", n + 1));
        let window = map.wider(window, MARGIN);
        let [one, other] = [a, b].map(|label| map.occupancy(&window, |n| n == *label));
        let area = contact_area(&one?, &other?, &job.settings)?;
        let title = |number: u16| names.iter().find(|(n, _)| *n == number).map(|(_, name)| name);
        let segment = |number| title(number).map_or(String::new(), |name| name.segment.clone());
        between.push(Contact {
            label: map.label(*a),
            name: segment(*a),
            other: map.label(*b),
            other_name: segment(*b),
            area,
        });
    }
    progress.part("outside");
    let outside = outside(map, names, job, progress)?;
    Ok(Contacts { between, outside })
}

/// The surface of all labels together, shared out among them: a third of each triangle belongs to the
/// label of the voxel inside of each of its vertices.
fn outside(
    map: &LabelMap,
    names: &[(u16, Name)],
    job: &Job,
    progress: &Progress,
) -> Result<Vec<(i128, f64)>, Failure> {
    let zero = map.number_of(0);
    let all = map.occupancy(&map.whole(), |number| Some(number) != zero)?;
    let mut areas = vec![0.0; usize::from(u16::MAX) + 1];
    let touches_nothing = all.count() == all.grid().point_count() as u64;
    if !(job.settings.border == Border::Open && touches_nothing) {
        let mut settings = job.settings.clone();
        settings.mesh = MeshKind::Primal;
        let shroud = work::shroud_with(&all, &settings, progress)?;
        let shift = usize::from(job.settings.border == Border::Closed);
        let crossings = shroud.surface.crossings();
        for (crossing, share) in crossings.zip(shares(&shroud.mesh)) {
            let inside = crossing.inside().map(|i| i - shift);
            areas[usize::from(map.number_at(inside))] += share;
        }
    }
    let area = |number: u16| areas[usize::from(number)];
    Ok(names.iter().map(|(number, _)| (map.label(*number), area(*number))).collect())
}
