//! How well a set of effects is supported by the data.

use crate::fit::Fit;

/// Tempered log evidence S = −(N/2τ)·ln(SS/N) − (p/2)·ln(N/τ), up to a constant common to all hypotheses on the same
/// data.
///
/// N samples whose residual has the integrated autocorrelation time τ carry the information of N/τ: white residuals
/// get full power, a misfit that all hypotheses share is discounted. Start states are the same in number for all
/// but hypotheses with a second body, whose further ones count among the parameters.
pub(crate) fn score(fit: &Fit, autocorrelation_time: f64) -> f64 {
    let samples = fit.samples() as f64;
    let worth = samples / autocorrelation_time;
    let extra = fit.point.starts.iter().map(|start| start.len().saturating_sub(2)).sum::<usize>();
    let parameters = (fit.globals() + extra) as f64;
    let mean = (fit.squares / samples).max(f64::MIN_POSITIVE);
    -0.5 * worth * mean.ln() - 0.5 * parameters * worth.max(2.0).ln()
}
