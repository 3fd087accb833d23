//! Agreement of pipelines and clocks on a record, in one sentence.

use report::format;
use results::{DataSummary, PipelineOutcome, PipelineRow};

/// Distance between two answers above which they disagree, in standard errors of their difference.
const PLAIN: f64 = 3.0;

/// Relative distance between two angular frequencies above which they disagree. It exceeds the scatter of
/// peaks: the median of periods does not average, and on a grid of 2 ms a period of 0.3 s is known to 0.35 %.
const FREQUENCY: f64 = 0.01;

/// Returns a warning if another pipeline or clock gives a different answer; `None` if all agree. It is shown
/// before any other sentence.
pub(crate) fn disagreement(rows: &[PipelineRow], data: &DataSummary) -> Option<String> {
    let fits: Vec<(&PipelineRow, [f64; 3])> = rows
        .iter()
        .filter_map(|row| match row.outcome {
            PipelineOutcome::Fit { omega_rad_s, zeta, zeta_std_error, .. } => {
                Some((row, [omega_rad_s, zeta, zeta_std_error]))
            }
            PipelineOutcome::Failed { .. } => None,
        })
        .collect();
    let (own, [omega, zeta, error]) = *fits.iter().find(|(row, _)| row.in_force)?;
    let apart = |other: &[f64; 3]| {
        let [other_omega, other_zeta, other_error] = *other;
        ((other_zeta - zeta).abs() / error.hypot(other_error), other_omega / omega - 1.0)
    };
    let differing: Vec<(&PipelineRow, f64, f64)> = fits
        .iter()
        .filter(|(row, _)| !row.in_force)
        .map(|(row, other)| (*row, apart(other).0, apart(other).1))
        .filter(|(_, errors, share)| *errors > PLAIN || share.abs() > FREQUENCY)
        .collect();
    let how = |(row, errors, share): &(&PipelineRow, f64, f64)| {
        let zeta = (*errors > PLAIN).then(|| format!("ζ {errors:.1} standard errors away"));
        let omega =
            (share.abs() > FREQUENCY).then(|| format!("ω {} away", format::percent(100.0 * share.abs())));
        let away: Vec<String> = zeta.into_iter().chain(omega).collect();
        format!("{} puts {}", name(row), away.join(" and "))
    };
    let said: Vec<String> = differing.iter().map(how).collect();
    (!said.is_empty()).then(|| {
        format!(
            "Pipelines or clocks disagree on this record: compared with {}, which is in force, {}. {}",
            name(own),
            said.join("; "),
            belief(own, data)
        )
    })
}

fn name(row: &PipelineRow) -> String {
    format!("the {} pipeline on the {} clock", row.pipeline, row.clock)
}

/// Recommends the answer to believe, with the reason.
fn belief(own: &PipelineRow, data: &DataSummary) -> String {
    let why = format!(
        "it uses the samples as they are, on the clock that the record supports ({}); the paper's pipeline \
         interpolates between the stamps",
        data.believed_clock
    );
    if own.pipeline == "recommended" && own.clock == data.believed_clock {
        format!("Use the one in force: {why}.")
    } else {
        format!(
            "Use the recommended pipeline on the {} clock (data.clock=auto envelope.pipeline=recommended): \
             {why}.",
            data.believed_clock
        )
    }
}
