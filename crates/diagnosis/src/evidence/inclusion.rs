//! Evidence for every class of effects, by replacement.
//!
//! Sets are weighed by what they predict of parts that they were not fitted to: what a flexible effect takes away of the
//! segments that it was fitted to often does not come back on the others. A class is as well supported as the best set
//! with it is over the best one without it, when everything else may take its place.

use crate::data::segments::Data;
use crate::evidence::context::{Predicted, Predictions};
use crate::evidence::held_out::HeldOut;
use crate::evidence::likelihood::Likelihood;
use crate::evidence::weights::{TEMPERATURE, Weighed};
use crate::fit::levenberg_marquardt::Fit;
use crate::model::candidate::Candidate;
use crate::model::candidates::EvidenceClass;
use crate::noise::floor;
use nalgebra::DVector;

/// Sets that are asked for what they predict: the best, and the best of plain laws alone.
const BEST: usize = 5;
const PLAIN: usize = 2;

/// The sets that are asked for what they predict: the best, the best of plain laws alone, and for each class of the first
/// one the best without it.
pub(crate) fn asked<'a>(weighed: &[Weighed<'a>]) -> Vec<&'a Fit> {
    let is_plain =
        |w: &&Weighed<'_>| w.fit.hypothesis.candidates.iter().all(|own| own.is_plain() || !own.counts());
    let named = || weighed.iter().filter(|w| !w.fit.hypothesis.candidates.is_empty());
    let first: Vec<Candidate> =
        named().next().map(|w| w.fit.hypothesis.candidates.clone()).unwrap_or_default();
    let without = first.iter().filter_map(|own| named().find(|w| !holds(w.fit, own.evidence_class())));
    let mut asked: Vec<&'a Fit> = Vec::new();
    for w in named().take(BEST).chain(named().filter(is_plain).take(PLAIN)).chain(without) {
        if !asked.iter().any(|known| known.hypothesis.candidates == w.fit.hypothesis.candidates) {
            asked.push(w.fit);
        }
    }
    asked
}

/// Whether a set has an effect of a class.
pub(crate) fn holds(fit: &Fit, class: EvidenceClass) -> bool {
    fit.hypothesis.candidates.iter().any(|own| own.evidence_class() == class)
}

/// The sets with the evidence of what they predict, best first.
pub(crate) fn weighed<'a>(
    segments: &Data,
    predictions: &Predictions<'a>,
    bare: &'a Fit,
    vocabulary: usize,
) -> Vec<Weighed<'a>> {
    let all = || {
        let own = |set: &Predicted<'a>| (set.followed, scaled(&set.after));
        predictions.sets.iter().map(own).chain([(bare, scaled(&predictions.recalibrated))])
    };
    let squares = |residuals: &[DVector<f64>]| residuals.iter().map(DVector::norm_squared).sum::<f64>();
    let closest = all().map(|(_, own)| own).min_by(|a, b| squares(a).total_cmp(&squares(b)));
    let Some(closest) = closest else { return Vec::new() };
    let noise = floor::floor(segments, &closest).value;
    let likelihood = Likelihood::of(segments, &closest, noise);
    let base = likelihood.log(&scaled(&predictions.recalibrated));
    let price = (vocabulary.max(2) as f64).ln();
    let of = |(fit, residuals): (&'a Fit, Vec<DVector<f64>>)| {
        let size = fit.hypothesis.candidates.iter().filter(|own| own.counts()).count();
        let evidence = likelihood.log(&residuals) - base - size as f64 * price;
        Weighed { fit, evidence, probability: 0.0 }
    };
    let mut weighed: Vec<Weighed<'a>> = all().map(of).collect();
    weighed.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let best = weighed.first().map_or(0.0, |w| w.evidence);
    let total: f64 = weighed.iter().map(|w| ((w.evidence - best) / TEMPERATURE).exp()).sum();
    for w in &mut weighed {
        w.probability = ((w.evidence - best) / TEMPERATURE).exp() / total;
    }
    weighed
}

/// Held-out residuals, on the scale that they have before start states are fitted to them.
fn scaled(held: &HeldOut) -> Vec<DVector<f64>> {
    let of = |own: &DVector<f64>| {
        let freedom = (own.len() as f64 - held.starts as f64).max(1.0);
        own * (own.len() as f64 / freedom).sqrt()
    };
    held.residuals.iter().map(of).collect()
}
