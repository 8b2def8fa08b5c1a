//! A view of several labels: the interfaces between them, made in one piece on a thread that nobody waits
//! for. Until they are there, there is nothing to see.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};
use shrouds::materials::{Labels, MaterialMesh, Shrouds, shrouds};
use shrouds_io::{MeshFormat, mesh_format};
use shrouds_view::server::{Closed, Frame};

use super::control::{Control, Fate, Wish};
use super::page::Page;
use super::place::Places;
use super::request::{Slot, ViewNumber};
use super::typed::Typed;
use super::volumes::{Data, Name};
use super::worker::Ended;
use crate::args::FrameChoice;
use crate::commands::mesh::materials::{Out, refuse_other_settings, settings};
use crate::commands::mesh::materials_report::{Given, Report};
use crate::console::Console;
use crate::failure::Failure;
use crate::frame;
use crate::input::Source;
use crate::report::peak_memory;
use crate::settings::Job;

/// The labels of a view with their settings, and their interfaces as soon as they are made.
pub(super) struct Several {
    pub(super) view: ViewNumber,
    pub(super) revision: u32,
    pub(super) slot: Slot,
    /// How the volume is called, and the options that select its labels.
    pub(super) name: Name,
    pub(super) words: Vec<String>,
    pub(super) typed: Typed,
    source: Arc<Source>,
    job: Job,
    labels: Labels,
    /// Those of labels, where the file has some.
    names: BTreeMap<i128, String>,
    places: Places,
    state: Mutex<State>,
}

#[derive(Default)]
enum State {
    #[default]
    Start,
    Solving,
    Done(Arc<Shrouds>),
}

impl Several {
    /// The labels of a volume that are chosen; nothing is made of them yet.
    pub(super) fn begin(
        view: ViewNumber,
        revision: u32,
        slot: Slot,
        data: &Data,
        typed: Typed,
    ) -> Result<Self, Failure> {
        refuse_other_settings(&typed.args)?;
        let job = typed.job()?;
        let (labels, names) = data.materials()?;
        Ok(Self {
            view,
            revision,
            slot,
            name: data.name.clone(),
            words: data.words.clone(),
            typed,
            source: data.source.clone(),
            job,
            places: Places::of(data.source.occupancy.grid()),
            labels,
            names,
            state: Mutex::default(),
        })
    }

    /// What the page is told first. Sizes are known when the interfaces are.
    pub(super) fn about(&self) -> Value {
        json!({ "surface": {
            "view": self.view.number(),
            "slot": self.slot.name(),
            "revision": self.revision,
            "vertices": null,
            "triangles": null,
            "components": null,
            "energy": null,
            "followed": false,
            "materials": self.labels.values(),
        } })
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The interfaces, if they are made.
    fn made(&self) -> Result<Arc<Shrouds>, Failure> {
        match &*self.state() {
            State::Done(made) => Ok(made.clone()),
            _ => Err(Failure::Call(
                "the interfaces of these labels are not made yet; let them run to the end first"
                    .into(),
            )),
        }
    }

    /// Marks that they are being made, unless they are already.
    fn begin_solving(&self) -> bool {
        let mut state = self.state();
        let begins = !matches!(*state, State::Solving);
        *state = State::Solving;
        begins
    }

    /// The report of `shrouds mesh --materials`.
    pub(super) fn report(&self) -> Result<Report, Failure> {
        let mut report = self.judged(&*self.made()?)?;
        let times = &mut report.times;
        times.total = times.read + times.surface + times.optimize + times.mesh + times.check;
        report.memory = peak_memory();
        Ok(report)
    }

    fn judged(&self, made: &Shrouds) -> Result<Report, Failure> {
        let given = Given {
            input: &self.source.path,
            lattice: &self.source.lattice,
            frame: &self.source.frame,
            labels: &self.labels,
            names: &self.names,
        };
        let mut report = Report::new(&given, made, &self.job)?;
        report.times.read = self.source.seconds;
        Ok(report)
    }

    /// The numbers that a body has, too, and those of each label and of each pair.
    pub(super) fn numbers(&self) -> Result<Value, Failure> {
        let Report { found, times, .. } = self.judged(&*self.made()?)?;
        let (topology, checks, labels) = (&found.topology, &found.checks, &found.labels);
        let area: f64 = found.contacts.iter().map(|contact| contact.area).sum();
        Ok(json!({
            "vertices": topology.vertices,
            "triangles": topology.triangles,
            "components": labels.iter().map(|label| label.components).sum::<usize>(),
            "volume": labels.iter().map(|label| label.volume).sum::<f64>(),
            "voxel_volume": labels.iter().map(|label| label.voxel_volume).sum::<f64>(),
            "area": area,
            "wrong_side": checks.wrong_label,
            "manifold": checks.faults() == 0,
            "ok": checks.wrong_label + checks.faults() == 0,
            "roughness": null,
            "times": times,
            "materials": {
                "crossings": topology.crossings,
                "junctions": topology.junction_points,
                "junction_lines": topology.junction_lines,
                "labels": labels,
                "contacts": found.contacts,
            },
        }))
    }

    /// Writes the interfaces as `shrouds mesh --materials` does.
    pub(super) fn write(&self, path: &Path, choice: FrameChoice) -> Result<(), Failure> {
        if !matches!(mesh_format(path), Ok(format) if format != MeshFormat::Stl) {
            return Err(Failure::Call(
                "the interfaces of several labels go to ply, vtp, glb, obj and 3mf".into(),
            ));
        }
        let Source { lattice, frame, .. } = &*self.source;
        let mut mesh = self.made()?.mesh.clone();
        if choice == FrameChoice::Index {
            frame::to_index(&mut mesh.surface, lattice);
        }
        let out = Out { frame: frame::name(choice, frame), lattice, choice };
        out.write_file(&mesh, path, Console { quiet: true })
    }

    /// Sends all that shows the interfaces: the mesh, its triangles pair by pair, and what they lie between.
    fn send(&self, page: &Page, mesh: &MaterialMesh) -> Result<(), Closed> {
        let of = [self.view.number(), self.revision];
        let (order, runs) = by_pair(mesh, self.labels.values());
        let surface = &mesh.surface;
        let vertices: Vec<[f32; 3]> =
            surface.vertices.iter().map(|&vertex| self.places.point(vertex)).collect();
        let sorted: Vec<[u32; 3]> = order.iter().map(|&n| surface.triangles[n]).collect();
        page.frame(Frame::mesh(of, &vertices, &self.places.triangles(&sorted)))?;
        page.frame(Frame::interfaces(of, &runs, &mesh.lines))
    }

    /// Tells in which state they are. The page knows by the revision whether it still shows them.
    fn tell(&self, page: &Page, state: &str, more: Value) -> Result<(), Closed> {
        let mut event = json!({
            "view": self.view.number(),
            "revision": self.revision,
            "state": state,
            "status": null,
            "iteration": 0,
            "seconds": 0.0,
            "share": null,
        });
        for (name, value) in more.as_object().into_iter().flatten() {
            event[name] = value.clone();
        }
        page.event("solver", event)
    }
}

/// The triangles of a mesh in the order of their pairs, and the runs of each: the places of both labels in a
/// list, and how many triangles there are.
fn by_pair(mesh: &MaterialMesh, labels: &[i64]) -> (Vec<usize>, Vec<[u32; 3]>) {
    let ranks: BTreeMap<i64, u32> = labels.iter().copied().zip(0..).collect();
    let rank = |label: i64| ranks.get(&label).copied().unwrap_or(0);
    let mut order: Vec<usize> = (0..mesh.pairs.len()).collect();
    order.sort_by_key(|&n| mesh.pairs[n]);
    let same = order.chunk_by(|&a, &b| mesh.pairs[a] == mesh.pairs[b]);
    let runs = same.map(|run| {
        let [first, second] = mesh.pairs[run[0]].map(rank);
        [first, second, run.len() as u32]
    });
    let runs = runs.collect();
    (order, runs)
}

/// The way to the thread of a session that makes interfaces, one after the other. It ends when this is dropped
/// and its work is done.
pub(super) struct Solves(Sender<Solve>);

struct Solve {
    several: Arc<Several>,
    control: Arc<Control>,
    /// See [`Control::begin`].
    number: u64,
}

impl Solves {
    /// Each solve has so many threads; as many as the machine has for 0.
    pub(super) fn new(page: Page, threads: usize, lane: Arc<Mutex<()>>) -> Self {
        let (solves, waiting) = channel();
        thread::spawn(move || work(&page, threads, &lane, &waiting));
        Self(solves)
    }

    /// Makes the interfaces of these labels, from the beginning, unless that is being done or was cancelled.
    pub(super) fn run(
        &self,
        several: &Arc<Several>,
        control: &Arc<Control>,
        page: &Page,
    ) -> Result<(), Ended> {
        if control.wished() == Wish::Cancel || !several.begin_solving() {
            return Ok(());
        }
        let solve =
            Solve { several: several.clone(), control: control.clone(), number: control.begin() };
        several.tell(page, "running", json!({})).map_err(|_| Ended::Closed)?;
        // Without its thread the session is over.
        self.0.send(solve).map_err(|_| Ended::Closed)
    }
}

fn work(page: &Page, threads: usize, lane: &Mutex<()>, solves: &Receiver<Solve>) {
    while let Ok(solve) = solves.recv() {
        // Until those of other sessions are done.
        let _alone = lane.lock().unwrap_or_else(PoisonError::into_inner);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let done = match &pool {
            Ok(pool) => solve.work(page, pool),
            Err(cause) => solve.fail(page, &format!("there are no threads for it ({cause})")),
        };
        if done.is_err() {
            break;
        }
    }
}

impl Solve {
    fn work(&self, page: &Page, pool: &ThreadPool) -> Result<(), Closed> {
        let start = Instant::now();
        if self.control.fate(self.number) != Fate::Wanted {
            return self.cancel(page, start);
        }
        let Several { labels, job, .. } = &*self.several;
        let made = pool.install(|| shrouds(labels.clone(), &settings(job)));
        match made {
            _ if self.control.fate(self.number) != Fate::Wanted => self.cancel(page, start),
            Ok(made) => self.end(page, made, start),
            Err(error) => self.fail(page, &format!("the interfaces cannot be made: {error}")),
        }
    }

    /// Keeps and shows the result.
    fn end(&self, page: &Page, made: Shrouds, start: Instant) -> Result<(), Closed> {
        let several = &self.several;
        let made = Arc::new(made);
        *several.state() = State::Done(made.clone());
        let report = &made.report;
        let energy = report.passes.last().and_then(|pass| pass.last());
        let end = json!({
            "status": report.status.name(),
            "iteration": report.steps(),
            "energy": energy,
            "seconds": start.elapsed().as_secs_f64(),
            "share": 1.0,
        });
        several.tell(page, "done", end)?;
        several.send(page, &made.mesh)?;
        let about = json!({ "view": several.view.number(), "revision": several.revision });
        page.event("settled", about)
    }

    /// Drops what was made of labels that nobody wants to see.
    fn cancel(&self, page: &Page, start: Instant) -> Result<(), Closed> {
        *self.several.state() = State::Start;
        match self.control.fate(self.number) {
            Fate::Forgotten => Ok(()),
            _ => {
                let seconds = start.elapsed().as_secs_f64();
                self.several.tell(page, "cancelled", json!({ "seconds": seconds }))
            }
        }
    }

    fn fail(&self, page: &Page, why: &str) -> Result<(), Closed> {
        *self.several.state() = State::Start;
        let view = self.several.view.number();
        page.event("message", json!({ "level": "error", "text": why, "view": view }))?;
        self.several.tell(page, "cancelled", json!({ "status": "failed" }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_told_pair_by_pair() {
        let pairs = vec![[2, 0], [1, 2], [2, 0], [-3, 0], [1, 2], [2, 0]];
        let mesh = MaterialMesh { pairs, ..MaterialMesh::default() };
        let (order, runs) = by_pair(&mesh, &[0, -3, 1, 2]);
        assert_eq!(order, [3, 1, 4, 0, 2, 5]);
        assert_eq!(runs, [[1, 0, 1], [2, 3, 2], [3, 0, 3]]);
    }
}
