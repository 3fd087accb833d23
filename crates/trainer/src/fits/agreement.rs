//! Agreement of pipelines and clocks on a record, in one sentence.

use report::format;
use results::{DataSummary, PipelineOutcome, PipelineRow};

/// Distance between two answers above which they disagree, in standard errors of their difference.
const PLAIN: f64 = 3.0;

/// Relative distance between two angular frequencies above which they disagree. It exceeds the scatter of
/// peaks: the median of periods does not average, and on a grid of 2 ms a period of 0.3 s is known to 0.35 %.
const FREQUENCY: f64 = 0.01;

/// One answer: a pipeline and a clock, and what closed-form least squares finds with them.
struct Answer<'a> {
    row: &'a PipelineRow,
    omega: f64,
    zeta: f64,
    error: f64,
}

/// Returns a sentence if another pipeline or clock gives a different answer; `None` if all agree. It stands
/// below the answer, unless another answer is to be believed (see [`report::is_believed`]).
pub(crate) fn disagreement(rows: &[PipelineRow], data: &DataSummary) -> Option<String> {
    let answers: Vec<Answer<'_>> = rows.iter().filter_map(answer).collect();
    let own = answers.iter().find(|answer| answer.row.in_force)?;
    let differ_in_zeta =
        |other: &Answer<'_>| (other.zeta - own.zeta).abs() > PLAIN * own.error.hypot(other.error);
    let differ_in_omega = |other: &Answer<'_>| (other.omega / own.omega - 1.0).abs() > FREQUENCY;
    let differing: Vec<&Answer<'_>> = answers
        .iter()
        .filter(|other| !other.row.in_force && (differ_in_zeta(other) || differ_in_omega(other)))
        .collect();
    // Only the numbers that differ are compared.
    let has_zeta = differing.iter().any(|other| differ_in_zeta(other));
    let has_omega = differing.iter().any(|other| differ_in_omega(other));
    let numbers = |of: &Answer<'_>| {
        let zeta = has_zeta.then(|| format!("ζ = {}", format::with_uncertainty(of.zeta, of.error)));
        let omega = has_omega.then(|| format!("ω = {} rad/s", format::significant(of.omega, 4)));
        zeta.into_iter().chain(omega).collect::<Vec<_>>().join(" and ")
    };
    let said: Vec<String> =
        differing.iter().map(|other| format!("{} gives {}", name(other.row), numbers(other))).collect();
    (!said.is_empty()).then(|| {
        format!(
            "Other ways of finding the peaks, or other sample times, give other numbers: {}. This answer, by {}, \
             has {}. {}",
            said.join("; "),
            name(own.row),
            numbers(own),
            belief(rows, data)
        )
    })
}

fn answer(row: &PipelineRow) -> Option<Answer<'_>> {
    match row.outcome {
        PipelineOutcome::Fit { omega_rad_s, zeta, zeta_std_error, .. } => {
            Some(Answer { row, omega: omega_rad_s, zeta, error: zeta_std_error })
        }
        PipelineOutcome::Failed { .. } => None,
    }
}

fn name(row: &PipelineRow) -> String {
    let whose = match row.pipeline.as_str() {
        "paper" => "the paper’s way",
        "samples" => "windows of the samples",
        _ => "the recommended way",
    };
    format!("{whose} on {}", times(&row.clock))
}

/// Describes the sample times of a clock.
fn times(clock: &str) -> &'static str {
    match clock {
        "host" => "the times in the file",
        "uniform-index" => "evenly spaced times",
        _ => "evenly spaced times and the gaps in the file",
    }
}

/// Recommends the answer to believe, with the reason.
fn belief(rows: &[PipelineRow], data: &DataSummary) -> String {
    let why = format!(
        "it uses the samples as they are, on {}, which the record supports; the paper’s way interpolates between \
         the times in the file",
        times(&data.believed_clock)
    );
    if report::is_believed(rows, data) {
        format!("Keep it: {why}.")
    } else {
        format!("Use the recommended way instead (data.clock=auto envelope.pipeline=recommended): {why}.")
    }
}

#[cfg(test)]
mod tests {
    use super::disagreement;
    use results::{DataSummary, PipelineOutcome, PipelineRow};
    use serde_json::{from_value, json};

    fn row(pipeline: &str, in_force: bool, zeta: f64, omega_rad_s: f64) -> PipelineRow {
        PipelineRow {
            pipeline: pipeline.into(),
            clock: "host".into(),
            in_force,
            outcome: PipelineOutcome::Fit {
                peaks: 50,
                omega_rad_s,
                decay_rate: zeta * omega_rad_s,
                zeta,
                zeta_std_error: 1e-5,
                r_squared: 0.99,
            },
        }
    }

    fn said(rows: &[PipelineRow]) -> Option<String> {
        let data: DataSummary = from_value(json!({
            "path": "", "digest": "", "origin": "unstated", "samples": 9, "clock": "host", "clock_reason": "",
            "believed_clock": "host", "believed_clock_reason": "", "sample_period_s": 0.01,
            "sample_rate_hz": 100.0, "sample_rate_std_error_hz": 0.0, "resolution": null, "unit": "rad",
            "findings": []
        }))
        .unwrap();
        disagreement(rows, &data)
    }

    #[test]
    fn what_differs_is_said_in_its_numbers_and_nothing_else() {
        let own = row("recommended", true, 0.0123, 20.0);
        assert_eq!(said(&[own.clone(), row("paper", false, 0.012_31, 20.1)]), None);
        let text = said(&[own.clone(), row("paper", false, 0.0125, 20.1)]).unwrap();
        assert!(text.contains("the paper’s way on the times in the file gives ζ = 0.012500"), "{text}");
        assert!(!text.contains("ω") && text.contains("Keep it"), "{text}");
        let text = said(&[own, row("paper", false, 0.0123, 21.0)]).unwrap();
        assert!(text.contains("gives ω = 21.00 rad/s") && !text.contains('ζ'), "{text}");
        let text =
            said(&[row("paper", true, 0.0125, 20.0), row("recommended", false, 0.0123, 20.0)]).unwrap();
        assert!(text.contains("envelope.pipeline=recommended"), "{text}");
    }
}
