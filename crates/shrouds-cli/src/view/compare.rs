//! The table of energies, row by row as it comes.

use std::ops::ControlFlow;

use serde_json::json;

use super::request::{Settings, Slot};
use super::typed::Typed;
use super::volumes::Name;
use super::worker::{Ended, Worker};
use crate::commands::compare::{Row, candidates};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::truth::Body;

impl Worker {
    pub(super) fn compare(
        &self,
        id: u64,
        slot: Slot,
        energies: &[String],
        settings: &Settings,
    ) -> Result<(), Ended> {
        let data = self.data(slot)?;
        let typed = Typed::read(settings)?;
        if typed.materials {
            let message = "energies are compared on one body; leave 'materials' out";
            return Err(Failure::Call(message.into()).into());
        }
        let list = (!energies.is_empty()).then(|| energies.join(";"));
        let candidates = candidates(list.as_deref(), &typed.args.solve)?;
        let body = match &data.name {
            Name::Demo(name, size) => Body::of_phantom(name, *size),
            _ => None,
        };
        let count = candidates.len();
        for (n, candidate) in candidates.iter().enumerate() {
            let page = self.page.clone();
            let stage = format!("{} of {count}, {}", n + 1, candidate.name);
            let progress = Progress::telling(move |what, share| {
                page.progress(&format!("{stage}: {what}"), share);
                if page.is_gone() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let (row, _) = Row::new(candidate, &data.source, body.as_ref(), 0, &progress);
            let mut told = json!(row);
            told["name"] = candidate.name.as_str().into();
            self.page
                .event("row", json!({ "row": told, "number": n + 1, "of": count }))
                .map_err(|_| Ended::Closed)?;
        }
        self.answer(id, &json!({ "rows": count }))
    }
}
