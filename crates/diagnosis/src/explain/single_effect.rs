//! Selection of one effect at a time: the baseline that a diagnosis is compared with.

use crate::data::observations::Observations;
use crate::data::segments::{MOST_SEARCHED, cut};
use crate::error::DiagnosisError;
use crate::fit::calibrate::best_hold;
use crate::fit::fitted::Fit;
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::Dictionary;
use crate::measurement::signatures as chain_statistics;
use crate::model::candidate::Candidate;
use crate::search::gains::alone;
use crate::sets::archive::vanished;
use crate::sets::proposals::fit_all;
use dynamics::NominalSimulator;

/// Returns the Bayesian information criterion of a fit: N·ln(SS/N) + p·ln N, for N samples with sum of
/// squares SS and p parameters.
fn criterion(fit: &Fit) -> f64 {
    let samples = fit.samples() as f64;
    let starts = fit.point.starts.iter().map(Vec::len).sum::<usize>();
    let parameters = (fit.globals() + starts) as f64;
    samples * libm::log((fit.squares / samples).max(f64::MIN_POSITIVE)) + parameters * libm::log(samples)
}

/// Returns the effect that the Bayesian information criterion for white noise prefers if each effect of the
/// vocabulary is fitted alone beside the calibration, in segments of six periods; `None` if it prefers the
/// recalibrated simulator.
///
/// This is the usual way to choose a model, provided for comparison: no sets, no longer shooting intervals,
/// no held-out parts, residuals assumed to be white, and no answer other than an effect of the vocabulary. It
/// fits with the same derivatives as [`crate::diagnose`].
///
/// # Errors
/// Returns the same errors as [`crate::diagnose`].
///
/// # Reference
/// Schwarz, Annals of Statistics 6 (1978) 461.
pub fn single_effect(
    records: &[Observations],
    simulator: impl Into<NominalSimulator>,
) -> Result<Option<&'static str>, DiagnosisError> {
    let simulator = &simulator.into();
    let kept: Vec<Vec<bool>> = records.iter().map(chain_statistics::kept).collect();
    let all = cut(records, &kept, simulator)?;
    let data = all.sparser(MOST_SEARCHED).thinned(MOST_SEARCHED);
    let (data, base) = best_hold(&data, simulator)?;
    let candidates = Candidate::that_apply(&data.facts, data.quantity, simulator);
    let dictionary = Dictionary::at(&data, &base.calibrated, &candidates)?;
    let proposals = alone(&data, &base.calibrated, &dictionary);
    let fits = fit_all(&data, &proposals, |_| Stopping::SEARCH);
    let there = fits.iter().filter(|fit| !vanished(&data, fit));
    let best = std::iter::once(&base.calibrated)
        .chain(there)
        .min_by(|one, other| criterion(one).total_cmp(&criterion(other)));
    Ok(best.and_then(|best| best.hypothesis.candidates.first()).map(|candidate| candidate.id()))
}
