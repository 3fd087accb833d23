//! Guidelines for choosing a method, from the paper's Table 6, beside this run's numbers.

use results::{ComparisonResult, MethodEstimate, MethodRow};

use super::parts::{WordTable, estimates};
use super::verdict::listed;
use crate::format::{count, duration, fixed, percent, significant};
use crate::tables::whole;
use crate::verdict::in_a_sentence;

/// Numbers of methods in the paper's tables.
const ORDINARY: u8 = 1;
const NORMAL_EQUATIONS: u8 = 3;
const QR: u8 = 4;
const SVD: u8 = 5;
const WEIGHTED: u8 = 11;

/// Smallest number of peaks of a large fit of a line.
const LARGE: usize = 100_000;
/// Condition number from which on the normal equations, which square it, lose a quarter of a double's digits.
const HARD: f64 = 100.0;

pub(super) fn guidelines(result: &ComparisonResult) -> WordTable {
    let rows = [
        ("Standard analysis", "Linear regression (OLS) – fastest, exact", standard_analysis(result)),
        ("Large datasets", "QR or SVD decomposition – numerically stable", large_datasets(result)),
        ("Noisy data", "Weighted LS with variance-based weights", noisy_data(result)),
        ("Embedded systems", "Normal equations – simple implementation", embedded(result)),
        ("Uncertainty quantification", "Multiple methods for cross-validation", uncertainty(result)),
        ("Closest to certified least squares", "–", closest(result)),
    ];
    WordTable {
        id: "guidelines",
        title: "Table 6: choosing a method".to_owned(),
        note:
            "The paper’s guidelines, each beside the result of this run. All times come from one record on \
             one machine: they rank the methods only roughly, and times of microseconds do not rank them at \
             all."
                .to_owned(),
        columns: ["Scenario", "The paper’s guideline", "This run"],
        rows: rows.map(|(scenario, paper, run)| [scenario.to_owned(), paper.to_owned(), run]).into(),
        is_prose: true,
    }
}

fn standard_analysis(result: &ComparisonResult) -> String {
    let own = of(result, ORDINARY, "Ordinary least squares", |estimate| {
        format!("{}, {}", duration(estimate.seconds), digits(estimate))
    });
    match fastest(result) {
        Some((row, _)) if row.number == Some(ORDINARY) => format!("{own}; the fastest."),
        Some((row, estimate)) => {
            format!("{own}. Fastest: {}, {}.", in_a_sentence(&row.title), duration(estimate.seconds))
        }
        None => own + ".",
    }
}

fn large_datasets(result: &ComparisonResult) -> String {
    let each = [(QR, "QR"), (SVD, "SVD"), (NORMAL_EQUATIONS, "normal equations")]
        .map(|(number, name)| of(result, number, name, digits))
        .join("; ");
    let (peaks, condition) = (result.envelope.peaks, result.oracle.condition);
    let verdict =
        if peaks < LARGE && condition < HARD { ", which is neither large nor ill-conditioned" } else { "" };
    format!(
        "{each}; on {} peaks with a condition number of {}{verdict}.",
        whole(peaks),
        significant(condition, 3)
    )
}

fn noisy_data(result: &ComparisonResult) -> String {
    match (numbered(result, WEIGHTED), numbered(result, ORDINARY)) {
        (Some((_, weighted)), Some((_, ordinary))) => {
            let moved = 100.0 * (weighted.zeta / ordinary.zeta - 1.0).abs();
            format!(
                "Weighted and ordinary regression differ by {}. This run does not test the guideline, \
                 because the noise was not varied.",
                if moved == 0.0 { "nothing".to_owned() } else { percent(moved) }
            )
        }
        _ => "Weighted and ordinary regression did not both give an estimate.".to_owned(),
    }
}

fn embedded(result: &ComparisonResult) -> String {
    let own = of(result, NORMAL_EQUATIONS, "Normal equations", |estimate| {
        format!(
            "{}, {}, {} parameters",
            duration(estimate.seconds),
            digits(estimate),
            whole(estimate.parameters)
        )
    });
    let slowest = estimates(result)
        .filter(|(_, e)| e.seconds.is_finite())
        .max_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds));
    match slowest {
        Some((row, estimate)) => format!(
            "{own}. Slowest: {}, {}, {} parameters.",
            in_a_sentence(&row.title),
            duration(estimate.seconds),
            whole(estimate.parameters)
        ),
        None => own + ".",
    }
}

fn uncertainty(result: &ComparisonResult) -> String {
    let stating: Vec<String> = estimates(result)
        .filter(|(_, estimate)| estimate.zeta_std_error.is_some())
        .map(|(row, _)| in_a_sentence(&row.title))
        .collect();
    let share = 100.0 * (result.oracle.zeta_std_error / result.oracle.zeta).abs();
    let who = if stating.is_empty() {
        "No method states a standard error".to_owned()
    } else {
        format!(
            "{} of {} methods state a standard error: {}",
            stating.len(),
            result.results.len(),
            listed(&stating)
        )
    };
    format!(
        "{who}. The methods differ from certified least squares by {} at most; its standard error is {} of \
         ζ. Agreement between methods is no measure of uncertainty.",
        percent(result.max_error_percent),
        percent(share)
    )
}

fn closest(result: &ComparisonResult) -> String {
    let Some(most) =
        estimates(result).map(|(_, estimate)| estimate.digits_of_agreement).max_by(f64::total_cmp)
    else {
        return "No method gave an estimate.".to_owned();
    };
    // Compared as displayed.
    let shown = fixed(most, 1);
    let names: Vec<String> = estimates(result)
        .filter(|(_, estimate)| fixed(estimate.digits_of_agreement, 1) == shown)
        .map(|(row, _)| in_a_sentence(&row.title))
        .collect();
    let total = count(u64::try_from(names.len()).unwrap_or(u64::MAX));
    let who = if names.len() == 1 { "one method".to_owned() } else { format!("{total} methods") };
    format!("{shown} digits, by {who}: {}.", listed(&names))
}

fn fastest(result: &ComparisonResult) -> Option<(&MethodRow, &MethodEstimate)> {
    estimates(result)
        .filter(|(_, e)| e.seconds.is_finite())
        .min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds))
}

/// Returns the paper's method with a number, if it gave an estimate.
fn numbered(result: &ComparisonResult, number: u8) -> Option<(&MethodRow, &MethodEstimate)> {
    estimates(result).find(|(row, _)| row.number == Some(number))
}

/// Returns a statement on the paper's method with a number, or that it gave no estimate.
fn of(result: &ComparisonResult, number: u8, name: &str, say: impl Fn(&MethodEstimate) -> String) -> String {
    match result.results.iter().find(|row| row.number == Some(number)) {
        Some(row) => match row.outcome.estimate() {
            Some(found) => format!("{name}: {}", say(found)),
            None => format!("{name}: no estimate"),
        },
        None => format!("{name}: not fitted"),
    }
}

fn digits(estimate: &MethodEstimate) -> String {
    format!("{} digits", fixed(estimate.digits_of_agreement, 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::sample;
    use results::MethodOutcome;

    fn said(result: &ComparisonResult, row: usize) -> String {
        guidelines(result).rows[row][2].replace(['\u{a0}', '\u{202f}'], " ")
    }

    #[test]
    fn what_is_said_comes_from_the_rows() {
        let result = sample::result();
        assert_eq!(
            said(&result, 0),
            "Ordinary least squares: 1.10 µs, 15.7 digits. Fastest: normal equations, 840 ns."
        );
        assert!(said(&result, 1).starts_with("QR: 15.7 digits; SVD: 15.5 digits; normal equations: 14.9"));
        assert!(said(&result, 2).starts_with("Weighted and ordinary regression differ by nothing."));
        assert!(said(&result, 3).contains("Slowest: transformer, 48.2 s, 4737 parameters."));
        assert!(said(&result, 4).starts_with("5 of 21 methods state a standard error: "));
        assert!(said(&result, 5).starts_with("15.7 digits, by "), "{}", said(&result, 5));
    }

    #[test]
    fn methods_that_were_not_fitted_or_failed_are_named_as_such() {
        let mut result = sample::result();
        result.results[0].outcome = MethodOutcome::Failed { reason: "x".into() };
        result.results.retain(|row| row.number != Some(QR));
        assert!(said(&result, 0).starts_with("Ordinary least squares: no estimate. Fastest:"));
        assert!(said(&result, 1).starts_with("QR: not fitted; SVD: "));
        assert!(said(&result, 2).contains("did not both"));
        result.results.clear();
        assert_eq!(said(&result, 0), "Ordinary least squares: not fitted.");
        assert!(said(&result, 4).starts_with("No method states"));
        assert_eq!(said(&result, 5), "No method gave an estimate.");
    }
}
