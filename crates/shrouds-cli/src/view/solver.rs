//! The thread that makes a surface optimal, and tells how it goes.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use rayon::ThreadPoolBuilder;
use serde_json::json;
use shrouds::mesh::{network_normals, place_vertices};
use shrouds::optimize::{Progress, Status};
use shrouds::{Error, Shroud, shroud_observed};
use shrouds_view::server::{Closed, Frame};

use super::control::Control;
use super::page::Page;
use super::surface::Surface;

/// A solver of one view.
#[derive(Clone)]
pub(super) struct Solver {
    pub(super) surface: Arc<Surface>,
    pub(super) control: Arc<Control>,
    pub(super) page: Page,
    /// As many as the machine has for 0.
    pub(super) threads: usize,
}

/// A solver at work, as its observer sees it.
struct Watch<'a> {
    solver: &'a Solver,
    /// See [`Control::begin`].
    work: u64,
    start: Instant,
    /// Spent in pauses.
    paused: Duration,
    before: Arc<[f32]>,
    /// When the solver last handed out positions: the clock of this machine, which the page has, too.
    at: f64,
}

impl Solver {
    /// Starts the work from the beginning, on a thread of its own.
    pub(super) fn begin(self) -> thread::JoinHandle<()> {
        let work = self.control.begin();
        thread::spawn(move || {
            // A page that is gone has stopped the work already.
            let _ = self.solve(work);
        })
    }

    /// The threads are its own: who pauses stands on one of them, and another solver's work must not wait
    /// for it there.
    fn solve(&self, work: u64) -> Result<(), Closed> {
        let pool = match ThreadPoolBuilder::new().num_threads(self.threads).build() {
            Ok(pool) => pool,
            Err(cause) => return self.fail(&format!("there are no threads for it ({cause})")),
        };
        let delta: Arc<[f32]> = self.surface.start.delta.iter().map(|&x| x as f32).collect();
        let (start, paused) = (Instant::now(), Duration::ZERO);
        let mut watch = Watch { solver: self, work, start, paused, before: delta, at: 0.0 };
        let (volume, settings) = (&self.surface.source.occupancy, &self.surface.job.settings);
        let made = pool.install(|| shroud_observed(volume, settings, &mut |now| watch.look(now)));
        match made {
            Ok(shroud) => pool.install(|| watch.end(shroud)),
            Err(error) => self.fail(&in_words(&error)),
        }
    }

    fn fail(&self, why: &str) -> Result<(), Closed> {
        let view = self.surface.view.number();
        self.page.event("message", json!({ "level": "error", "text": why, "view": view }))?;
        let state = json!({ "view": view, "state": "cancelled", "status": "failed" });
        self.page.event("solver", state)?;
        let revision = self.surface.revision;
        self.page.event("settled", json!({ "view": view, "revision": revision }))
    }
}

/// Since 1970, as a page counts.
fn milliseconds() -> f64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0.0, |time| 1000.0 * time.as_secs_f64())
}

fn in_words(error: &Error) -> String {
    format!("the surface could not be made: {error}")
}

impl Watch<'_> {
    /// Tells the page how far it is, and waits or stops as the page wishes.
    fn look(&mut self, now: Progress) -> ControlFlow<()> {
        let Solver { surface, control, page, .. } = self.solver;
        self.at = milliseconds();
        let delta: Arc<[f32]> = now.positions.deltas().into();
        let frame = Frame::deltas(surface.header(), delta.iter().copied());
        surface.pass(delta.clone());
        let told = self.tell("running", &now, &delta);
        if told.and_then(|()| control.offer(page, surface.revision, frame)).is_err() {
            return ControlFlow::Break(());
        }
        let waiting = Instant::now();
        let pausing = || {
            let _ = self.pause(&now, &delta);
        };
        let is_over = control.is_over(self.work, pausing);
        self.paused += waiting.elapsed();
        self.before = delta;
        if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Shows the surface as it is, with all that belongs to it.
    fn pause(&self, now: &Progress, delta: &[f32]) -> Result<(), Closed> {
        let Solver { surface, control, page, .. } = self.solver;
        self.tell("paused", now, delta)?;
        let frame = Frame::deltas(surface.header(), delta.iter().copied());
        control.send(page, surface.revision, frame)?;
        let delta: Vec<f64> = delta.iter().map(|&x| x.into()).collect();
        let vertices = place_vertices(&surface.start.surface, &delta);
        let normals = network_normals(&surface.start.surface, &surface.network, &vertices);
        surface.send_normals(page, &normals)?;
        page.event(
            "settled",
            json!({ "view": surface.view.number(), "revision": surface.revision }),
        )
    }

    fn tell(&self, state: &str, now: &Progress, delta: &[f32]) -> Result<(), Closed> {
        let moves = delta.iter().zip(&*self.before).map(|(now, before)| (now - before).abs());
        self.solver.page.event(
            "solver",
            json!({
                "view": self.solver.surface.view.number(),
                "state": state,
                "status": null,
                "iteration": now.iteration,
                // In the middle of a pass it is that of some tiles alone, and the gradient is not known.
                "energy": now.gradient.map(|_| now.energy),
                "gradient": now.gradient,
                "largest_move": moves.fold(0.0, f32::max),
                "change": now.change,
                "tolerance": now.tolerance,
                "seconds": self.seconds(),
                "share": now.share_done,
                "at": self.at,
            }),
        )
    }

    fn seconds(&self) -> f64 {
        (self.start.elapsed() - self.paused).as_secs_f64()
    }

    /// Keeps and shows the result.
    fn end(&self, mut shroud: Shroud) -> Result<(), Closed> {
        let Solver { surface, control, page, .. } = self.solver;
        // Who paused it did not make it slower.
        shroud.times.optimize -= self.paused.as_secs_f64();
        let shroud = Arc::new(shroud);
        surface.finish(shroud.clone());
        let report = &shroud.report;
        let is_cancelled = report.status == Status::Cancelled;
        let moves = shroud.delta.iter().zip(&*self.before);
        let moves = moves.map(|(now, before)| (*now as f32 - before).abs());
        page.event(
            "solver",
            json!({
                "view": surface.view.number(),
                "state": if is_cancelled { "cancelled" } else { "done" },
                "status": report.status.name(),
                "iteration": report.iterations,
                "energy": report.energy[1],
                "gradient": report.projected_gradient,
                "largest_move": moves.fold(0.0, f32::max),
                "change": report.projected_step_rms,
                "tolerance": surface.job.settings.optimize.tolerance(),
                "seconds": self.seconds(),
                "share": 1.0,
            }),
        )?;
        let delta = shroud.delta.iter().map(|&x| x as f32);
        control.send(page, surface.revision, Frame::deltas(surface.header(), delta))?;
        surface.send_end(page, &shroud)
    }
}
