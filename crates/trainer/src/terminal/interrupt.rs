//! Ctrl-C, SIGTERM, and `q` with Enter: the program ends within a second, whatever it computes.
//!
//! Who computes is asked first, and who has steps ends after the one in progress, with a result. A single step can take
//! longer than that: a factorization of a large matrix, a diagnosis. The program then leaves in the middle of it. What
//! was kept before is whole, since every file is written beside its place and moved there; resuming goes on from it.

use crate::error::TrainerError;
use crate::terminal::console;
use crate::terminal::quit;
use estimator::Cancel;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

static CANCEL: Cancel = Cancel::new();
/// How many threads are writing results.
static SAVING: AtomicUsize = AtomicUsize::new(0);

/// Exit code of a process that ended on request.
const INTERRUPTED: i32 = 130;
/// What is computed has so long to end by itself: a second, less what it takes to notice and to give memory back.
const PATIENCE: Duration = Duration::from_millis(750);
/// Between two looks at whether somebody asked.
const LOOK: Duration = Duration::from_millis(20);

/// Results are being written as long as this lives: the program is not left meanwhile.
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

/// The request to stop that Ctrl-C, SIGTERM and `q` with Enter make, for work that has steps. A second signal ends the
/// process at once.
pub(crate) fn watch() -> Result<&'static Cancel, TrainerError> {
    watch_for(
        PATIENCE,
        "interrupted within a step; everything saved before it is kept, and --resume continues from there",
    )
}

/// The same for work that has nothing to show before its end.
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
    // It ends with the program; nothing waits for it.
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
