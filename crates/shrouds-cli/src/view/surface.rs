//! A surface of the session: what it was made of, where it stands, and the frames that show it.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::network::{Curve, Network};
use shrouds::optimize::{Report, Start, VolumeRule};
use shrouds::surface::Crossing;
use shrouds::{LiveShroud, Occupancy, Settings, Shroud, Times, TriMesh, shroud_observed};
use shrouds_view::server::{Closed, Frame, Topology};

use super::page::Page;
use super::place::Places;
use super::request::{Slot, ViewNumber};
use super::typed::Typed;
use super::volumes::{Data, Name};
use super::worker::Ended;
use crate::failure::Failure;
use crate::input::Source;
use crate::settings::Job;
use crate::work;

/// A surface with its settings, at its start, on its way or in the end.
pub(super) struct Surface {
    pub(super) view: ViewNumber,
    pub(super) revision: u32,
    pub(super) slot: Slot,
    /// How the volume is called, and the options that select it.
    pub(super) name: Name,
    pub(super) words: Vec<String>,
    pub(super) source: Arc<Source>,
    pub(super) typed: Typed,
    pub(super) job: Job,
    pub(super) network: Network,
    pub(super) places: Places,
    /// What the page was shown first: the start, or where the vertices were left by a change of the volume.
    pub(super) start: Arc<Shroud>,
    /// Whether that is where the solver starts.
    is_start: bool,
    shown: Mutex<Shown>,
}

/// What the page sees.
struct Shown {
    /// At the start or in the end.
    shroud: Arc<Shroud>,
    /// Whether it is the result of a solver.
    is_result: bool,
    /// δ on the way there, if one is on its way.
    passing: Option<Arc<[f32]>>,
    /// Those whose triangles the page has.
    sent: Arc<Shroud>,
}

impl Surface {
    /// The surface of a volume, at its start; or where the one `before` left the vertices that both have,
    /// if the end does not depend on the start.
    pub(super) fn begin(
        view: ViewNumber,
        revision: u32,
        slot: Slot,
        data: &Data,
        typed: Typed,
        before: Option<&Self>,
    ) -> Result<Self, Failure> {
        let mut job = typed.job()?;
        let volume = &data.source.occupancy;
        work::require_surface(volume, &job)?;
        let start = begin(volume, &job.settings)?;
        let kept = before.and_then(|before| before.carry(&start));
        let start = match kept.clone().filter(|_| job.settings.optimize.converges()) {
            // It ends at the same place from anywhere, and from here sooner.
            Some(kept) => {
                job.settings.optimize.start = Start::Given(kept.into());
                begin(volume, &job.settings)?
            }
            None => start,
        };
        Ok(Self::new((view, revision, slot), data, (typed, job), (start, true), kept))
    }

    fn new(
        (view, revision, slot): (ViewNumber, u32, Slot),
        data: &Data,
        (typed, job): (Typed, Job),
        (start, is_start): (Shroud, bool),
        kept: Option<Vec<f64>>,
    ) -> Self {
        let start = Arc::new(start);
        let passing = kept.map(|delta| delta.iter().map(|&x| x as f32).collect());
        let shown = Shown { shroud: start.clone(), is_result: false, passing, sent: start.clone() };
        Self {
            view,
            revision,
            slot,
            name: data.name.clone(),
            words: data.words.clone(),
            source: data.source.clone(),
            typed,
            job,
            network: Network::trace(&start.surface),
            places: Places::of(data.source.occupancy.grid()),
            start,
            is_start,
            shown: Mutex::new(shown),
        }
    }

    /// What follows changes of the volume from where the vertices are now; nothing with settings that need the
    /// surface as a whole.
    pub(super) fn live(&self) -> Option<LiveShroud> {
        let settings = self.typed.job().ok()?.settings;
        let now = self.now();
        LiveShroud::resume(now.surface.clone(), now.delta.clone(), &settings).ok()
    }

    /// The surface that takes the place of this one after a change of its volume, which `live` has followed.
    pub(super) fn following(
        &self,
        revision: u32,
        data: &Data,
        live: &LiveShroud,
    ) -> Result<Self, Failure> {
        let mut job = self.typed.job()?;
        let (surface, delta) = (live.surface().clone(), live.delta().to_vec());
        if job.settings.optimize.converges() {
            job.settings.optimize.start = Start::Given(delta.clone().into());
        }
        let Settings { mesh, triangles, .. } = job.settings;
        let mesh = TriMesh::place(&surface, &Network::trace(&surface), &delta, mesh, triangles);
        let (report, times) = (Report::default(), Times::default());
        let found = Shroud { surface, delta, mesh, report, times };
        let of = (self.view, revision, self.slot);
        Ok(Self::new(of, data, (self.typed.clone(), job), (found, false), None))
    }

    /// What the page is told first.
    pub(super) fn about(&self) -> Value {
        let (surface, mesh) = (&self.start.surface, &self.start.mesh);
        json!({ "surface": {
            "view": self.view.number(),
            "slot": self.slot.name(),
            "revision": self.revision,
            "vertices": surface.vertex_count(),
            "triangles": mesh.triangles.len(),
            // Every vertex begins one on each of its curves, unless it ends there.
            "segments": self.network.curves().map(|curve| segments(&curve)).sum::<usize>(),
            "components": surface.components().count(),
            "energy": self.is_start.then_some(self.start.report.energy[0]),
            "followed": !self.is_start,
            "keeps": self.job.energy(),
        } })
    }

    fn shown(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the header of its frames says.
    pub(super) fn header(&self) -> [u32; 2] {
        [self.view.number(), self.revision]
    }

    pub(super) fn is_dual(&self) -> bool {
        self.job.settings.mesh == MeshKind::Dual
    }

    /// Sends all that shows the start.
    pub(super) fn send_start(&self, page: &Page) -> Result<(), Closed> {
        let surface = &self.start.surface;
        let are_fixed = self.is_dual() || self.job.settings.triangles == Triangles::Fixed;
        let triangles = match self.is_dual() {
            // Those of the page are its own; the mesh that is meant comes for itself.
            true => surface.fixed_triangles(),
            false => self.places.triangles(&self.start.mesh.triangles),
        };
        let network = &self.network;
        let topology = Topology { surface, network, triangles: &triangles, are_fixed };
        page.frame(Frame::topology(self.header(), &topology))?;
        let now = self.now();
        self.send_deltas(page, &now.delta)?;
        self.send_mesh(page, &now)
    }

    /// The δ that this surface has for the vertices of another one, and those of the other where it has
    /// no such vertex; none if it never left its start.
    fn carry(&self, start: &Shroud) -> Option<Vec<f64>> {
        let now = self.now();
        let is_at_start = Arc::ptr_eq(&now, &self.start) && self.is_start;
        let is_same_lattice = now.surface.grid() == start.surface.grid();
        if is_at_start || !is_same_lattice {
            return None;
        }
        // Both go through the grid edges in the same order.
        let key = |crossing: &Crossing| {
            let [i, j, k] = crossing.low();
            (k, j, crossing.axis(), i)
        };
        let mut known = now.surface.crossings().zip(&now.delta).peekable();
        let mut carried = start.delta.clone();
        for (crossing, delta) in start.surface.crossings().zip(&mut carried) {
            while known.next_if(|(other, _)| key(other) < key(&crossing)).is_some() {}
            if let Some((_, own)) = known.next_if(|(other, _)| *other == crossing) {
                *delta = *own;
            }
        }
        Some(carried)
    }

    /// Goes back to the start.
    pub(super) fn reset(&self, page: &Page) -> Result<(), Ended> {
        let start = match self.is_start {
            true => self.start.clone(),
            false => Arc::new(begin(&self.source.occupancy, &self.job.settings)?),
        };
        {
            let mut shown = self.shown();
            (shown.shroud, shown.is_result, shown.passing) = (start.clone(), false, None);
        }
        let sent = self.send_deltas(page, &start.delta).and_then(|()| self.send_end(page, &start));
        sent.map_err(|_| Ended::Closed)
    }

    fn send_deltas(&self, page: &Page, delta: &[f64]) -> Result<(), Closed> {
        page.frame(Frame::deltas(self.header(), delta.iter().map(|&delta| delta as f32)))
    }

    /// Sends what depends on δ: normals, or the whole dual mesh.
    fn send_mesh(&self, page: &Page, shroud: &Shroud) -> Result<(), Closed> {
        let mesh = &shroud.mesh;
        if self.is_dual() {
            let vertices: Vec<[f32; 3]> =
                mesh.vertices.iter().map(|&vertex| self.places.point(vertex)).collect();
            let triangles = self.places.triangles(&mesh.triangles);
            return page.frame(Frame::mesh(self.header(), &vertices, &triangles));
        }
        self.send_normals(page, &mesh.normals)
    }

    pub(super) fn send_normals(&self, page: &Page, normals: &[[f32; 3]]) -> Result<(), Closed> {
        let normals = normals.iter().map(|&normal| self.places.normal(normal));
        page.frame(Frame::normals(self.header(), normals))
    }

    /// Sends what a solver ends with, but for δ; triangles only if they are others.
    pub(super) fn send_end(&self, page: &Page, shroud: &Arc<Shroud>) -> Result<(), Closed> {
        let before = std::mem::replace(&mut self.shown().sent, shroud.clone());
        if !self.is_dual() && before.mesh.triangles != shroud.mesh.triangles {
            let triangles = self.places.triangles(&shroud.mesh.triangles);
            page.frame(Frame::triangles(self.header(), &triangles))?;
        }
        self.send_mesh(page, shroud)?;
        let about = json!({ "view": self.view.number(), "revision": self.revision });
        page.event("settled", about)
    }

    /// Takes δ that pass by.
    pub(super) fn pass(&self, delta: Arc<[f32]>) {
        self.shown().passing = Some(delta);
    }

    /// Takes the result of a solver.
    pub(super) fn finish(&self, shroud: Arc<Shroud>) {
        let mut shown = self.shown();
        (shown.shroud, shown.is_result, shown.passing) = (shroud, true, None);
    }

    /// The surface as it is now: its start, its end, or what lies between.
    pub(super) fn now(&self) -> Arc<Shroud> {
        let (shroud, passing) = {
            let shown = self.shown();
            (shown.shroud.clone(), shown.passing.clone())
        };
        let Some(delta) = passing else { return shroud };
        let Settings { mesh, triangles, .. } = self.job.settings;
        let (surface, delta) = (self.start.surface.clone(), delta.iter().map(|&x| x.into()));
        let delta: Vec<f64> = delta.collect();
        let mesh = TriMesh::place(&surface, &self.network, &delta, mesh, triangles);
        let (report, times) = (self.start.report.clone(), self.start.times);
        Arc::new(Shroud { surface, delta, mesh, report, times })
    }

    /// The result of the solver, if it has one.
    pub(super) fn result(&self) -> Result<Arc<Shroud>, Failure> {
        let shown = self.shown();
        match shown.is_result && shown.passing.is_none() {
            true => Ok(shown.shroud.clone()),
            false => Err(Failure::Call(
                "the report is that of a finished surface; let it run to its end first".into(),
            )),
        }
    }
}

/// How many segments a curve has.
fn segments(curve: &Curve) -> usize {
    match curve.vertices.len() {
        0 | 1 => 0,
        count => count - usize::from(!curve.closed),
    }
}

/// The surface of a volume where the solver starts.
fn begin(volume: &Occupancy, settings: &Settings) -> Result<Shroud, Failure> {
    Ok(shroud_observed(volume, &at_start(settings), &mut |_| ControlFlow::Continue(()))?)
}

/// Settings that leave the start as it is. Volumes are kept from the first iteration on.
fn at_start(settings: &Settings) -> Settings {
    let mut settings = settings.clone();
    settings.optimize.max_iterations = Some(0);
    settings.optimize.volume = VolumeRule::Free;
    settings
}
