//! The session of the test bed: what the messages of its page mean. `shrouds_view::server` brings them.
//!
//! A message comes in ([`request`]), is answered at once if it is about work that goes on ([`control`]), or
//! else waits for the one who does all that takes time, a [`worker`] with the volumes ([`volumes`]) and the
//! surfaces ([`surface`]) of the session. A solver has a thread of its own ([`solver`]); the interfaces of
//! several labels ([`several`]) are made in one piece on a thread of the session. Settings are read
//! by the parser of the command line ([`typed`]), and volumes, reports and numbers come from the
//! functions of the other verbs: what the page shows is what they would write.
//!
//! `docs/test-bed.md` has all messages.

mod compare;
mod control;
mod edit;
mod export;

mod look;
mod numbers;
mod page;
mod pick;
mod place;
mod request;
mod scene;
mod several;
mod sizes;
mod solver;
mod surface;
mod typed;
mod volumes;
mod worker;

use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;

use serde_json::Value;
use shrouds_view::server::{self, Files, Outbox};

use control::{Control, Wish};
use page::Page;
use request::{Request, Task};
use worker::Worker;

/// Surfaces that one session can have side by side.
const VIEWS: usize = 4;
/// Requests that wait for the worker.
const WAITING: usize = 256;

/// Why interfaces of several labels do neither pause nor step.
const IN_ONE_PIECE: &str =
    "the interfaces of several labels are made in one piece: run or cancel them";

/// What all sessions begin with.
pub(crate) struct Host {
    /// What to open first, as the page asks for it.
    pub(crate) input: Value,
    /// Threads of each solver; as many as the machine has for 0.
    pub(crate) threads: usize,
    /// Whoever makes interfaces of several labels holds it: such work cannot be stopped, and that of pages that
    /// are gone must not pile up.
    pub(crate) lane: Arc<Mutex<()>>,
}

impl server::Host for Host {
    fn open(&self, out: Outbox, files: Files) -> Box<dyn server::Session> {
        let page = Page::new(out);
        let controls: [Arc<Control>; VIEWS] = Default::default();
        let (tasks, waiting) = sync_channel::<Request>(WAITING);
        let worker = Worker::new(page.clone(), files, controls.clone(), self);
        thread::spawn(move || worker.work(&waiting));
        Box::new(Session { page, controls, tasks })
    }
}

/// The ear of a session: never busy.
struct Session {
    page: Page,
    controls: [Arc<Control>; VIEWS],
    tasks: SyncSender<Request>,
}

impl server::Session for Session {
    fn message(&self, text: &str) {
        match Request::read(text) {
            Ok(request) => self.take(request),
            Err(refused) => self.page.refuse_at_once(refused.id, &refused.message),
        }
    }
}

impl Session {
    /// Does what must not wait, and hands over the rest.
    fn take(&self, request: Request) {
        let control = request.task.view().map(|view| &self.controls[view.index()]);
        match (&request.task, control) {
            (Task::Ack { revision, .. }, Some(control)) => {
                return control.acknowledge(&self.page, *revision);
            }
            (Task::Pause { .. } | Task::Step { .. }, Some(control))
                if control.is_in_one_piece() =>
            {
                return self.page.refuse_at_once(Some(request.id), IN_ONE_PIECE);
            }
            (Task::Pause { .. }, Some(control)) => control.wish(Wish::Pause),
            (Task::Cancel { .. }, Some(control)) => {
                control.wish(Wish::Cancel);
                control.end_packing();
            }
            (Task::Run { .. }, Some(control)) => control.wish(Wish::Run),
            (Task::Step { .. }, Some(control)) => control.wish(Wish::Step),
            _ => {}
        }
        if matches!(request.task, Task::Pause { .. } | Task::Cancel { .. }) {
            return self.page.agree_at_once(request.id);
        }
        match self.tasks.try_send(request) {
            Ok(()) => {}
            Err(TrySendError::Full(request) | TrySendError::Disconnected(request)) => {
                self.page.refuse_at_once(Some(request.id), "too many requests wait already");
            }
        }
    }
}

impl Drop for Session {
    /// All work ends at its next sign of life; the worker ends when it finds no tasks any more.
    fn drop(&mut self) {
        self.controls.iter().for_each(|control| control.close());
    }
}
