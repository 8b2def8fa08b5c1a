//! The threads that work is done on.

use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

const MOST_THREADS: usize = 1024;

/// The threads of the last call, for the next one.
static LAST: Mutex<Option<Kept>> = Mutex::new(None);

struct Kept {
    process: u32,
    threads: Option<usize>,
    pool: Arc<ThreadPool>,
}

/// As many threads as are wanted, or as the machine has: those of the last call if they fit.
///
/// A process that was forked, as those of `multiprocessing` may be, has the memory of its parent and none of
/// its threads, so it starts its own.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    if threads.is_some_and(|threads| !(1..=MOST_THREADS).contains(&threads)) {
        let message = format!("threads must be between 1 and {MOST_THREADS}, or None for all");
        return Err(PyValueError::new_err(message));
    }
    let process = process::id();
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(kept) = &*last
        && kept.process == process
        && kept.threads == threads
    {
        return Ok(kept.pool.clone());
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let pool = pool.map_err(|error| {
        PyRuntimeError::new_err(format!("no threads to work on: {error}; give fewer threads"))
    })?;
    let pool = Arc::new(pool);
    let before = last.replace(Kept { process, threads, pool: pool.clone() });
    if let Some(parents) = before.filter(|kept| kept.process != process) {
        // Nobody is there to be told to end.
        std::mem::forget(parents);
    }
    Ok(pool)
}
