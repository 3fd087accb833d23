//! Ctrl-C and SIGTERM.

use crate::error::TrainerError;
use estimator::Cancel;

static CANCEL: Cancel = Cancel::new();

/// Exit code of a process that ended on request.
const INTERRUPTED: i32 = 130;

/// The request to stop that Ctrl-C and SIGTERM make. A second one ends the process at once.
pub(crate) fn watch() -> Result<&'static Cancel, TrainerError> {
    let handler = || {
        if CANCEL.is_requested() {
            std::process::exit(INTERRUPTED);
        }
        CANCEL.request();
    };
    ctrlc::set_handler(handler)
        .map_err(|error| TrainerError::System { what: "Ctrl-C", problem: error.to_string() })?;
    Ok(&CANCEL)
}
