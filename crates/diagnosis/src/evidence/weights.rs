//! From scores to probabilities and a verdict.

use crate::data::segments::Data;
use crate::evidence::likelihood::Likelihood;
use crate::evidence::score::further_starts;
use crate::fit::levenberg_marquardt::Fit;
use crate::noise::statistics::chi_squared_above;
use crate::search::archive::Archive;
use rayon::prelude::*;

/// Differences of log evidence are divided by this before they become probabilities. 1 takes the tempered
/// evidence at its word; a training bank may teach another value.
pub(crate) const TEMPERATURE: f64 = 1.0;

/// Prior odds of a set of so many effects, each size as a whole, against none.
const PRIOR_ODDS: [f64; 6] = [1.0, 1.0, 0.5, 0.25, 0.125, 0.0625];

/// Share of what recalibration leaves that is without a name, at which `unknown` is as likely a verdict as
/// the named effects that explain the rest.
///
/// In training banks nearly every set that leaves something behind is wrong, however little it is: the
/// smaller this share, the better. But laws of the vocabulary are idealizations of what acts in a machine,
/// and a set that explains all but a few hundredths of a gap is worth its names, with the confidence that
/// [`crate::confidence`] gives it.
pub(crate) const UNKNOWN_SHARE: f64 = 0.03;

/// How steeply the odds of `unknown` grow with that share: a factor e⁴ from one half of it to twice it.
const UNKNOWN_STEEPNESS: f64 = 2.885_390_081_777_927;

/// Prior odds that something acts that has no name. A likelihood ratio of two variances that chance alone
/// exceeds once in a thousand records makes them even.
const UNKNOWN_ODDS: f64 = 0.01;

/// Log evidence that makes them even.
pub(crate) const EVEN: f64 = 4.605_170_185_988_091;

/// A set with its evidence.
#[derive(Debug, Clone)]
pub(crate) struct Weighed<'a> {
    pub(crate) fit: &'a Fit,
    /// Tempered log evidence relative to the calibrated simulator.
    pub(crate) evidence: f64,
    pub(crate) probability: f64,
}

/// Log likelihood ratio of a fit over another on the same data, tempered.
pub(crate) fn ratio(fit: &Fit, other: &Fit, time: f64) -> f64 {
    let worth = fit.samples() as f64 / time;
    0.5 * worth * (other.squares.max(f64::MIN_POSITIVE) / fit.squares.max(f64::MIN_POSITIVE)).ln()
}

/// What sets of effects are weighed by on the same samples.
#[derive(Debug, Clone)]
pub(crate) struct Weighing<'a> {
    data: &'a Data,
    calibrated: &'a Fit,
    likelihood: Likelihood,
    /// Log likelihood of the calibrated simulator.
    bare: f64,
    threshold: f64,
    vocabulary: usize,
}

impl<'a> Weighing<'a> {
    /// Beside what the closest set of an archive leaves.
    pub(crate) fn of(
        data: &'a Data,
        calibrated: &'a Fit,
        archive: &Archive,
        threshold: f64,
        vocabulary: usize,
    ) -> Self {
        let closest = archive.fits.iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        let closest = &closest.unwrap_or(calibrated).residuals;
        let noise = crate::noise::floor::floor(data, closest).value;
        let likelihood = Likelihood::of(data, &data.by_part(closest), noise);
        let bare = likelihood.log(&data.by_part(&calibrated.residuals));
        Self { data, calibrated, likelihood, bare, threshold, vocabulary }
    }

    /// Log evidence of a set relative to the calibrated simulator.
    ///
    /// A set of k effects has to pay the larger of the Bayesian information criterion's price of its parameters
    /// and k times half the gain that chance alone exceeds with the false-alarm probability: where the best of
    /// all candidates gains exactly that, a set with it is as likely as the calibrated simulator alone.
    pub(crate) fn evidence(&self, fit: &Fit) -> f64 {
        let size = fit.hypothesis.candidates.len();
        let parameters = fit.globals().saturating_sub(self.calibrated.globals()) + further_starts(fit);
        let price = 0.5 * parameters as f64 * self.likelihood.worth().ln();
        let own = self.likelihood.log(&self.data.by_part(&fit.residuals));
        own - self.bare - price - beyond(size, price, self.threshold, self.vocabulary)
    }

    /// Every set with its probability, best first; the calibrated simulator alone is the empty one.
    pub(crate) fn weigh<'b>(&self, archive: &'b Archive) -> Vec<Weighed<'b>> {
        let of = |fit: &'b Fit| Weighed { fit, evidence: self.evidence(fit), probability: 0.0 };
        let mut weighed: Vec<Weighed<'b>> = archive.fits.par_iter().map(of).collect();
        weighed.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let best = weighed.first().map_or(0.0, |w| w.evidence);
        let total: f64 = weighed.iter().map(|w| ((w.evidence - best) / TEMPERATURE).exp()).sum();
        for w in &mut weighed {
            w.probability = ((w.evidence - best) / TEMPERATURE).exp() / total;
        }
        weighed
    }
}

/// What a set of so many effects pays beyond the `price` of its parameters: for having been chosen from a vocabulary.
pub(crate) fn beyond(size: usize, price: f64, threshold: f64, vocabulary: usize) -> f64 {
    // The odds of a size are shared by all sets of it, beyond what the threshold has paid for the choice.
    let odds = PRIOR_ODDS.get(size).copied().unwrap_or(0.1);
    let sets = if size > 1 { (vocabulary as f64).ln() } else { 0.0 };
    (0.5 * size as f64 * threshold - price).max(0.0) - odds.ln() + 0.5 * sets
}

/// Probability that anything acts that has no name, from the evidence for it.
pub(crate) fn acts(evidence: f64) -> f64 {
    1.0 / (1.0 + (-evidence).exp() / UNKNOWN_ODDS)
}

/// Probability that the answer is something without a name: that anything without a name acts, times how much
/// of the gap it would be. The odds that it is the answer are (share/0.03)^2.885.
pub(crate) fn unknown(acts: f64, share: f64) -> f64 {
    let odds = (share.max(0.0) / UNKNOWN_SHARE).powf(UNKNOWN_STEEPNESS);
    acts * odds / (1.0 + odds)
}

/// Whether fitting `parameters` coefficients improves a fit more than chance does with a given probability.
pub(crate) fn significant(better: &Fit, worse: &Fit, time: f64, parameters: usize, chance: f64) -> bool {
    2.0 * ratio(better, worse, time) > chi_squared_above(parameters as f64, chance)
}

#[cfg(test)]
mod tests {
    use super::{EVEN, acts, unknown};

    #[test]
    fn unknown_follows_its_rule() {
        assert!((unknown(1.0, 0.03) - 0.5).abs() < 1e-12);
        let odds = |share: f64| unknown(1.0, share) / (1.0 - unknown(1.0, share));
        assert!((odds(0.06) / odds(0.015) / 4.0_f64.exp() - 1.0).abs() < 1e-9);
        assert!((unknown(acts(0.0), 0.03) - 0.5 * 0.01 / 1.01).abs() < 1e-12);
        // One record in a thousand exceeds ln 100 by chance.
        assert!((acts(100.0_f64.ln()) - 0.5).abs() < 1e-12);
        assert!((acts(EVEN) - 0.5).abs() < 1e-12);
    }
}
