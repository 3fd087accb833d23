//! From scores to probabilities and a verdict.

use crate::data::segments::Data;
use crate::evidence::likelihood::{Likelihood, View};
use crate::evidence::score::{further_starts, parameter_price};
use crate::fit::fitted::Fit;
use crate::model::candidate::Candidate;
use crate::noise::statistics::chi_squared_above;
use crate::search::archive::Archive;
use rayon::prelude::*;

/// Share of what recalibration leaves that is without a name, at which `unknown` is as likely a verdict as
/// the named effects that explain the rest.
///
/// In training banks nearly every set that leaves something behind is wrong, however little it is: the
/// smaller this share, the better. But laws of the vocabulary are idealizations of what acts in a machine,
/// and a set that explains all but a few hundredths of a gap is worth its names.
const UNKNOWN_SHARE: f64 = 0.03;

/// How steeply the odds of `unknown` grow with that share: a factor e⁴ from one half of it to twice it.
const UNKNOWN_STEEPNESS: f64 = 2.885_390_081_777_927;

/// Prior odds that something acts that has no name. A likelihood ratio of two variances that chance alone
/// exceeds once in a thousand records makes them even.
const UNKNOWN_ODDS: f64 = 0.01;

/// Log evidence that makes them even.
pub(crate) const EVEN: f64 = 4.605_170_185_988_091;

/// Distance in noise units below which two explanations are one class: 2·1.645, so that either is mistaken for the
/// other in one of twenty records.
pub const DISTINCT_DISTANCE: f64 = 3.29;

/// A set with its evidence.
#[derive(Debug, Clone)]
pub(crate) struct Weighed<'a> {
    pub(crate) fit: &'a Fit,
    /// Tempered log evidence relative to the calibrated simulator.
    pub(crate) evidence: f64,
    pub(crate) probability: f64,
}

impl Weighed<'_> {
    /// The evidence where nothing is left that flexible effects could soak up: whether that is so is known only once sets
    /// were asked what they predict.
    fn if_nothing_is_left(&self) -> f64 {
        self.evidence + FLEXIBLE * self.fit.hypothesis.flexible() as f64
    }
}

/// Sets that are kept for the case that nothing is left.
const CLEAN: usize = 2;

/// The best [`CLEAN`] of weighed sets with effects where nothing is left.
pub(crate) fn best_if_nothing_is_left<'a, 'b>(
    weighed: impl Iterator<Item = &'b Weighed<'a>>,
) -> Vec<&'b Weighed<'a>>
where
    'a: 'b,
{
    let mut best: Vec<&Weighed<'a>> =
        weighed.filter(|own| !own.fit.hypothesis.candidates.is_empty()).collect();
    best.sort_by(|a, b| b.if_nothing_is_left().total_cmp(&a.if_nothing_is_left()));
    best.truncate(CLEAN);
    best
}

/// Log likelihood ratio of a fit over another on the same data, tempered.
pub(crate) fn ratio(fit: &Fit, other: &Fit, time: f64) -> f64 {
    other.nats_behind(fit.squares, time)
}

/// What sets of effects are weighed by on the same samples.
#[derive(Debug, Clone)]
pub(crate) struct Weighing<'a> {
    data: &'a Data,
    calibrated: &'a Fit,
    likelihood: Likelihood,
    /// Log likelihood of the calibrated simulator.
    bare: f64,
    vocabulary: usize,
}

impl<'a> Weighing<'a> {
    /// Beside what the closest set of an archive leaves.
    pub(crate) fn of(data: &'a Data, calibrated: &'a Fit, archive: &Archive, vocabulary: usize) -> Self {
        let closest = archive.fits.iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        let closest = &closest.unwrap_or(calibrated).residuals;
        let noise = crate::noise::floor::floor(data, closest).value;
        let likelihood = Likelihood::of(data, &data.by_part(closest), noise, View::Whole);
        let bare = likelihood.log(&data.by_part(&calibrated.residuals));
        Self { data, calibrated, likelihood, bare, vocabulary }
    }

    /// Log evidence of a set relative to the calibrated simulator: what it gains, less the Bayesian information
    /// criterion's price of its parameters and that of its effects.
    pub(crate) fn evidence(&self, fit: &Fit) -> f64 {
        let parameters = fit.globals().saturating_sub(self.calibrated.globals()) + further_starts(fit);
        let fitted = parameter_price(parameters, self.likelihood.worth());
        let own = self.likelihood.log(&self.data.by_part(&fit.residuals));
        own - self.bare - fitted - price(self.data, fit, self.vocabulary, 1.0)
    }

    /// Every set with its probability, best first; the calibrated simulator alone is the empty one.
    pub(crate) fn weigh<'b>(&self, archive: &'b Archive) -> Vec<Weighed<'b>> {
        let of = |fit: &'b Fit| Weighed { fit, evidence: self.evidence(fit), probability: 0.0 };
        let mut weighed: Vec<Weighed<'b>> = archive.fits.par_iter().map(of).collect();
        weighed.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        share(&mut weighed);
        weighed
    }
}

/// Gives sets, best first, their probabilities among each other.
pub(crate) fn share(weighed: &mut [Weighed<'_>]) {
    // Without sets there is nothing to share.
    let best = weighed.first().map_or(0.0, |w| w.evidence);
    let total: f64 = weighed.iter().map(|w| (w.evidence - best).exp()).sum();
    for w in weighed {
        w.probability = (w.evidence - best).exp() / total;
    }
}

/// Log evidence that an effect has to bring which can sit where it likes on a record. In training banks
/// (`experiments/rigs`, seed 1) such effects that brought 20 to 50 nats were there in 13 % of the cases, and plain laws
/// that brought that much in 54 %: what a small unlisted law leaves has room for one. With this price evidence means the
/// same for both.
const FLEXIBLE: f64 = 30.0;

/// Log evidence that every number has to bring which says how an effect looks: twenty to one, so that a law is the special
/// case of another unless the data say otherwise.
const SHAPE: f64 = 3.0;

/// Log evidence that a set pays for its effects: each for having been chosen from a vocabulary, [`SHAPE`] for every such
/// number, and [`FLEXIBLE`]. Held-out parts charge for what is fitted to noise; this is for what
/// could have been fitted instead. `left_over` is the probability that something is left beside the best set: where nothing
/// is, there is nothing for a flexible effect to soak up.
pub(crate) fn price(data: &Data, fit: &Fit, vocabulary: usize, left_over: f64) -> f64 {
    let of = |own: &Candidate| {
        let shapes = own.parameters(&data.facts).iter().filter(|parameter| parameter.shape).count();
        (vocabulary.max(2) as f64).ln()
            + SHAPE * shapes as f64
            + if own.is_flexible() { FLEXIBLE * left_over } else { 0.0 }
    };
    fit.hypothesis.counted().map(of).sum()
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

/// Probability with which a right calibration is called off.
pub(crate) const OFF_BY_CHANCE: f64 = 0.01;

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
