//! Who does what takes time, one request after the other.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread::JoinHandle;

use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};
use shrouds::LiveShroud;
use shrouds::energy::{Parameter, catalogue};
use shrouds::live::Ranges;
use shrouds::volume::phantom::NAMES;
use shrouds_view::server::{Closed, Files};

use super::control::{Control, Wish};
use super::edit::Ball;
use super::export;
use super::look;
use super::page::Page;
use super::request::{Origin, Request, Settings, Slot, Task, ViewNumber};
use super::scene::Sonar;
use super::several::{Several, Solves};
use super::sizes::Sizes;
use super::solver::Solver;
use super::surface::Surface;
use super::typed::{self, Typed};
use super::volumes::{self, Data};
use super::{Host, IN_ONE_PIECE, VIEWS};
use crate::args::FrameChoice;
use crate::energies;
use crate::failure::Failure;
use crate::input::Source;
use crate::phantom;
use crate::scene;

/// The volumes and surfaces of a session.
pub(super) struct Worker {
    pub(super) page: Page,
    pub(super) files: Files,
    controls: [Arc<Control>; VIEWS],
    pub(super) sizes: Sizes,
    solves: Solves,
    slots: [Option<Data>; Slot::COUNT],
    views: [Option<View>; VIEWS],
    /// How many surfaces there were.
    revisions: u32,
    /// Files that the page may fetch.
    pub(super) exports: VecDeque<String>,
    pub(super) sonar: Option<Sonar>,
    input: Value,
    threads: usize,
}

/// What a view shows.
pub(super) enum Shown {
    /// The surface of one body.
    Body(Arc<Surface>),
    /// The interfaces of several labels.
    Several(Arc<Several>),
}

impl Shown {
    fn slot(&self) -> Slot {
        match self {
            Self::Body(surface) => surface.slot,
            Self::Several(several) => several.slot,
        }
    }
}

/// What is shown and the solver of a body.
struct View {
    shown: Shown,
    thread: Option<JoinHandle<()>>,
    /// What follows the changes of the volume by hand, as long as no solver has been at work since.
    live: Option<LiveShroud>,
}

/// Why a request has no answer: it was refused, or there is nobody to tell.
pub(super) enum Ended {
    Refused(Failure),
    Closed,
}

impl<F: Into<Failure>> From<F> for Ended {
    fn from(failure: F) -> Self {
        Self::Refused(failure.into())
    }
}

impl Worker {
    pub(super) fn new(
        page: Page,
        files: Files,
        controls: [Arc<Control>; VIEWS],
        host: &Host,
    ) -> Self {
        Self {
            sizes: Sizes::new(page.clone()),
            solves: Solves::new(page.clone(), host.threads, host.lane.clone()),
            page,
            files,
            controls,
            slots: Default::default(),
            views: Default::default(),
            revisions: 0,
            exports: VecDeque::new(),
            sonar: None,
            input: host.input.clone(),
            threads: host.threads,
        }
    }

    /// Works until the session is over.
    pub(super) fn work(mut self, requests: &Receiver<Request>) {
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).build();
        while let Ok(request) = requests.recv() {
            let Request { id, task } = request;
            let done = match &pool {
                Ok(pool) => self.in_pool(pool, id, task),
                Err(cause) => self.page.refuse(id, &format!("there are no threads ({cause})")),
            };
            if done.is_err() {
                break;
            }
        }
        self.forget_exports();
    }

    fn in_pool(&mut self, pool: &ThreadPool, id: u64, task: Task) -> Result<(), Closed> {
        match pool.install(|| self.perform(id, task)) {
            Ok(()) => Ok(()),
            Err(Ended::Refused(failure)) => self.page.refuse(id, failure.message()),
            Err(Ended::Closed) => Err(Closed),
        }
    }

    fn perform(&mut self, id: u64, task: Task) -> Result<(), Ended> {
        match task {
            Task::Hello {} => self.answer(id, &self.hello()),
            Task::Open { slot, source } => self.open(id, slot, source),
            Task::Select { slot, labels, threshold } => {
                let words = volumes::selection(labels, threshold)?;
                let data = self.data(slot)?.select_again(&words)?;
                self.put(id, slot, data)
            }
            Task::Combine { operation, a, b, into } => {
                let data = volumes::combined(operation.0, self.data(a)?, self.data(b)?)?;
                self.put(id, into, data)
            }
            Task::Offset { slot, by, into } => {
                let data = volumes::offset(self.data(slot)?, by)?;
                self.put(id, into, data)
            }
            Task::Shroud { view, slot, settings } => self.shroud(id, view, slot, &settings),
            Task::Run { view } => self.run(id, view),
            Task::Step { view } => self.step(id, view),
            Task::Reset { view } => self.reset(id, view),
            Task::Numbers { view } => self.numbers(id, view),
            Task::Sizes { view } => self.sizes(id, view),
            Task::Report { view } => self.report(id, view),
            Task::Command { view } => self.command(id, view),
            Task::Pick { view, vertex } => self.pick(id, view, vertex),
            Task::Colours { view, field, range } => self.colours(id, view, &field, range),
            Task::Contours { view, axis, every } => self.contours(id, view, axis.0, every),
            Task::Points { slot, near } => self.points(id, slot, near),
            Task::Slice { slot, axis, index } => self.slice(id, slot, axis.0, index),
            Task::Brush { slot, add, centre, radius, stroke, follow } => {
                self.brush(id, slot, follow, stroke, &Ball { add, centre, radius })
            }
            Task::Undo { slot, follow } => self.undo(id, slot, follow),
            Task::Redo { slot, follow } => self.redo(id, slot, follow),
            Task::Export { view, format, frame } => {
                let frame = frame.map_or(FrameChoice::World, |frame| frame.0);
                self.export(id, view, &format, frame)
            }
            Task::Compare { slot, energies, settings } => {
                self.compare(id, slot, &energies, &settings)
            }
            Task::Scene(source) => self.scene(id, &source),
            Task::SceneStep { step, into } => self.scene_step(id, step, into),
            // These are for the solver, which has been told.
            Task::Pause { .. } | Task::Cancel { .. } | Task::Ack { .. } => Ok(()),
        }
    }

    pub(super) fn answer(&self, id: u64, ok: &Value) -> Result<(), Ended> {
        self.page.answer(id, ok).map_err(|_| Ended::Closed)
    }

    pub(super) fn data(&self, slot: Slot) -> Result<&Data, Failure> {
        self.slots[slot.index()].as_ref().ok_or_else(|| {
            Failure::Call(format!("slot {} is empty: open a volume first", slot.name()))
        })
    }

    pub(super) fn data_mut(&mut self, slot: Slot) -> Result<&mut Data, Failure> {
        self.data(slot)?;
        self.slots[slot.index()].as_mut().ok_or_else(|| Failure::Call("the slot is empty".into()))
    }

    /// What a view shows.
    pub(super) fn shown(&self, view: ViewNumber) -> Result<&Shown, Failure> {
        self.views[view.index()].as_ref().map(|view| &view.shown).ok_or_else(|| {
            Failure::Call(format!("view {} is empty: make a shroud first", view.number()))
        })
    }

    /// The surface of the body that a view shows.
    pub(super) fn surface(&self, view: ViewNumber) -> Result<&Arc<Surface>, Failure> {
        match self.shown(view)? {
            Shown::Body(surface) => Ok(surface),
            Shown::Several(_) => Err(Failure::Call(format!(
                "view {} shows the interfaces of several labels, which have only run, cancel, numbers, report, command and export",
                view.number()
            ))),
        }
    }

    pub(super) fn control(&self, view: ViewNumber) -> &Arc<Control> {
        &self.controls[view.index()]
    }

    fn hello(&self) -> Value {
        let energies = catalogue().iter().map(|entry| {
            json!({
                "name": entry.name,
                "arguments": entry.arguments,
                "summary": entry.summary,
                "keeps_thin_parts": entry.keeps_thin_parts,
            })
        });
        let demos =
            NAMES.iter().map(|name| json!({ "name": name, "size": phantom::size(name, None) }));
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "choices": typed::choices(),
            "energies": energies.collect::<Vec<_>>(),
            "parameters": Parameter::ALL.map(Parameter::name),
            "demos": demos.collect::<Vec<_>>(),
            "fields": look::fields(),
            "formats": export::FORMATS,
            "scenes": scene::EXAMPLES,
            "input": self.input,
            "threads": rayon::current_num_threads(),
        })
    }

    fn open(&mut self, id: u64, slot: Slot, source: Origin) -> Result<(), Ended> {
        let data = Data::open(source, &self.files, &self.page)?;
        self.put(id, slot, data)
    }

    pub(super) fn put(&mut self, id: u64, slot: Slot, data: Data) -> Result<(), Ended> {
        let about = json!({ "volume": data.about(slot) });
        self.slots[slot.index()] = Some(data);
        self.answer(id, &about)
    }

    fn shroud(
        &mut self,
        id: u64,
        view: ViewNumber,
        slot: Slot,
        settings: &Settings,
    ) -> Result<(), Ended> {
        let typed = Typed::read(settings)?;
        if typed.materials {
            return self.several(id, view, slot, typed);
        }
        let surface = self.begin(view, slot, typed, None)?;
        self.answer(id, &surface.about())?;
        surface.send_start(&self.page).map_err(|_| Ended::Closed)
    }

    /// Puts the interfaces of the chosen labels of a volume into a view.
    fn several(
        &mut self,
        id: u64,
        view: ViewNumber,
        slot: Slot,
        typed: Typed,
    ) -> Result<(), Ended> {
        let data = self.data(slot)?;
        self.page.progress("gathering labels", None);
        let several = Several::begin(view, self.revisions + 1, slot, data, typed)?;
        self.stop(view);
        let several = Arc::new(several);
        self.show_in(view, Shown::Several(several.clone()), None);
        self.answer(id, &several.about())
    }

    /// Puts the surface of a volume into a view, in place of the one that was there.
    pub(super) fn begin(
        &mut self,
        view: ViewNumber,
        slot: Slot,
        typed: Typed,
        before: Option<&Surface>,
    ) -> Result<Arc<Surface>, Failure> {
        let data = self.data(slot)?;
        self.page.progress("finding the surface", None);
        let surface = Surface::begin(view, self.revisions + 1, slot, data, typed, before)?;
        if let Some(names) = energies::destructive(&surface.job.energy()) {
            self.page
                .warn(&format!("{names} may destroy parts one voxel thin; bending keeps them"));
        }
        self.stop(view);
        Ok(self.show_surface(surface, None))
    }

    /// Puts a surface into its view.
    fn show_surface(&mut self, surface: Surface, live: Option<LiveShroud>) -> Arc<Surface> {
        let surface = Arc::new(surface);
        self.show_in(surface.view, Shown::Body(surface.clone()), live);
        surface
    }

    fn show_in(&mut self, view: ViewNumber, shown: Shown, live: Option<LiveShroud>) {
        self.revisions += 1;
        self.control(view).set_in_one_piece(matches!(shown, Shown::Several(_)));
        self.views[view.index()] = Some(View { shown, thread: None, live });
    }

    /// The views that show a surface of a volume, in which it can be changed.
    pub(super) fn views_to_change(&self, slot: Slot) -> Result<Vec<ViewNumber>, Failure> {
        let shown = self.views.iter().flatten().map(|view| &view.shown);
        let view = |shown: &Shown| match shown {
            Shown::Body(surface) => Ok(surface.view),
            Shown::Several(several) => Err(Failure::Call(format!(
                "view {} shows several labels of this volume, which cannot be changed by hand; show one body there first",
                several.view.number()
            ))),
        };
        shown.filter(|shown| shown.slot() == slot).map(view).collect()
    }

    /// Makes the surface of a view anew, of the volume as it is now.
    pub(super) fn begin_again(&mut self, view: ViewNumber) -> Result<Arc<Surface>, Failure> {
        let before = self.surface(view)?.clone();
        self.begin(view, before.slot, before.typed.clone(), Some(&before))
    }

    /// Lets the surface of a view follow a change of its volume within `region`: what the change reaches is
    /// solved again, all else stays. Nothing where that cannot be: with settings that need the
    /// surface as a whole, or when `before`, the volume before the change, is not what it was made of.
    pub(super) fn follow(
        &mut self,
        view: ViewNumber,
        before: &Arc<Source>,
        region: Ranges,
    ) -> Result<Option<Arc<Surface>>, Failure> {
        let surface = self.surface(view)?.clone();
        if !Arc::ptr_eq(&surface.source, before) {
            return Ok(None);
        }
        self.stop(view);
        let kept = self.views[view.index()].as_mut().and_then(|view| view.live.take());
        let Some(mut live) = kept.or_else(|| surface.live()) else { return Ok(None) };
        let data = self.data(surface.slot)?;
        live.update(&data.source.occupancy, region)?;
        let next = surface.following(self.revisions + 1, data, &live)?;
        Ok(Some(self.show_surface(next, Some(live))))
    }

    /// Ends the work of a view and waits until it has ended.
    fn stop(&mut self, view: ViewNumber) {
        self.controls[view.index()].end();
        let thread = self.views[view.index()].as_mut().and_then(|view| view.thread.take());
        // A solver that broke down has said so itself.
        let _ = thread.map(JoinHandle::join);
    }

    /// Lets the solver go on to its next sign of life.
    fn step(&mut self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        match self.shown(view)? {
            Shown::Body(_) => self.run(id, view),
            Shown::Several(_) => Err(Failure::Call(IN_ONE_PIECE.into()).into()),
        }
    }

    /// Lets the solver go on, or begins anew after its end.
    fn run(&mut self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        if let Shown::Several(several) = self.shown(view)? {
            self.answer(id, &json!({}))?;
            return self.solves.run(several, self.control(view), &self.page);
        }
        let surface = self.surface(view)?.clone();
        self.answer(id, &json!({}))?;
        let is_running = self.views[view.index()]
            .as_ref()
            .and_then(|view| view.thread.as_ref())
            .is_some_and(|thread| !thread.is_finished());
        if !is_running && self.controls[view.index()].wished() != Wish::Cancel {
            self.begin_solver(surface);
        }
        Ok(())
    }

    fn begin_solver(&mut self, surface: Arc<Surface>) {
        let view = surface.view.index();
        let (control, page) = (self.controls[view].clone(), self.page.clone());
        let thread = Solver { surface, control, page, threads: self.threads }.begin();
        if let Some(view) = &mut self.views[view] {
            (view.thread, view.live) = (Some(thread), None);
        }
    }

    fn reset(&mut self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        let surface = self.surface(view)?.clone();
        self.stop(view);
        if let Some(view) = &mut self.views[view.index()] {
            view.live = None;
        }
        self.answer(id, &json!({}))?;
        surface.reset(&self.page)
    }
}
