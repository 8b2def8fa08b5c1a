//! How large the faces are in which labels touch each other and the outside.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;
use shrouds::contact::contact_area;
use shrouds::materials::MaterialMesh;
use shrouds::mesh::MeshKind;
use shrouds::volume::Border;
use shrouds_report::measure::shares;

use super::volumes::{Name, Run};
use crate::failure::Failure;
use crate::label_map::{LabelMap, Window};
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

/// The faces between labels of a mesh that has them, from the triangles that both share.
pub(super) fn of_mesh(mesh: &MaterialMesh) -> Vec<Contact> {
    let contact = |([label, other], (_, area)): ([i64; 2], (usize, f64))| Contact {
        label: label.into(),
        name: String::new(),
        other: other.into(),
        other_name: String::new(),
        area,
    };
    mesh.contacts().into_iter().filter(|([_, other], _)| *other != 0).map(contact).collect()
}

/// The faces of labels, which are given with their numbers; those between labels several at a time.
pub(super) fn find(map: &LabelMap, names: &[(u16, Name)], run: &Run) -> Result<Contacts, Failure> {
    // The preset of `mesh` unless one is given: areas are as good, and there are many faces.
    let settings = Job::new(&run.args.shroud, run.args.volume.coordinates())?.settings;
    run.progress.stage("finding the faces between labels");
    let pairs: Vec<([u16; 2], Window)> = map.neighbours().into_iter().collect();
    let begun = AtomicUsize::new(0);
    let segment = |number: u16| {
        let named = names.iter().find(|(n, _)| *n == number);
        named.map_or(String::new(), |(_, name)| name.segment.clone())
    };
    let between = pairs.par_iter().map(|([a, b], window)| {
        let at = begun.fetch_add(1, Ordering::Relaxed) + 1;
        run.progress.part(&format!("contact {at} of {}", pairs.len()));
        let window = map.wider(window, MARGIN);
        let [one, other] = [a, b].map(|label| map.occupancy(&window, |n| n == *label));
        Ok(Contact {
            label: map.label(*a),
            name: segment(*a),
            other: map.label(*b),
            other_name: segment(*b),
            area: contact_area(&one?, &other?, &settings)?,
        })
    });
    let between = between.collect::<Result<_, Failure>>()?;
    run.progress.part("all labels");
    Ok(Contacts { between, outside: outside(map, names, run)? })
}

/// The surface of all labels together, shared out among them: a third of each triangle belongs to the
/// label of the voxel inside of each of its vertices.
fn outside(map: &LabelMap, names: &[(u16, Name)], run: &Run) -> Result<Vec<(i128, f64)>, Failure> {
    let job = run.job;
    let zero = map.number_of(0);
    let all = map.occupancy(&map.whole(), |number| Some(number) != zero)?;
    let mut areas = vec![0.0; usize::from(u16::MAX) + 1];
    let touches_nothing = all.count() == all.grid().point_count() as u64;
    if !(job.settings.border == Border::Open && touches_nothing) {
        let mut settings = job.settings.clone();
        settings.mesh = MeshKind::Primal;
        let shroud = work::shroud_with(&all, &settings, run.progress)?;
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
