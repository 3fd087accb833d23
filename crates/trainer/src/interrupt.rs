//! Ctrl-C, SIGTERM, and `q` with Enter.

use crate::error::TrainerError;
use crate::quit;
use estimator::Cancel;

static CANCEL: Cancel = Cancel::new();

/// Exit code of a process that ended on request.
const INTERRUPTED: i32 = 130;

/// The request to stop that Ctrl-C, SIGTERM and `q` with Enter make. A second signal ends the process at once.
pub(crate) fn watch() -> Result<&'static Cancel, TrainerError> {
    let handler = || {
        if CANCEL.is_requested() {
            std::process::exit(INTERRUPTED);
        }
        CANCEL.request();
    };
    ctrlc::set_handler(handler)
        .map_err(|error| TrainerError::System { what: "Ctrl-C", problem: error.to_string() })?;
    quit::watch(&CANCEL);
    Ok(&CANCEL)
}
