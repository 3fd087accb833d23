//! The verdict and its limits in plain sentences.

use super::result::title;
use diagnosis::{Diagnosis, Status};
use report::format;

/// What the diagnosis comes to, in one sentence.
pub(crate) fn verdict(found: &Diagnosis) -> String {
    let gap = &found.gap;
    let floor = if gap.ratio_to_floor.value.is_finite() {
        format!("{} times the noise floor", format::significant(gap.ratio_to_floor.value, 3))
    } else {
        format!("{} {}", format::significant(gap.repaired, 3), gap.unit)
    };
    let names = names(&found.verdict.effects);
    match found.verdict.status {
        Status::None => format!(
            "Nothing is missing: the simulator as given explains what was recorded, down to {floor} on parts that \
             were not fitted."
        ),
        Status::Calibration => format!(
            "Only the coefficients were off: recalibrated, the simulator explains what was recorded down to {floor} \
             on parts that were not fitted, and no effect is missing."
        ),
        Status::Effect => format!(
            "The simulator lacks {names}: with that and recalibrated, {closed} of the gap close{s} and {floor} \
             are left on parts that were not fitted.",
            closed = percent(gap.closure.value),
            s = "s",
        ),
        Status::Unknown => {
            let beside = match found.verdict.effects.is_empty() {
                true => String::new(),
                false => format!(" beside {names}"),
            };
            format!(
                "Something is missing that no known effect explains{beside}: the best named model leaves {floor}, \
                 and a torque without a name predicts better; it is left unnamed."
            )
        }
    }
}

/// Titles of ids, with an `and` before the last.
pub(crate) fn names<T: AsRef<str>>(ids: &[T]) -> String {
    let titles: Vec<String> = ids.iter().map(|id| title(id.as_ref())).collect();
    match titles.as_slice() {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// Why no experiment is proposed.
pub(crate) fn no_experiment(found: &Diagnosis) -> &'static str {
    match found.verdict.status {
        Status::None | Status::Calibration => {
            "None: nothing was named that would have to be told from something else."
        }
        Status::Effect => "None: nothing fitted here could stand in the place of what was named.",
        Status::Unknown => {
            "None that these data suggest: what is missing has no name yet. A second release from another amplitude \
             tells whether it depends on amplitude or on time."
        }
    }
}

/// A share in percent; not beyond what its rounding can carry near 1.
pub(crate) fn percent(share: f64) -> String {
    let left = (1.0 - share).abs();
    let decimals = if left < 0.001 && left > 0.0 { 3 } else { 1 };
    format!("{} %", format::fixed(100.0 * share, decimals))
}
