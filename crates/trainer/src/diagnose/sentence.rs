//! The verdict and its limits in plain sentences.

use super::result::title;
use diagnosis::{Diagnosis, Status};
use report::{format, in_a_sentence};

/// What the diagnosis comes to, in one sentence.
pub(crate) fn verdict(found: &Diagnosis) -> String {
    let gap = &found.gap;
    let floor = if gap.ratio_to_floor.value.is_finite() {
        format!("{} times the noise floor", format::significant(gap.ratio_to_floor.value, 3))
    } else {
        format!("{} {}", format::significant(gap.repaired, 3), gap.unit)
    };
    // Beyond √2 floors more than half of what is left, by its square, is something else than noise.
    let rest = if gap.ratio_to_floor.interval_95.first().is_some_and(|low| low.powi(2) > 2.0) {
        "; most of the remaining error is not noise"
    } else if found.verdict.left_over > 0.5 {
        "; part of the remaining error is not noise"
    } else {
        ""
    };
    match found.verdict.status {
        Status::None => format!(
            "Nothing is missing: the simulator as given explains what was recorded, down to {floor} on parts that \
             were not fitted."
        ),
        Status::Calibration => format!(
            "Only the coefficients were off: recalibrated, the simulator explains what was recorded down to {floor} \
             on parts that were not fitted, and no effect is missing{rest}."
        ),
        Status::Effect if by_kind(found).0.is_empty() => format!(
            "{}; beside that nothing is missing: {} explains what was recorded down to {floor} on parts that were \
             not fitted{rest}.",
            lacking(found),
            if is_off(found) { "recalibrated, the simulator" } else { "the simulator as given" }
        ),
        Status::Effect => format!(
            "{}{}; recalibrated and repaired, the simulator closes {} of the gap and leaves {floor} on parts \
             that were not fitted{rest}.",
            lacking(found),
            repeating(found).map_or_else(String::new, |torque| format!("; {torque} acts besides")),
            if gap.closure.value >= 1.0 { "all".to_owned() } else { closed(gap.closure.value) }
        ),
        Status::Unknown => format!(
            "Something is missing that no known effect explains{}, so it is left unnamed{}.",
            match repeating(found) {
                Some(torque) => format!(": {torque} acts; with it the simulator leaves {floor}{rest}"),
                None => format!(": the best named model leaves {floor}, and what it leaves is no noise"),
            },
            match found.verdict.effects.is_empty() {
                true => String::new(),
                false => format!("; {}", in_a_sentence(&lacking(found))),
            }
        ),
    }
}

/// The torque without a name in words, where there is one.
fn repeating(found: &Diagnosis) -> Option<String> {
    let row = found.effects.iter().find(|row| row.id == "unknown" && row.gap_share.is_some())?;
    let wavenumber = row.parameters.iter().find(|own| own.name == "wavenumber")?;
    let value = wavenumber.estimate.value;
    // Of a length it is stated how far apart the waves are.
    let often = if wavenumber.unit == "1" {
        format!("{} times a turn", format::significant(value, 3))
    } else {
        format!("every {} m", format::significant(std::f64::consts::TAU / value, 3))
    };
    Some(format!("a torque without a name that repeats {often}"))
}

/// Whether the simulator's coefficients are more probably off than right.
fn is_off(found: &Diagnosis) -> bool {
    let probability =
        |id: &str| found.effects.iter().find(|row| row.id == id).map_or(0.0, |row| row.probability);
    probability("calibration") > probability("none")
}

/// Effects of the verdict that were fitted, and those that the record shows without a fit: stamps in bursts, say.
fn by_kind(found: &Diagnosis) -> (Vec<&'static str>, Vec<&'static str>) {
    let is_fitted = |id: &&'static str| {
        found
            .effects
            .iter()
            .any(|row| row.id == *id && (row.gap_share.is_some() || !row.parameters.is_empty()))
    };
    found.verdict.effects.iter().copied().partition(is_fitted)
}

/// What is missing, and what the record shows.
fn lacking(found: &Diagnosis) -> String {
    let (fitted, seen) = by_kind(found);
    match (fitted.is_empty(), seen.is_empty()) {
        (false, true) => format!("The simulator lacks {}", names(&fitted)),
        (false, false) => {
            format!("The simulator lacks {}, and the record shows {}", names(&fitted), names(&seen))
        }
        (true, _) => format!("The record shows {}, which the simulator lacks", names(&seen)),
    }
}

/// Titles of ids as they stand in a sentence, with an `and` before the last.
fn names(ids: &[&str]) -> String {
    let titles: Vec<String> = ids.iter().map(|id| in_a_sentence(&title(id))).collect();
    match titles.as_slice() {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// Why no experiment is proposed.
pub(crate) fn no_experiment(found: &Diagnosis) -> &'static str {
    match found.verdict.status {
        Status::None | Status::Calibration => "None: no effect was named, so there is nothing to confirm.",
        Status::Effect => "None: no other effect explains these records as well as what was named.",
        Status::Unknown => {
            "None that these data suggest: what is missing has no name yet. A second release from another amplitude \
             tells whether it depends on amplitude or on time."
        }
    }
}

/// A share in words that a file keeps: with an ordinary space, which whoever searches it types.
fn closed(share: f64) -> String {
    format::share(share).replace('\u{a0}', " ")
}
