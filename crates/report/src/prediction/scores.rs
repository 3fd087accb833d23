//! Table of a problem: a row for each method.

use results::{Coverage, HeldOutScore, PredictionOutcome, PredictionRow, ProblemStudy};

use crate::format::{count, duration, fixed, significant};
use crate::tables::{ScoreRow, ScoreTable, whole};

/// Explanation of these tables.
pub(super) const READING: [&str; 4] = [
    "Errors are root mean squares of predicted minus observed ln A over the held-out peaks; for a \
     simulation, the median over the draws that all methods were fitted to. Â/A is the same error as a \
     relative error of the amplitude; a predicted state of rest has an error of 100 %. “To truth” is the \
     error against the noise-free ln A. Rows are sorted by the error beyond the last fitted peak.",
    "ln p is the mean logarithm of the density that a method states for a held-out ln A, Gaussian with its \
     own standard deviation: higher is better, and a difference of 0.1 is a factor of 1.1 in the density per \
     peak. “In 95 %” is the share of held-out peaks within 1.96 stated standard deviations, with a 95 % \
     interval of that share by Korn and Graubard, peaks of one draw or block counting as one cluster.",
    "“Projected slope in λ’s interval” counts the draws in which the stated 95 % interval of λ contains the \
     projected slope (minus the least-squares slope of the noise-free ln A over the fitted peaks). “Viscous \
     λ” counts those in which it contains λ of the law’s viscous part. If the envelope is not exponential, \
     these are different quantities, and an interval can be right about only one of them. Intervals of these \
     shares are by Clopper and Pearson.",
    "“Against exponential” counts draws, or blocks of peaks, in which a method’s mean square error is smaller \
     than that of the best exponential (closed-form least squares on the same peaks), and in which it is \
     larger; ties to six digits are left out. p is of the two-sided sign test, adjusted by Holm’s method for \
     all comparisons of the problem. Blocks of one record share most of their fitted peaks and are not quite \
     independent.",
];

/// Returns the table of a problem. The highlighted row is the best exponential, with which the others are
/// compared.
pub(super) fn table(study: &ProblemStudy) -> ScoreTable {
    let has_truth = study.law.is_some();
    let mut columns = vec!["method", "error inside", "error beyond", "Â/A beyond, %"];
    if has_truth {
        columns.extend(["to truth inside", "to truth beyond"]);
    }
    columns.extend(["ln p inside", "ln p beyond", "in 95 % inside, %", "in 95 % beyond, %"]);
    if has_truth {
        columns.extend(["projected slope in λ’s interval, %", "viscous λ in it, %"]);
    }
    columns.push("against exponential inside");
    if has_truth {
        columns.push("against exponential beyond");
        columns.push("draws");
    }
    columns.extend(["fits converged", "time"]);

    let exponential = &study.exponential;
    let mut cells = held_out(Some(&exponential.interpolation), Some(&exponential.extrapolation), has_truth);
    cells.resize(columns.len() - 1, String::new());
    let reference =
        ScoreRow { title: "Best exponential".to_owned(), cells, reason: String::new(), is_marked: true };
    let place = study.methods.iter().position(|row| error(row) >= exponential.extrapolation.rms_log_error);
    let mut rows: Vec<ScoreRow> = study.methods.iter().map(|row| view(row, has_truth)).collect();
    rows.insert(place.unwrap_or(rows.len()), reference);
    ScoreTable { columns: columns.into_iter().map(str::to_owned).collect(), rows }
}

/// Returns the error by which rows are ordered.
pub(super) fn error(row: &PredictionRow) -> f64 {
    let score = super::study::scored(row).and_then(|scores| scores.extrapolation.as_ref());
    // A row without a score, or with a score that is not finite, comes last.
    score.map(|score| score.rms_log_error).filter(|error| !error.is_nan()).unwrap_or(f64::INFINITY)
}

fn view(row: &PredictionRow, has_truth: bool) -> ScoreRow {
    let title = match row.number {
        Some(number) => format!("{number} {}", row.title),
        None => row.title.clone(),
    };
    let silent = |title, reason| ScoreRow { title, cells: Vec::new(), reason, is_marked: false };
    let scores = match &row.outcome {
        PredictionOutcome::Scored(scores) => scores,
        PredictionOutcome::Failed { reason } => return silent(title, format!("no fit: {reason}")),
    };
    let (inside, beyond) = (scores.interpolation.as_ref(), scores.extrapolation.as_ref());
    if inside.is_none() && beyond.is_none() {
        return silent(title, "no prediction: the method gives a decay rate only".to_owned());
    }
    let mut cells = held_out(inside, beyond, has_truth);
    if has_truth {
        cells.push(share(scores.covers_projected_slope.as_ref()));
        cells.push(share(scores.covers_viscous_rate.as_ref()));
    }
    cells.push(against(inside));
    if has_truth {
        cells.push(against(beyond));
        cells.push(match scores.failed_fits {
            0 => whole(scores.draws),
            failed => format!("{}; {} fits failed", whole(scores.draws), whole(failed)),
        });
    }
    let percent = 100.0 * scores.converged as f64 / scores.fits.max(1) as f64;
    cells.push(format!("{} %", fixed(percent, 0)));
    cells.push(duration(scores.seconds));
    ScoreRow { title, cells, reason: String::new(), is_marked: false }
}

fn held_out(inside: Option<&HeldOutScore>, beyond: Option<&HeldOutScore>, has_truth: bool) -> Vec<String> {
    let number = |score: Option<&HeldOutScore>, of: fn(&HeldOutScore) -> Option<f64>, digits| {
        score.and_then(of).map_or_else(dash, |value| significant(value, digits))
    };
    let rms = |score| number(score, |score| Some(score.rms_log_error), 3);
    let mut cells =
        vec![rms(inside), rms(beyond), number(beyond, |score| Some(score.amplitude_error_percent), 3)];
    if has_truth {
        cells.push(number(inside, |score| score.truth_rms_log_error, 3));
        cells.push(number(beyond, |score| score.truth_rms_log_error, 3));
    }
    let density = |score: Option<&HeldOutScore>| {
        score.and_then(|score| score.mean_log_density).map_or_else(dash, |density| fixed(density, 2))
    };
    cells.extend([density(inside), density(beyond)]);
    let coverage = |score: Option<&HeldOutScore>| share(score.and_then(|score| score.coverage.as_ref()));
    cells.extend([coverage(inside), coverage(beyond)]);
    cells
}

/// Returns a share in percent with its interval, or as a count if there is no interval.
fn share(coverage: Option<&Coverage>) -> String {
    let Some(coverage) = coverage else { return dash() };
    match coverage.interval_95 {
        Some([low, high]) => format!(
            "{} [{}, {}]",
            fixed(100.0 * coverage.held as f64 / coverage.of.max(1) as f64, 1),
            fixed(100.0 * low, 1),
            fixed(100.0 * high, 1)
        ),
        None => format!("{} of {}", whole(coverage.held), whole(coverage.of)),
    }
}

fn against(score: Option<&HeldOutScore>) -> String {
    let Some(pair) = score.and_then(|score| score.against_exponential.as_ref()) else { return dash() };
    if pair.better + pair.worse == 0 {
        return "the same".to_owned();
    }
    let counts = format!("{} : {}", count(pair.better as u64), count(pair.worse as u64));
    format!("{counts}, p {}", probability(pair.adjusted_p_value))
}

fn probability(value: f64) -> String {
    if value < 1e-3 { format!("{value:.0e}") } else { fixed(value, 3) }
}

fn dash() -> String {
    "–".to_owned()
}
