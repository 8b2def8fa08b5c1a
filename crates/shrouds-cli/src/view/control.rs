//! What a page wishes of a solver, and how many positions it was sent.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use shrouds_view::server::{Closed, Frame};

use super::page::Page;

/// What a solver is to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Wish {
    Run,
    /// To its next sign of life, and then pause.
    Step,
    Pause,
    #[default]
    Cancel,
}

/// What is to become of work that cannot be stopped on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    Wanted,
    Cancelled,
    /// Something else is shown in its view, or nobody is there.
    Forgotten,
}

/// What page and solver of a view have in common. The page gets new positions when it has drawn those
/// before; what it could not get meanwhile it never gets.
#[derive(Default)]
pub(super) struct Control {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    wish: Wish,
    /// Work of this number and those before must end, whatever is wished of later work.
    ended: u64,
    /// Number of the work that goes on or was the last.
    work: u64,
    is_closed: bool,
    /// Number of the newest packing; those before must end.
    packing: u64,
    /// Whether the work of this view has no steps.
    is_in_one_piece: bool,
    /// The surface of the positions that the page has and has not drawn yet.
    drawing: Option<u32>,
    /// The newest positions that came meanwhile.
    next: Option<Frame>,
}

impl Control {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn wish(&self, wish: Wish) {
        self.lock().wish = wish;
        self.changed.notify_all();
    }

    /// What is wished now.
    pub(super) fn wished(&self) -> Wish {
        self.lock().wish
    }

    /// Ends all work for good.
    pub(super) fn close(&self) {
        let mut state = self.lock();
        (state.is_closed, state.packing) = (true, state.packing + 1);
        drop(state);
        self.changed.notify_all();
    }

    /// Ends the work that goes on.
    pub(super) fn end(&self) {
        let mut state = self.lock();
        (state.ended, state.packing) = (state.work, state.packing + 1);
        drop(state);
        self.changed.notify_all();
    }

    /// The number of work that begins.
    pub(super) fn begin(&self) -> u64 {
        let mut state = self.lock();
        (state.work, state.packing) = (state.work + 1, state.packing + 1);
        state.work
    }

    /// The number of a packing that begins. Whatever changes the surface ends it.
    pub(super) fn begin_packing(&self) -> u64 {
        let mut state = self.lock();
        state.packing += 1;
        state.packing
    }

    /// Ends the packing that goes on.
    pub(super) fn end_packing(&self) {
        self.lock().packing += 1;
    }

    /// Whether this packing is still the newest.
    pub(super) fn is_packing(&self, number: u64) -> bool {
        self.lock().packing == number
    }

    /// Says whether the work of this view can pause and be done step by step.
    pub(super) fn set_in_one_piece(&self, is_in_one_piece: bool) {
        self.lock().is_in_one_piece = is_in_one_piece;
    }

    pub(super) fn is_in_one_piece(&self) -> bool {
        self.lock().is_in_one_piece
    }

    /// What is to become of work in one piece, as it is wished now.
    pub(super) fn fate(&self, work: u64) -> Fate {
        let state = self.lock();
        match () {
            () if state.is_closed || state.ended >= work => Fate::Forgotten,
            () if state.wish == Wish::Cancel => Fate::Cancelled,
            () => Fate::Wanted,
        }
    }

    /// Whether this work is to end. Calls `pausing` before it waits.
    pub(super) fn is_over(&self, work: u64, pausing: impl FnOnce()) -> bool {
        let mut state = self.lock();
        let is_over =
            |state: &State| state.is_closed || state.ended >= work || state.wish == Wish::Cancel;
        if state.wish == Wish::Step {
            state.wish = Wish::Pause;
        }
        if state.wish == Wish::Pause && !is_over(&state) {
            drop(state);
            pausing();
            state = self.lock();
        }
        while state.wish == Wish::Pause && !is_over(&state) {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        is_over(&state)
    }

    /// Sends positions unless the page draws others; then they wait, and take the place of those that
    /// waited.
    pub(super) fn offer(&self, page: &Page, revision: u32, frame: Frame) -> Result<(), Closed> {
        let mut state = self.lock();
        if state.drawing == Some(revision) {
            state.next = Some(frame);
            return Ok(());
        }
        (state.next, state.drawing) = (None, Some(revision));
        drop(state);
        page.frame(frame)
    }

    /// Sends positions that have to arrive, and none before them that still wait.
    pub(super) fn send(&self, page: &Page, revision: u32, frame: Frame) -> Result<(), Closed> {
        let mut state = self.lock();
        (state.next, state.drawing) = (None, Some(revision));
        drop(state);
        page.frame(frame)
    }

    /// The page has drawn what it has of a surface.
    pub(super) fn acknowledge(&self, page: &Page, revision: u32) {
        let mut state = self.lock();
        if state.drawing != Some(revision) {
            return;
        }
        // Sent under the lock, so that nothing newer goes before.
        let sent = state.next.take().map(|frame| page.frame_at_once(frame));
        state.drawing = matches!(sent, Some(Ok(()))).then_some(revision);
    }
}
