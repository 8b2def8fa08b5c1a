//! What goes on, shown on a terminal when it takes more than a second.

use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use shrouds::optimize;

/// Work shorter than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
const TICK: Duration = Duration::from_millis(100);

/// Told what is being done, and which share of it is done where that is known.
type Listener = dyn Fn(&str, Option<f64>) -> ControlFlow<()> + Send + Sync;

/// A line that tells what goes on; it disappears when dropped.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// Who else is told, and says whether the work goes on.
    listener: Option<Box<Listener>>,
    is_stopped: AtomicBool,
    waiter: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Hidden for ever when quiet or when nobody watches.
    pub(crate) fn new(quiet: bool) -> Self {
        let bar = ProgressBar::hidden();
        let watched = !quiet && stderr().is_terminal();
        let waiter = watched.then(|| {
            let (stop, stopped) = channel();
            let bar = bar.clone();
            let show = move || {
                if stopped.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(TICK);
                }
            };
            (stop, spawn(show))
        });
        Self { bar, listener: None, is_stopped: AtomicBool::new(false), waiter }
    }

    /// Hidden, but for one who listens.
    pub(crate) fn telling(
        listener: impl Fn(&str, Option<f64>) -> ControlFlow<()> + Send + Sync + 'static,
    ) -> Self {
        let mut hidden = Self::new(true);
        hidden.listener = Some(Box::new(listener));
        hidden
    }

    /// Whether the optimisation goes on.
    pub(crate) fn goes_on(&self) -> ControlFlow<()> {
        match self.is_stopped.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn tell(&self, what: &str, share: Option<f64>) {
        if self.listener.as_ref().is_some_and(|listener| listener(what, share).is_break()) {
            self.is_stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Of which part of the work all that follows is told.
    pub(crate) fn part(&self, name: &str) {
        self.bar.set_prefix(format!("{name}: "));
    }

    /// What is being done now.
    pub(crate) fn stage(&self, what: &str) {
        self.tell(what, None);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}{msg}") {
            self.bar.set_style(style);
        }
        self.bar.unset_length();
        self.bar.set_message(what.to_owned());
    }

    /// How much of a file is read; it has no bytes where its length is not known.
    pub(crate) fn read(&self, done: u64, bytes: u64) {
        if bytes > 0 && self.bar.length() != Some(bytes) {
            let template = "{spinner} reading [{wide_bar}] {bytes} of {total_bytes}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                self.bar.set_style(style.progress_chars("=> "));
            }
            self.bar.set_length(bytes);
        }
        self.bar.set_position(done);
    }

    /// How far the optimisation has come: a bar where its length is known.
    pub(crate) fn optimize(&self, progress: optimize::Progress) {
        const STEPS: u64 = 1000;
        let optimize::Progress { iteration, change, tolerance, share_done, .. } = progress;
        self.tell("optimizing", share_done);
        let Some(share) = share_done else {
            self.bar.set_message(format!(
                "optimizing: iteration {iteration}, change {change:.1e}, until {tolerance:.0e}"
            ));
            return;
        };
        if self.bar.length() != Some(STEPS) {
            let template = "{spinner} {prefix}optimizing [{wide_bar}] {percent} %";
            if let Ok(style) = ProgressStyle::with_template(template) {
                self.bar.set_style(style.progress_chars("=> "));
            }
            self.bar.set_length(STEPS);
        }
        self.bar.set_position((share * STEPS as f64) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((stop, waiter)) = self.waiter.take() {
            drop(stop);
            let _ = waiter.join();
        }
        self.bar.finish_and_clear();
    }
}
