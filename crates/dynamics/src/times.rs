//! Ends of lists of times, and checks on them.

use crate::error::DynamicsError;

/// Returns the first and the last of some times; zeros without any.
pub(crate) fn ends(times: &[f64]) -> (f64, f64) {
    times.first().copied().zip(times.last().copied()).unwrap_or_default()
}

/// Rejects times that are not finite or that decrease.
pub(crate) fn check(times: &[f64]) -> Result<(), DynamicsError> {
    let mut before = f64::NEG_INFINITY;
    for (index, &value) in times.iter().enumerate() {
        if !value.is_finite() || value < before {
            return Err(DynamicsError::BadTimes { index, value });
        }
        before = value;
    }
    Ok(())
}
