//! Interruption by Ctrl-C, SIGTERM, or `q` with Enter: the program ends within a second, whatever it
//! computes.
//!
//! A computation is first asked to stop; one that has steps ends after the current step, with a result. A
//! single step can take longer than a second: a factorization of a large matrix, a diagnosis. The program
//! then ends in the middle of it. Files saved before are whole, since every file is written under a temporary
//! name and renamed; resuming continues from them.

use crate::error::TrainerError;
use crate::terminal::console;
use crate::terminal::quit;
use estimator::Cancel;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

static CANCEL: Cancel = Cancel::new();
/// Number of threads that are writing results.
static SAVING: AtomicUsize = AtomicUsize::new(0);

/// Exit code of a process that ended on request.
const INTERRUPTED: i32 = 130;
/// Time that a computation has to end by itself: a second, less the time to notice the request and to free
/// memory.
const PATIENCE: Duration = Duration::from_millis(750);
/// Pause between two checks for a request.
const LOOK: Duration = Duration::from_millis(20);

/// Guard that keeps the program from ending while results are being written.
#[derive(Debug)]
pub(crate) struct Saving(());

impl Saving {
    pub(crate) fn begin() -> Self {
        SAVING.fetch_add(1, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Saving {
    fn drop(&mut self) {
        SAVING.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Returns the request to stop that Ctrl-C, SIGTERM and `q` with Enter make, for work that has steps. A
/// second signal ends the process at once.
pub(crate) fn watch() -> Result<&'static Cancel, TrainerError> {
    watch_for(
        PATIENCE,
        "interrupted within a step; everything saved before it is kept, and --resume continues from there",
    )
}

/// Returns the request to stop for work that has no result before its end: the process ends without waiting.
pub(crate) fn watch_impatiently() -> Result<&'static Cancel, TrainerError> {
    watch_for(Duration::ZERO, "interrupted; nothing was written")
}

fn watch_for(patience: Duration, remark: &'static str) -> Result<&'static Cancel, TrainerError> {
    let handler = || {
        if CANCEL.is_requested() {
            std::process::exit(INTERRUPTED);
        }
        CANCEL.request();
    };
    ctrlc::set_handler(handler)
        .map_err(|error| TrainerError::System { what: "Ctrl-C", problem: error.to_string() })?;
    quit::watch(&CANCEL);
    // The thread ends with the program; nothing waits for it.
    std::thread::spawn(move || {
        while !CANCEL.is_requested() {
            std::thread::sleep(LOOK);
        }
        std::thread::sleep(patience);
        while SAVING.load(Ordering::SeqCst) > 0 {
            std::thread::sleep(LOOK);
        }
        console::remark(remark);
        std::process::exit(INTERRUPTED);
    });
    Ok(&CANCEL)
}
