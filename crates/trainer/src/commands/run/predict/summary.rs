//! Terminal output of `task = "predict"`: a table for each problem.

use crate::terminal::table::table;
use report::format;
use results::{
    Coverage, HeldOutScore, MethodScores, PredictionOutcome, PredictionResult, PredictionRow, ProblemOutcome,
    ProblemRow, ProblemStudy,
};
use std::path::Path;

const HEADER: [&str; 10] =
    ["method", "inside", "beyond", "%", "truth", "log p", "in 95 %", "λ in 95 %", "draws", "s"];

/// Formats the result for the terminal.
pub(super) fn summary(result: &PredictionResult, folder: &Path) -> String {
    let splits = &result.splits;
    let mut parts = vec![format!(
        "held out inside: blocks of {} peaks, one of {}; beyond: the last {:.0} % of the peaks\nerrors are \
         RMS of ln A; the columns from % on are for the peaks beyond; λ means the projected slope",
        splits.block_peaks,
        splits.every,
        100.0 * splits.last_share
    )];
    parts.extend(result.problems.iter().map(problem));
    parts.push(format!(
        "{:.1} s of fits\nrun: {1}\nreport: {1}/report.html",
        result.seconds,
        folder.display()
    ));
    parts.join("\n\n")
}

fn problem(row: &ProblemRow) -> String {
    let head = format!("{} ({})", row.title, row.origin.name().to_uppercase());
    match &row.outcome {
        ProblemOutcome::Absent { reason } => format!("{head}\nABSENT: {reason}"),
        ProblemOutcome::Studied(study) => {
            let source = match (&study.law, &study.data) {
                (Some(law), _) => format!("{}; {}", law.equation, law.parameters),
                (None, Some(data)) => data.path.clone(),
                (None, None) => String::new(),
            };
            let equations: Vec<String> = study.methods.iter().filter_map(equation).collect();
            let mut lines = vec![
                format!("{head}, {} peaks in {:.2} s: {source}", study.peaks, study.duration_s),
                table(&HEADER, rows(study)),
            ];
            let (_, waiting) = begun(study);
            if !waiting.is_empty() {
                let names: Vec<&str> = waiting.iter().map(|row| row.id.as_str()).collect();
                lines.push(format!("interrupted before these were fitted: {}", names.join(", ")));
            }
            lines.extend(equations);
            lines.extend(study.verdict.iter().cloned());
            lines.join("\n")
        }
    }
}

/// Splits the methods into those with an outcome and those not begun when the run was interrupted.
fn begun(study: &ProblemStudy) -> (Vec<&PredictionRow>, Vec<&PredictionRow>) {
    study.methods.iter().partition(|row| !row.outcome.is_not_begun())
}

/// Builds the rows of a problem. Methods that draw the same line as the best exponential share its row.
fn rows(study: &ProblemStudy) -> Vec<Vec<String>> {
    let (lines, others): (Vec<&PredictionRow>, Vec<&PredictionRow>) =
        begun(study).0.into_iter().partition(|row| is_same_line(row, study));
    let mut rows: Vec<(f64, Vec<String>)> = others.into_iter().map(|row| (error(row), cells(row))).collect();
    let exponential = &study.exponential;
    let mut cells = vec![match lines.len() {
        0 => "best exponential".to_owned(),
        count => format!("best exponential (and {count} methods)"),
    }];
    cells.extend(scores(&exponential.interpolation, &exponential.extrapolation));
    cells.extend([String::new(), String::new(), String::new()]);
    rows.push((exponential.extrapolation.rms_log_error, cells));
    rows.sort_by(|one, other| one.0.total_cmp(&other.0));
    rows.into_iter().map(|(_, cells)| cells).collect()
}

fn error(row: &PredictionRow) -> f64 {
    match &row.outcome {
        PredictionOutcome::Scored(scores) => {
            scores.extrapolation.as_ref().map_or(f64::NAN, |score| score.rms_log_error)
        }
        PredictionOutcome::Failed { .. } => f64::NAN,
    }
}

/// Returns `true` if a method's errors equal those of the best exponential to six digits.
fn is_same_line(row: &PredictionRow, study: &ProblemStudy) -> bool {
    let PredictionOutcome::Scored(scores) = &row.outcome else { return false };
    let (Some(inside), Some(beyond)) = (&scores.interpolation, &scores.extrapolation) else { return false };
    let is_tied =
        |score: &HeldOutScore| score.against_exponential.is_none_or(|pair| pair.better + pair.worse == 0);
    let reference = study.exponential.extrapolation.rms_log_error;
    let is_near = (beyond.rms_log_error - reference).abs() <= 1e-6 * reference;
    scores.failed_fits == 0 && is_tied(inside) && is_tied(beyond) && is_near
}

fn cells(row: &PredictionRow) -> Vec<String> {
    let mut cells = vec![row.id.clone()];
    match &row.outcome {
        PredictionOutcome::Failed { reason } => cells.push(format!("FAILED: {reason}")),
        PredictionOutcome::Scored(scores) => {
            match (&scores.interpolation, &scores.extrapolation) {
                (Some(inside), Some(beyond)) => cells.extend(self::scores(inside, beyond)),
                _ => {
                    cells.push("no prediction".to_owned());
                    cells.extend(std::iter::repeat_n(String::new(), 5));
                }
            }
            cells.extend([
                scores.covers_projected_slope.as_ref().map_or_else(dash, counted),
                draws(scores),
                format!("{:.3}", scores.seconds),
            ]);
        }
    }
    cells
}

fn draws(scores: &MethodScores) -> String {
    match scores.failed_fits {
        0 => scores.draws.to_string(),
        failed => format!("{}, {failed} FAILED", scores.draws),
    }
}

fn scores(inside: &HeldOutScore, beyond: &HeldOutScore) -> [String; 6] {
    [
        short(inside.rms_log_error),
        short(beyond.rms_log_error),
        short(beyond.amplitude_error_percent),
        beyond.truth_rms_log_error.map_or_else(dash, short),
        beyond.mean_log_density.map_or_else(dash, |density| format::fixed(density, 2)),
        beyond.coverage.as_ref().map_or_else(dash, percent),
    ]
}

fn short(value: f64) -> String {
    format::significant(value, 3)
}

fn dash() -> String {
    "-".to_owned()
}

fn percent(coverage: &Coverage) -> String {
    format!("{:.0} %", 100.0 * coverage.held as f64 / coverage.of as f64)
}

fn counted(coverage: &Coverage) -> String {
    format!("{}/{}", coverage.held, coverage.of)
}

fn equation(row: &PredictionRow) -> Option<String> {
    let PredictionOutcome::Scored(scores) = &row.outcome else { return None };
    let equation = scores.equation.as_ref()?;
    Some(match &scores.commonest_form {
        Some((form, count)) if scores.draws > 1 => {
            format!("{}: {equation} (first draw; {count} of {} draws: {form})", row.id, scores.draws)
        }
        _ => format!("{}: {equation}", row.id),
    })
}
