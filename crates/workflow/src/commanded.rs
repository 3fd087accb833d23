//! Recordings of a body that follows a commanded position.

use crate::error::WorkflowError;
use crate::read::Loaded;
use experiment::StatedNominal;
use record::extremes;

/// Number of steps of the sensor within which a body counts as standing still.
const STILL: f64 = 3.0;

/// Correlation from which a column follows another one.
const FOLLOWS: f64 = 0.2;

/// Returns the commanded positions of a record, after their column's name; `None` if its input is not in the unit of
/// its values.
fn command(loaded: &Loaded) -> Option<(&str, &[f64])> {
    let reading = &loaded.source.reading;
    let input = reading.input.as_ref()?;
    let is_position = input.unit.is_some() && input.unit == reading.value.unit;
    loaded.record.input().filter(|_| is_position).map(|values| (input.column.as_str(), values))
}

/// Returns `true` if the commanded position, or the body that it commands, stands still within the sensor's steps.
pub(crate) fn is_still(loaded: &Loaded) -> bool {
    let Some((_, command)) = command(loaded) else { return false };
    let step = loaded.record.quantum();
    [command, loaded.record.values()].into_iter().map(extremes).any(|[low, high]| high - low <= STILL * step)
}

/// Says that a recording was left out.
pub(crate) fn left_out_still(file: &str) -> String {
    format!(
        "{file} is left out: its command stands still or the joint does not follow it, so it tells nothing"
    )
}

/// Returns the correlation of a body's steps with its distance from the command.
///
/// With u the command, y the position and k the loop's gain, the loop does the work k·∫(u − y) dy on the body. Springs,
/// masses and weights give back what they took, and every loss takes more, so that the work is positive. The distance is
/// taken half way through each step: noise adds no work then.
fn work(command: &[f64], position: &[f64]) -> f64 {
    let pairs = || command.iter().zip(position);
    let steps: Vec<[f64; 2]> = pairs()
        .zip(pairs().skip(1))
        .map(|((u, y), (next_u, next_y))| [next_y - y, 0.5 * (u - y + next_u - next_y)])
        .collect();
    let mean = steps.iter().map(|[_, distance]| distance).sum::<f64>() / steps.len().max(1) as f64;
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        steps.iter().map(|&[step, distance]| of(step, distance - mean)).sum::<f64>()
    };
    let size = (sum(&|step, _| step * step) * sum(&|_, distance| distance * distance)).sqrt();
    sum(&|step, distance| step * distance) / size.max(f64::MIN_POSITIVE)
}

/// Checks that a position follows its command, and not the command the position.
///
/// # Errors
/// [`WorkflowError::Exchanged`] if the columns are exchanged.
pub(crate) fn check_columns(
    loaded: &Loaded,
    stated: &StatedNominal,
    file: &str,
) -> Result<(), WorkflowError> {
    let Some((column, command)) = command(loaded).filter(|_| stated.nominal.commands_position()) else {
        return Ok(());
    };
    let position = loaded.record.values();
    if work(command, position) >= 0.0 || work(position, command) < FOLLOWS {
        return Ok(());
    }
    Err(WorkflowError::Exchanged {
        file: file.to_owned(),
        command: column.to_owned(),
        position: loaded.source.reading.value.column.clone(),
    })
}
