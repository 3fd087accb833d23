//! What the fits say: a probability for every effect, and the verdict in words.

use crate::answer::{
    ClassEvidence, EffectClass, EffectProbability, Finding, Interval, Kind, ParameterEstimate, Rivalry,
    Status, Verdict,
};
use crate::evidence::context::{Context, Shift};
use crate::evidence::inclusion::Inclusion;
use crate::evidence::weights::{DISTINCT_DISTANCE, OFF_BY_CHANCE, Weighed};
use crate::explain::coefficients::parameters;
use crate::explain::position_torque::Unnamed;
use crate::fit::fitted::Fit;
use crate::model::candidate::Candidate;
use crate::model::vocabulary::evidence_class;

/// Probability that a shifted rest angle that does what the whole calibration does is a constant torque, and
/// no calibration.
const SHIFTED: f64 = 0.9;

/// The same beside named effects, which may move the middle of the swing themselves: of five in three banks of rigs three were
/// constant torques. One more that is, and one that is not.
const SHIFTED_BESIDE: f64 = 4.0 / 7.0;

/// Probability of an effect that stamps or values show by themselves: all 385 of the training banks were there. One
/// more that is, and one that is not.
const SHOWN: f64 = 386.0 / 387.0;

/// Probability from which on a class is named: it is likelier there than not.
const LIKELY: f64 = 0.5;

/// What is known once everything is fitted.
#[derive(Clone, Copy)]
pub(crate) struct Parts<'a> {
    pub(crate) work: &'a Context<'a>,
    pub(crate) candidates: &'a [Candidate],
    /// The set of the named effects.
    pub(crate) repaired: &'a Fit,
    /// The torque without a name that stands beside them.
    pub(crate) unnamed: Option<&'a Unnamed>,
    pub(crate) shares: &'a [(f64, Interval)],
    pub(crate) classes: &'a [EffectClass],
    pub(crate) inclusion: &'a Inclusion<'a>,
    /// Probability that all that is missing has no name.
    pub(crate) nameless: f64,
    /// Probability that anything is left beside the named effects, however little.
    pub(crate) left_over: f64,
    pub(crate) calibrated_off: bool,
    pub(crate) shift: Option<Shift>,
    pub(crate) rivals: &'a [Rivalry],
    pub(crate) findings: &'a [Finding],
}

impl Parts<'_> {
    fn named(&self) -> &[Candidate] {
        &self.repaired.hypothesis.candidates
    }

    /// Probability that the system has a candidate: that of its class, times its share there.
    fn probability(&self, candidate: Candidate) -> f64 {
        let id = candidate.evidence_class().id();
        let class = self.classes.iter().find(|class| class.id == id);
        // A class of which nothing was fitted has no probability.
        class.map_or(0.0, |class| class.probability * self.inclusion.membership(candidate))
    }

    /// Probability that coefficients are off: their significance was tested at 1 %.
    fn of_calibration(&self) -> f64 {
        if self.calibrated_off { 1.0 - OFF_BY_CHANCE } else { OFF_BY_CHANCE }
    }

    /// Probability that the system has none of the classes, and nothing without a name.
    fn bare(&self) -> f64 {
        let none: f64 = self.classes.iter().map(|class| 1.0 - class.probability).product();
        none * (1.0 - self.nameless)
    }
}

/// Probability from which on one of two classes acts for certain, though it can't be told which.
const CERTAIN: f64 = 0.9;

/// Whether a class is likelier there than not, or the better one of two of which one certainly is.
fn is_likely(class: &EffectClass) -> bool {
    class.probability >= LIKELY || class.either.is_some_and(|either| either >= CERTAIN)
}

/// Classes that are likelier there than not.
pub(crate) fn likely(classes: &[EffectClass]) -> Vec<&'static str> {
    classes.iter().filter(|class| is_likely(class)).map(|class| class.id).collect()
}

/// Probability of every effect that may act, of `none`, `calibration` and `unknown`, most probable first.
pub(crate) fn probabilities(parts: &Parts<'_>) -> Vec<EffectProbability> {
    let mut list = Vec::from(verdicts(parts));
    list.extend(parts.shift.map(|shift| shifted(parts, shift)));
    for &candidate in parts.candidates {
        let is_named = parts.named().contains(&candidate);
        let is_listed = list.iter().any(|row| row.id == candidate.id());
        if is_named || parts.probability(candidate) >= 0.01 && !is_listed {
            list.push(fitted(parts, candidate));
        }
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

/// A row without coefficients and without a share of the gap.
fn plain(id: &'static str, probability: f64) -> EffectProbability {
    EffectProbability { id, probability, parameters: Vec::new(), gap_share: None }
}

/// The rows of `unknown`, `none` and `calibration`.
fn verdicts(parts: &Parts<'_>) -> [EffectProbability; 3] {
    let bare = parts.bare();
    let of_shift = if parts.shift.is_some() && parts.named().is_empty() { SHIFTED } else { 0.0 };
    let of_calibration = parts.of_calibration();
    let coefficients = |torque: &Unnamed| parameters(parts.work, &torque.followed, Candidate::UNNAMED);
    [
        EffectProbability {
            // Without an unnamed torque there are no coefficients of it.
            parameters: parts.unnamed.map(coefficients).unwrap_or_default(),
            gap_share: parts.unnamed.map(|torque| torque.share),
            ..plain("unknown", parts.nameless.max(parts.left_over))
        },
        plain("none", bare * (1.0 - of_calibration)),
        plain("calibration", bare * of_calibration * (1.0 - of_shift)),
    ]
}

/// The row of a shifted rest angle. It was looked for beside the named effects, or beside none.
fn shifted(parts: &Parts<'_>, shift: Shift) -> EffectProbability {
    let bare = parts.bare();
    let probability =
        if parts.named().is_empty() { bare * parts.of_calibration() * SHIFTED } else { SHIFTED_BESIDE };
    let units = parts.work.base.calibrated.hypothesis.nominal.units();
    EffectProbability {
        parameters: vec![ParameterEstimate {
            name: "torque",
            unit: dynamics::Quantity::Torque.unit(units).to_owned(),
            estimate: shift.torque,
            determined: true,
        }],
        ..plain("constant_torque", probability)
    }
}

/// The row of a candidate: of the set of the named effects where it is one of them, else of the best set that has it.
fn fitted(parts: &Parts<'_>, candidate: Candidate) -> EffectProbability {
    let place = parts.named().iter().position(|own| *own == candidate);
    // Named effects share what the torque without a name leaves them.
    let rest = 1.0 - parts.unnamed.map_or(0.0, |torque| torque.share.value);
    let of_named = |share: Interval| Interval {
        value: rest * share.value,
        interval_95: share.interval_95.map(|end| rest * end),
    };
    let complete = parts.unnamed.map_or(parts.repaired, |torque| &torque.followed);
    let has_it = |w: &&Weighed<'_>| w.fit.hypothesis.candidates.contains(&candidate);
    let best = parts.inclusion.sets.weighed.iter().find(has_it);
    let source = if place.is_some() { Some(complete) } else { best.map(|w| w.fit) };
    EffectProbability {
        id: candidate.id(),
        probability: parts.probability(candidate),
        // A candidate of no fitted set has no coefficients.
        parameters: source.map(|fit| parameters(parts.work, fit, candidate)).unwrap_or_default(),
        gap_share: place.and_then(|place| parts.shares.get(place)).map(|share| of_named(share.1)),
    }
}

/// The classes with their shares of the gap, and those that stamps, values and the rest angle show, the most probable first.
pub(crate) fn classes(parts: &Parts<'_>, effects: &[EffectProbability]) -> Vec<EffectClass> {
    let mut classes = parts.classes.to_vec();
    for class in &mut classes {
        let own =
            parts.named().iter().zip(parts.shares).filter(|(own, _)| own.evidence_class().id() == class.id);
        let sum = |share: Option<Interval>, own: Interval| {
            let known = share.unwrap_or(Interval { value: 0.0, interval_95: [0.0; 2] });
            let [low, high] = known.interval_95;
            let [own_low, own_high] = own.interval_95;
            Some(Interval {
                value: (known.value + own.value).min(1.0),
                interval_95: [(low + own_low).min(1.0), (high + own_high).min(1.0)],
            })
        };
        class.gap_share = own.map(|(_, share)| share.1).fold(None, sum);
    }
    let shown = parts.findings.iter().filter_map(|finding| finding.effect);
    for id in shown.chain(parts.shift.map(|_| "constant_torque")) {
        let Some(class) = evidence_class(id) else { continue };
        let probability = effects.iter().find(|row| row.id == id).map_or(SHOWN, |row| row.probability);
        match classes.iter_mut().find(|own| own.id == class) {
            Some(own) => {
                // Fitted kinds are there with the probability that the class had by them alone.
                for kind in &mut own.kinds {
                    kind.share *= own.probability;
                }
                if !own.kinds.iter().any(|kind| kind.id == id) {
                    own.kinds.push(Kind { id, share: probability });
                }
                let total: f64 = own.kinds.iter().map(|kind| kind.share).sum();
                for kind in &mut own.kinds {
                    kind.share /= total;
                }
                own.kinds.sort_by(|a, b| b.share.total_cmp(&a.share));
                own.probability = own.probability.max(probability);
            }
            None => classes.push(EffectClass {
                either: None,
                id: class,
                probability,
                gap_share: None,
                kinds: vec![Kind { id, share: 1.0 }],
                kind_is_told: true,
                error_without: f64::NAN,
                error_with: f64::NAN,
                stability: 1.0,
                evidence: ClassEvidence::default(),
            }),
        }
    }
    classes.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    classes
}

/// Status, names, classes and confidence.
pub(crate) fn verdict(parts: &Parts<'_>) -> Verdict {
    let mut order: Vec<(Candidate, f64)> =
        parts.named().iter().copied().zip(parts.shares.iter().map(|share| share.0)).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
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
    // Classes that are likely, and that the best set of these does not have.
    for class in parts.classes.iter().filter(|class| is_likely(class)) {
        let is_named = parts.named().iter().any(|own| own.counts() && own.evidence_class().id() == class.id);
        effects.extend(class.kinds.first().filter(|_| !is_named).map(|kind| kind.id));
    }
    let is_nameless = effects.is_empty() && parts.nameless > LIKELY;
    if parts.shift.is_some() && !is_nameless {
        effects.push("constant_torque");
        equivalent.push(vec!["constant_torque", "calibration"]);
    }
    for finding in parts.findings {
        effects.extend(finding.effect.filter(|id| !effects.contains(id)));
    }
    let status = if is_nameless {
        Status::Unknown
    } else if !effects.is_empty() {
        Status::Effect
    } else if parts.calibrated_off {
        Status::Calibration
    } else {
        Status::None
    };
    Verdict { status, effects, confidence: confidence(parts, status), left_over: parts.left_over, equivalent }
}

/// Probability of a status with exactly these effects: every named class is there with the named kinds, no other is.
fn confidence(parts: &Parts<'_>, status: Status) -> f64 {
    let is_named =
        |class: &&EffectClass| parts.named().iter().any(|own| own.evidence_class().id() == class.id);
    let classes = parts.classes.iter().map(|class| {
        if !is_named(&class) {
            return 1.0 - class.probability;
        }
        let of = |kind: &&Kind| parts.named().iter().any(|own| own.id() == kind.id);
        class.probability * class.kinds.iter().filter(of).map(|kind| kind.share).sum::<f64>().min(1.0)
    });
    let of_nameless = match status {
        Status::Unknown => parts.nameless,
        Status::Effect if !parts.named().is_empty() => 1.0,
        _ => 1.0 - parts.nameless,
    };
    of_nameless * classes.product::<f64>()
}
