//! The sonar: regions in which a target can be, contact after contact.

use std::path::PathBuf;

use serde_json::{Value, json};
use shrouds::containment::{Membership, Sea, Step};
use shrouds_view::server::Frame;

use super::place::Places;
use super::request::{SceneSource, Slot};
use super::volumes::{Data, Name};
use super::worker::{Ended, Worker};
use crate::failure::Failure;
use crate::scene::{self, Told};

/// The floor of the sea is shown by so many lines each way, and these by so many points.
const LINES: usize = 16;
const POINTS: usize = 64;

/// The scene of a session, all steps found.
pub(super) struct Sonar {
    name: String,
    told: Told,
    steps: Vec<Step>,
}

impl Worker {
    pub(super) fn scene(&mut self, id: u64, source: &SceneSource) -> Result<(), Ended> {
        let (told, name) = match (&source.path, &source.demo) {
            (Some(path), None) => (scene::read(&PathBuf::from(path))?, path.clone()),
            (None, Some(name)) => (scene::example(name)?, name.clone()),
            _ => return Err(Failure::Call("a scene is {path} or {demo}".into()).into()),
        };
        let count = told.scene.contacts().len();
        let mut steps = Vec::new();
        for step in told.scene.steps(Membership::Centre) {
            let share = (steps.len() + 1) as f64 / count as f64;
            let about = json!({ "stage": "finding the regions", "share": share });
            self.page.event("progress", about).map_err(|_| Ended::Closed)?;
            steps.push(step?);
        }
        let about: Vec<Value> = steps.iter().map(about).collect();
        self.sonar = Some(Sonar { name, told, steps });
        self.answer(id, &json!({ "steps": about }))
    }

    pub(super) fn scene_step(&mut self, id: u64, step: usize, into: Slot) -> Result<(), Ended> {
        let sonar = self
            .sonar
            .as_ref()
            .ok_or_else(|| Failure::Call("there is no scene; choose one first".into()))?;
        let found = sonar.steps.get(step).ok_or_else(|| {
            let last = sonar.steps.len().saturating_sub(1);
            Failure::Call(format!("there is no step {step}; give 0 to {last}"))
        })?;
        let data = Data::region(found, &format!("{}, contact {}", sonar.name, step + 1));
        let lines = lines(&sonar.told, found);
        self.put(id, into, data)?;
        self.show(Frame::lines([0, id as u32], &lines))
    }
}

fn about(step: &Step) -> Value {
    let points = step.region.count();
    let volume = points as f64 * step.region.grid().voxel_volume();
    let [grow, intersect] = step.seconds;
    json!({
        "contact": step.contact,
        "time": step.time,
        "inside": points,
        "volume": volume,
        "seconds": grow + intersect,
    })
}

impl Data {
    /// The region of a step as a volume.
    fn region(step: &Step, name: &str) -> Self {
        Self::made_here(step.region.clone(), Name::Made(name.into()), scene::frame())
    }
}

/// The ways of array and target, marks where they are, the edge of the sea and its floor.
fn lines(told: &Told, step: &Step) -> Vec<Vec<[f32; 3]>> {
    let places = Places::of(step.region.grid());
    let sets = scene::lines(told, step);
    let segments = sets.iter().flat_map(|set| &set.segments).map(|segment| segment.to_vec());
    let lines = segments.chain(floor(told.scene.sea()));
    lines.map(|line| line.into_iter().map(|point| places.point(point)).collect()).collect()
}

/// Lines on the floor along x and y.
fn floor(sea: &Sea) -> impl Iterator<Item = Vec<[f64; 3]>> {
    let last = sea.grid().dims().map(|n| (n - 1) as f64);
    let [low, high] = [[0.0; 3], last].map(|index| sea.grid().point(index));
    let share =
        move |n: usize, of: usize, d: usize| low[d] + n as f64 / of as f64 * (high[d] - low[d]);
    let line = move |(along, n): (usize, usize)| {
        let place = |m: usize| match along {
            0 => [share(m, POINTS, 0), share(n, LINES, 1)],
            _ => [share(n, LINES, 0), share(m, POINTS, 1)],
        };
        let deep = |[x, y]: [f64; 2]| [x, y, -sea.floor().depth([x, y])];
        (0..=POINTS).map(|m| deep(place(m))).collect()
    };
    (0..2).flat_map(|along| (0..=LINES).map(move |n| (along, n))).map(line)
}
