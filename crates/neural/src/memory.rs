//! What the matrices of a network's fit take, known before one is made: an allocation that fails ends the program.

use settings::{Resolved, SettingsError};

/// Most bytes that a fit's matrices may take: 16 GiB. A fit that takes them computes for hours, too.
const MOST_BYTES: f64 = 16.0 * GIB;
const GIB: f64 = (1_u64 << 30) as f64;
/// Matrices of one kind that are held at once: in `Laplace::about` parameters by parameters the normal matrix, its
/// factor, the peaks' part of it and what the factor makes of that; Jacobians before and after they are put together.
const AT_ONCE: f64 = 4.0;

/// Refuses hidden widths, `estimator.hidden`, whose `parameters` take more memory than there may be: matrices
/// of doubles, parameters by parameters and points by parameters, where `points` are those that the settings
/// ask for.
///
/// # Errors
/// [`SettingsError::BadValue`] with the size and what to reduce.
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
            "fewer or narrower layers: the matrices of {parameters} parameters{at_points} take {:.0} GiB of memory, of \
             which there may be {:.0}",
            (bytes / GIB).ceil(),
            MOST_BYTES / GIB
        ),
        unit: String::new(),
    })
}
