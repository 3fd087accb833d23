//! What the fits say: a probability for every effect, and the verdict in words.

use crate::answer::{EffectProbability, Finding, Interval, ParameterEstimate, Rivalry, Status, Verdict};
use crate::evidence::confidence::{SHOWN, confidence, of_effect, stand_in};
use crate::evidence::context::{Context, Shift};
use crate::evidence::weights::{Weighed, marginal};
use crate::explain::coefficients::parameters;
use crate::explain::position_torque::Unnamed;
use crate::fit::levenberg_marquardt::Fit;
use crate::model::candidate::Candidate;

/// Distance in noise units below which two explanations are one class: 2·1.645, so that either is mistaken for the
/// other in one of twenty records.
pub const DISTINCT_DISTANCE: f64 = 3.29;

/// Probability that a shifted rest angle that does what the whole calibration does is a constant torque, and
/// no calibration.
const SHIFTED: f64 = 0.9;

/// What is known once everything is fitted.
#[derive(Clone, Copy)]
pub(crate) struct Parts<'a> {
    pub(crate) work: &'a Context<'a>,
    pub(crate) candidates: &'a [Candidate],
    /// The set of the named effects.
    pub(crate) repaired: &'a Fit,
    /// The torque without a name that stands beside them.
    pub(crate) unnamed: Option<&'a Unnamed>,
    pub(crate) named: &'a [Candidate],
    pub(crate) shares: &'a [(f64, Interval)],
    pub(crate) weighed: &'a [Weighed<'a>],
    /// Probability that what is missing has no name.
    pub(crate) nameless: f64,
    /// Probability that anything is left beside the named effects, however little.
    pub(crate) left_over: f64,
    pub(crate) calibrated_off: bool,
    pub(crate) shift: Option<Shift>,
    pub(crate) rivals: &'a [Rivalry],
    pub(crate) findings: &'a [Finding],
}

impl Parts<'_> {
    /// How many places of a set the named effects take.
    fn fitted(&self) -> usize {
        self.named.iter().filter(|candidate| candidate.counts()).count()
    }
}

/// Probability of every effect that may act, of `none`, `calibration` and `unknown`, most probable first.
pub(crate) fn probabilities(parts: &Parts<'_>) -> Vec<EffectProbability> {
    let Parts { work, candidates, repaired, shares, weighed, nameless, calibrated_off, shift, .. } = *parts;
    let bare: f64 =
        weighed.iter().filter(|w| w.fit.hypothesis.candidates.is_empty()).map(|w| w.probability).sum();
    let bare = bare * (1.0 - nameless);
    // The significance of the calibration was tested at 1 %.
    let of_calibration = if calibrated_off { 0.99 } else { 0.01 };
    let of_shift = if shift.is_some() && parts.named.is_empty() { SHIFTED } else { 0.0 };
    let plain =
        |id, probability| EffectProbability { id, probability, parameters: Vec::new(), gap_share: None };
    // Named effects share what the torque without a name leaves them.
    let rest = 1.0 - parts.unnamed.map_or(0.0, |torque| torque.share.value);
    let of_named = |share: Interval| Interval {
        value: rest * share.value,
        interval_95: share.interval_95.map(|end| rest * end),
    };
    let complete = parts.unnamed.map_or(repaired, |torque| &torque.followed);
    let of_unnamed = parts.unnamed.map(|torque| parameters(work, &torque.followed, Candidate::UNNAMED));
    let mut list = vec![
        EffectProbability {
            parameters: of_unnamed.unwrap_or_default(),
            gap_share: parts.unnamed.map(|torque| torque.share),
            ..plain("unknown", nameless + (1.0 - nameless) * stand_in(parts.fitted()))
        },
        plain("none", bare * (1.0 - of_calibration)),
        plain("calibration", bare * of_calibration * (1.0 - of_shift)),
    ];
    if let Some(shift) = shift {
        // A shift was looked for beside the named effects, or beside none.
        let beside = if parts.named.is_empty() { bare * of_calibration } else { 1.0 - nameless - bare };
        let units = work.base.calibrated.hypothesis.nominal.units();
        list.push(EffectProbability {
            parameters: vec![ParameterEstimate {
                name: "torque",
                unit: dynamics::Quantity::Torque.unit(units).to_owned(),
                estimate: shift.torque,
                determined: true,
            }],
            ..plain("constant_torque", beside * SHIFTED)
        });
    }
    for &candidate in candidates {
        let probability = marginal(weighed, candidate) * (1.0 - nameless);
        let place = repaired.hypothesis.candidates.iter().position(|own| *own == candidate);
        if probability < 0.01 && place.is_none() {
            continue;
        }
        let best = weighed.iter().find(|w| w.fit.hypothesis.candidates.contains(&candidate));
        let source = if place.is_some() { Some(complete) } else { best.map(|w| w.fit) };
        list.push(EffectProbability {
            id: candidate.id(),
            probability: of_effect(parts.fitted(), place.is_some(), probability, parts.left_over),
            parameters: source.map(|fit| parameters(work, fit, candidate)).unwrap_or_default(),
            gap_share: place.and_then(|place| shares.get(place)).map(|share| of_named(share.1)),
        });
    }
    for id in parts.findings.iter().filter_map(|finding| finding.effect) {
        match list.iter_mut().find(|row| row.id == id) {
            Some(row) => row.probability = row.probability.max(SHOWN),
            None => list.push(plain(id, SHOWN)),
        }
    }
    list.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    list
}

/// Status, names, classes and confidence.
pub(crate) fn verdict(parts: &Parts<'_>) -> Verdict {
    let mut order: Vec<(Candidate, f64)> =
        parts.named.iter().copied().zip(parts.shares.iter().map(|share| share.0)).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    // What has no name is left unnamed: effects that explain a part of it stand in the list with their probabilities.
    if parts.nameless > 0.5 {
        order.clear();
    }
    let mut effects: Vec<&'static str> = order.iter().map(|(candidate, _)| candidate.id()).collect();
    let mut equivalent: Vec<Vec<&'static str>> = Vec::new();
    for effect in &effects {
        let class: Vec<&'static str> = [*effect]
            .into_iter()
            .chain(
                parts
                    .rivals
                    .iter()
                    .filter(|rivalry| rivalry.effect == *effect && rivalry.distance < DISTINCT_DISTANCE)
                    .map(|rivalry| rivalry.rival),
            )
            .collect();
        if class.len() > 1 {
            equivalent.push(class);
        }
    }
    if parts.shift.is_some() && parts.nameless <= 0.5 {
        effects.push("constant_torque");
        equivalent.push(vec!["constant_torque", "calibration"]);
    }
    for finding in parts.findings {
        effects.extend(finding.effect.filter(|id| !effects.contains(id)));
    }
    let set = parts
        .weighed
        .iter()
        .find(|w| w.fit.hypothesis.candidates == parts.named)
        .map_or(0.0, |w| w.probability);
    let status = if parts.nameless > 0.5 {
        Status::Unknown
    } else if !effects.is_empty() {
        Status::Effect
    } else if parts.calibrated_off {
        Status::Calibration
    } else {
        Status::None
    };
    let probability = if status == Status::Unknown { parts.nameless } else { set * (1.0 - parts.nameless) };
    let confidence = confidence(status, parts.fitted(), probability, parts.left_over);
    Verdict { status, effects, confidence, left_over: parts.left_over, equivalent }
}
