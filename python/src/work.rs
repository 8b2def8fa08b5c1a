//! Long work beside the interpreter: its lock released, Ctrl-C heard, progress told.
//!
//! The work runs on a thread of its own; the calling thread waits, looks for signals twenty times a
//! second and calls Python's callback. When it has to leave, because of Ctrl-C or an exception in the
//! callback, it leaves at once; the work notices when it next tells its progress, and ends.

use std::ops::ControlFlow;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use shrouds::optimize::Progress;

use crate::pool::pool;

/// How long Ctrl-C may go unheard.
const PATIENCE: Duration = Duration::from_millis(50);

/// Iteration, energy, change, tolerance, and the share that is done, if known: what the callback gets.
type Moment = (usize, f64, f64, f64, Option<f64>);

/// What the work tells the thread that waits for it.
enum News<T> {
    Progress(Moment),
    Done(T),
}

/// The end of the work from which progress is told.
pub(crate) struct Teller<T> {
    news: Sender<News<T>>,
    answers: Receiver<ControlFlow<()>>,
}

impl<T> Teller<T> {
    /// Tells how far the work has come and waits for the answer whether to go on. Nobody to answer
    /// means no.
    pub(crate) fn tell(&self, progress: Progress) -> ControlFlow<()> {
        let Progress { iteration, energy, change, tolerance, share_done, .. } = progress;
        let now = (iteration, energy, change, tolerance, share_done);
        match self.news.send(News::Progress(now)) {
            Ok(()) => self.answers.recv().unwrap_or(ControlFlow::Break(())),
            Err(_) => ControlFlow::Break(()),
        }
    }
}

/// Runs `work` as the module says. `progress` is called with every [`Moment`] that the work tells; where it
/// returns False the work stops.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Teller<T>) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = pool(threads)?;
    let (news, mut arrivals) = mpsc::channel();
    let (to_work, answers) = mpsc::channel();
    let teller = Teller { news: news.clone(), answers };
    let start = thread::Builder::new().name("shrouds".into()).spawn(move || {
        let done = pool.install(move || work(&teller));
        // Nobody waits for it any more after an interruption.
        let _ = news.send(News::Done(done));
    });
    start.map_err(|error| PyRuntimeError::new_err(format!("no thread to work on: {error}")))?;
    loop {
        let arrivals = &mut arrivals;
        match py.detach(move || arrivals.recv_timeout(PATIENCE)) {
            Ok(News::Done(result)) => return Ok(result),
            Ok(News::Progress(now)) => {
                py.check_signals()?;
                // The work waits for the answer, so it is there to hear it.
                let _ = to_work.send(answer(progress, now)?);
            }
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                let message = "the work broke off: a defect of shrouds, please report it";
                return Err(PyRuntimeError::new_err(message));
            }
        }
    }
}

/// Runs work that tells no progress.
pub(crate) fn run_quietly<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    run(py, threads, None, |_| work())
}

/// What Python's callback says to go on or not.
fn answer(progress: Option<&Bound<'_, PyAny>>, now: Moment) -> PyResult<ControlFlow<()>> {
    let Some(callback) = progress else { return Ok(ControlFlow::Continue(())) };
    let answer = callback.call1(now)?;
    let stops = answer.extract::<bool>().is_ok_and(|goes_on| !goes_on);
    Ok(if stops { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
}
