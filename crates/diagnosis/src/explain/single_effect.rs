//! One effect at a time: what a diagnosis is held against.

use crate::data::observations::Observations;
use crate::data::segments::{MOST_SEARCHED, cut};
use crate::error::DiagnosisError;
use crate::fit::calibrate::better_hold;
use crate::fit::fitted::Fit;
use crate::fit::stopping::Stopping;
use crate::measurement::signatures as chain_statistics;
use crate::model::candidate::Candidate;
use crate::model::dictionary::Dictionary;
use crate::search::archive::vanished;
use crate::search::gains::alone;
use crate::search::proposals::fit_all;
use dynamics::NominalSimulator;

/// What an effect would take away, and what its parameters cost: N·ln(SS/N) + p·ln N, for N samples with
/// squares SS and p parameters.
fn criterion(fit: &Fit) -> f64 {
    let samples = fit.samples() as f64;
    let starts = fit.point.starts.iter().map(Vec::len).sum::<usize>();
    let parameters = (fit.globals() + starts) as f64;
    samples * (fit.squares / samples).max(f64::MIN_POSITIVE).ln() + parameters * samples.ln()
}

/// The effect that the Bayesian information criterion for white noise prefers, if each effect of the
/// vocabulary is fitted alone beside the calibration, in segments of six periods; `None` where it prefers the
/// recalibrated simulator.
///
/// The usual way to choose a model, here for comparison: no sets, no horizon, no held-out parts, residuals taken to be
/// white, and no answer but an effect of the vocabulary. It fits with the same derivatives as [`crate::diagnose`].
///
/// # Errors
/// As [`crate::diagnose`].
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
    let (data, base) = better_hold(&data, simulator)?;
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
