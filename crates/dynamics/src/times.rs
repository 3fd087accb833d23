//! Checks on lists of times.

use crate::error::DynamicsError;

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
