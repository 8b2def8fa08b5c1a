//! What is said to the page, as it understands it.

use serde::Serialize;
use serde_json::{Value, json};
use shrouds_view::server::{Closed, Frame, Outbox};

/// The page as the session speaks to it.
#[derive(Clone)]
pub(super) struct Page {
    out: Outbox,
}

impl Page {
    pub(super) fn new(out: Outbox) -> Self {
        Self { out }
    }

    /// The answer to a request that was done.
    pub(super) fn answer(&self, id: u64, ok: &impl Serialize) -> Result<(), Closed> {
        self.out.text(json!({ "id": id, "ok": ok }).to_string())
    }

    /// The answer to one that was not, for people.
    pub(super) fn refuse(&self, id: u64, message: &str) -> Result<(), Closed> {
        self.out.text(refusal(Some(id), message))
    }

    /// Something that happened; `what` is an object.
    pub(super) fn event(&self, name: &str, what: Value) -> Result<(), Closed> {
        let mut what = what;
        what["event"] = name.into();
        self.out.text(what.to_string())
    }

    /// What goes on, and which share of it is done, if that is known.
    pub(super) fn progress(&self, stage: &str, share: Option<f64>) {
        // Whoever is not there need not be told.
        let _ = self.event("progress", json!({ "stage": stage, "share": share }));
    }

    pub(super) fn warn(&self, text: &str) {
        let _ = self.event("message", json!({ "level": "warning", "text": text }));
    }

    pub(super) fn is_gone(&self) -> bool {
        self.out.is_closed()
    }

    pub(super) fn frame(&self, frame: Frame) -> Result<(), Closed> {
        self.out.frame(frame)
    }

    /// As [`frame`](Self::frame), but never waits.
    pub(super) fn frame_at_once(&self, frame: Frame) -> Result<(), Closed> {
        self.out.frame_at_once(frame)
    }

    /// That a request was done, from where nothing may wait.
    pub(super) fn agree_at_once(&self, id: u64) {
        self.out.answer(json!({ "id": id, "ok": {} }).to_string());
    }

    /// That a request was not done, from where nothing may wait.
    pub(super) fn refuse_at_once(&self, id: Option<u64>, message: &str) {
        self.out.answer(refusal(id, message));
    }
}

fn refusal(id: Option<u64>, message: &str) -> String {
    json!({ "id": id, "error": message }).to_string()
}
