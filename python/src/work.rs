//! Long work beside the interpreter: other Python threads go on, and Ctrl-C ends it.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use ringdown_lab::contract::Cancel;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// Between two looks at Python's signals.
const LOOK: Duration = Duration::from_millis(50);

/// What work is given: the request to stop, and where to tell how far it is.
pub(crate) struct Watch {
    pub(crate) cancel: Arc<Cancel>,
    told: Sender<String>,
}

impl Watch {
    /// Tells how far the work is; false once it is to stop.
    pub(crate) fn tell(&self, progress: &str) -> bool {
        // Nobody listens after an interruption.
        let _ = self.told.send(progress.to_owned());
        !self.cancel.is_requested()
    }
}

/// Runs work in a thread of its own, detached from the interpreter, and looks meanwhile for signals. A signal's exception, or one of
/// `progress`, is raised at once; the work is asked to stop and ends by itself. `progress` is called with what the work tells.
///
/// # Errors
/// The signal's exception, such as `KeyboardInterrupt`, or that of `progress`.
pub(crate) fn beside<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let cancel = Arc::new(Cancel::new());
    let (told, telling) = channel();
    let watch = Watch { cancel: Arc::clone(&cancel), told };
    let (done, mut waiting) = channel();
    std::thread::spawn(move || {
        let _ = done.send(work(&watch));
    });
    loop {
        // A receiver may be sent to a detached closure, not shared with it.
        let (received, returned) = py.detach(move || (waiting.recv_timeout(LOOK), waiting));
        waiting = returned;
        let heard = telling.try_iter().try_for_each(|line: String| match progress {
            Some(progress) => progress.call1((line,)).map(drop),
            None => Ok(()),
        });
        match received {
            Ok(result) => return heard.map(|()| result),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(signal) = heard.and_then(|()| py.check_signals()) {
                    cancel.request();
                    return Err(signal);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "the computation ended without a result; please report this",
                ));
            }
        }
    }
}

/// Runs work on so many threads, or on all that there are.
///
/// # Errors
/// [`PyRuntimeError`] where the threads cannot be had.
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    match threads {
        None => Ok(work()),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map(|pool| pool.install(work))
            .map_err(|error| PyRuntimeError::new_err(format!("{threads} threads: {error}"))),
    }
}
