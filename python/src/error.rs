//! Errors as Python exceptions with the command line's message.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyValueError};
use ringdown_lab::Error;

create_exception!(ringdown_lab, RingdownError, PyValueError, "Reason why a call gave no answer.");
create_exception!(ringdown_lab, RecordError, RingdownError, "A record that cannot be read or used.");
create_exception!(
    ringdown_lab,
    ConfigError,
    RingdownError,
    "A nominal simulator or an option with a wrong value."
);
create_exception!(
    ringdown_lab,
    DiagnosisError,
    RingdownError,
    "Records from which the nominal simulator cannot be diagnosed."
);
create_exception!(ringdown_lab, FitError, RingdownError, "A method that gave no estimate or no model.");

/// The exception for an error.
pub(crate) fn raised(error: Error) -> PyErr {
    let message = error.to_string();
    match error {
        Error::Record(_) | Error::Envelope { .. } | Error::Learn(_) => RecordError::new_err(message),
        Error::Config(_) | Error::Simulation(_) => ConfigError::new_err(message),
        Error::Diagnosis(_) => DiagnosisError::new_err(message),
        Error::LeastSquares { .. } | Error::Fit { .. } | Error::NotFinite { .. } => {
            FitError::new_err(message)
        }
        Error::File(_) => PyOSError::new_err(message),
        _ => RingdownError::new_err(message),
    }
}
