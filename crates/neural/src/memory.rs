//! Memory limit of a network's fit, checked before any matrix is allocated: a failed allocation would end the
//! program.

use settings::{Resolved, SettingsError};

/// Largest number of bytes that a fit's matrices may take: 16 GiB. A fit of this size also takes hours.
const MOST_BYTES: f64 = 16.0 * GIB;
const GIB: f64 = (1_u64 << 30) as f64;
/// Number of matrices of one kind held at the same time. In `Laplace::about`, these are parameters ×
/// parameters: the normal matrix, its factor, the peaks' part of it, and the solution with the factor.
/// Jacobians are also held before and after they are joined.
const AT_ONCE: f64 = 4.0;

/// Refuses hidden widths (`estimator.hidden`) whose `parameters` need more memory than allowed.
///
/// The matrices hold doubles, parameters × parameters and points × parameters; `points` is the number of
/// points that the settings ask for.
///
/// # Errors
/// [`SettingsError::BadValue`] with the size and the setting to reduce.
pub fn check_memory(settings: &Resolved, parameters: usize, points: usize) -> Result<(), SettingsError> {
    let (columns, rows) = (parameters as f64, points as f64);
    let bytes = AT_ONCE * columns * (columns + rows) * size_of::<f64>() as f64;
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    let hidden = settings.setting("estimator.hidden")?;
    let at_points = if points == 0 { String::new() } else { format!(" at {points} collocation points") };
    Err(SettingsError::BadValue {
        origin: hidden.origin.clone(),
        key: hidden.key(),
        found: hidden.value.as_ref().map_or_else(String::new, ToString::to_string),
        expected: format!(
            "fewer or narrower layers: the matrices of {parameters} parameters{at_points} take {:.0} GiB of \
             memory; the limit is {:.0} GiB",
            (bytes / GIB).ceil(),
            MOST_BYTES / GIB
        ),
        unit: String::new(),
    })
}
