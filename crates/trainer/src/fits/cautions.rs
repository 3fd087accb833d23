//! Common conclusions from a comparison that do not follow from it.

use crate::fits::input::Input;
use oracle::curvature;
use report::format;
use results::{Caution, Derived, EnvelopeSummary, PipelineOutcome, PipelineRow};

/// Size of a bend or a correlation that counts as larger than chance, in standard errors.
const PLAIN: f64 = 3.0;

/// Returns the statements that these numbers do not support, each with the numbers that contradict it.
pub(crate) fn cautions(
    input: &Input,
    summary: &EnvelopeSummary,
    derived: &Derived,
    max_error_percent: f64,
    pipelines: &[PipelineRow],
) -> Vec<Caution> {
    [
        Some(quality_is_not_cycles(derived)),
        peaks_do_not_fill_the_record(input, summary),
        grid_is_not_sampling(input, summary),
        fit_quality_is_not_viscosity(input),
        agreement_is_not_truth(input, max_error_percent, pipelines),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn quality_is_not_cycles(derived: &Derived) -> Caution {
    Caution {
        statement: format!("Q = 1/(2ζ) ≈ {:.0} cycles to decay to 1/e", derived.quality_factor),
        finding: format!(
            "The amplitude falls to 1/e in Q/π = {:.1} cycles. In Q = {:.1} cycles it falls to \
             exp(−π) = 4.3 %.",
            derived.cycles_to_one_over_e, derived.quality_factor
        ),
    }
}

/// Returns a caution if the peaks span less than nine tenths of the record.
fn peaks_do_not_fill_the_record(input: &Input, summary: &EnvelopeSummary) -> Option<Caution> {
    let times = &input.clock.times_s;
    let duration = times.last()? - times.first()?;
    let span = input.extraction.envelope.times_s().last()?;
    (*span < 0.9 * duration).then(|| Caution {
        statement: format!("{} cycles in a record of {duration:.1} s", summary.peaks),
        finding: format!(
            "{} periods of {:.3} s make {:.1} s. The peaks span {span:.1} s; in the remaining {:.1} s \
             the motion is below the prominence asked for, or at rest.",
            summary.peaks,
            summary.period_s,
            summary.peaks as f64 * summary.period_s,
            duration - span
        ),
    })
}

/// Returns a caution if the pipeline interpolates.
fn grid_is_not_sampling(input: &Input, summary: &EnvelopeSummary) -> Option<Caution> {
    let samples = input.record.len();
    (summary.samples != samples).then(|| Caution {
        statement: format!("{} data points", summary.samples),
        finding: format!(
            "The file holds {samples} samples, one every {:.3} ms ({:.2} Hz); the other points are \
             interpolated between them and add no information.",
            1e3 / input.clock.sample_rate_hz,
            input.clock.sample_rate_hz
        ),
    })
}

/// Returns a caution if ln A bends by more than three standard errors or its residuals are correlated, and
/// the effect is large enough to matter.
fn fit_quality_is_not_viscosity(input: &Input) -> Option<Caution> {
    let bend = curvature(&input.extraction.envelope).ok()?;
    let sizes = bend.coefficient.abs() / bend.std_error;
    let correlation = input.oracle.residual_autocorrelation;
    let by_chance = PLAIN / (input.extraction.envelope.len() as f64).sqrt();
    let r_squared = input.oracle.r_squared;
    let conclusion =
        if sizes > PLAIN { "the envelope is not exponential" } else { "the residuals are not independent" };
    ((sizes > PLAIN || correlation > by_chance) && !report::is_exponential(r_squared)).then(|| Caution {
        statement: format!("R² = {r_squared:.3} confirms viscous damping"),
        finding: format!(
            "Under viscous damping ln A is a line with independent residuals. Here a quadratic term is \
             {:.1e} ± {:.1e} 1/s² ({sizes:.1} standard errors from 0), and neighboring residuals \
             correlate by {correlation:.2}: {conclusion}, and a high R² says only that the decay spans many \
             residuals.",
            bend.coefficient, bend.std_error
        ),
    })
}

/// Returns a caution if another pipeline or clock changes ζ by more than the differences between the methods.
fn agreement_is_not_truth(
    input: &Input,
    max_error_percent: f64,
    pipelines: &[PipelineRow],
) -> Option<Caution> {
    let zeta = input.oracle.zeta;
    let moved = pipelines
        .iter()
        .filter_map(|row| match &row.outcome {
            PipelineOutcome::Fit { zeta: other, .. } => Some(100.0 * (other / zeta - 1.0).abs()),
            PipelineOutcome::Failed { .. } => None,
        })
        .fold(0.0, f64::max);
    (moved > max_error_percent).then(|| Caution {
        statement: "The agreement of all methods validates the damping ratio".to_owned(),
        finding: format!(
            "The methods differ by at most {} because all of them solve the same \
             small problem. Another pipeline or clock moves ζ by {moved:.1} %, and one standard error is \
             {:.1} %.",
            format::percent(max_error_percent),
            100.0 * input.oracle.zeta_std_error / zeta
        ),
    })
}
