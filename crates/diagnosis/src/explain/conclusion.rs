//! Conclusions from the fits: a probability for every effect, and the verdict.

use crate::answer::{
    EffectClass, EffectProbability, Finding, Kind, ParameterEstimate, Rivalry, Status, Verdict,
};
use crate::evidence::context::{Context, Shift};
use crate::evidence::inclusion::Inclusion;
use crate::explain::coefficients::parameters;
use crate::explain::position_torque::Unnamed;
use crate::fit::fitted::Fit;
use crate::fit::significance::OFF_BY_CHANCE;
use crate::model::candidate::Candidate;
use crate::model::vocabulary::evidence_class;
use crate::sets::weights::{Weighed, acts};
use results::{ClassEvidenceRow, DISTINCT_DISTANCE, WithInterval};

/// Probability that a constant torque, and not a wrong nominal rest angle, has shifted the rest position,
/// where this shift alone explains as much as the whole recalibration.
const SHIFTED: f64 = 0.9;

/// The same probability beside named effects, which may shift the middle of the swing themselves. In three
/// banks of rigs three of five such shifts were constant torques; Laplace's rule adds one success and one
/// failure.
const SHIFTED_BESIDE: f64 = 4.0 / 7.0;

/// Probability of an effect that time stamps or values show without a fit: all 385 of the training banks were
/// there; Laplace's rule adds one success and one failure.
const SHOWN: f64 = 386.0 / 387.0;

/// Probability from which on a class is named: it is more likely present than absent.
const LIKELY: f64 = 0.5;

/// Results of all stages before the conclusion.
#[derive(Clone, Copy)]
pub(crate) struct Parts<'a> {
    pub(crate) work: &'a Context<'a>,
    pub(crate) candidates: &'a [Candidate],
    /// Fit of the set of named effects.
    pub(crate) repaired: &'a Fit,
    /// Position-dependent torque beside them, if one was found.
    pub(crate) unnamed: Option<&'a Unnamed>,
    pub(crate) shares: &'a [(f64, WithInterval)],
    pub(crate) classes: &'a [EffectClass],
    pub(crate) inclusion: &'a Inclusion<'a>,
    /// Probability that no effect of the vocabulary explains what is missing.
    pub(crate) nameless: f64,
    /// Probability that anything beyond noise is left beside the named effects, however little.
    pub(crate) left_over: f64,
    pub(crate) calibrated_off: bool,
    pub(crate) shift: Option<Shift>,
    pub(crate) is_shifted: bool,
    pub(crate) rivals: &'a [Rivalry],
    pub(crate) findings: &'a [Finding],
}

impl Parts<'_> {
    fn named(&self) -> &[Candidate] {
        &self.repaired.hypothesis.candidates
    }

    /// Returns the probability that the system has a candidate: its class's probability times its share of
    /// the class.
    fn probability(&self, candidate: Candidate) -> f64 {
        let id = candidate.evidence_class().id();
        let class = self.classes.iter().find(|class| class.id == id);
        class.map_or(0.0, |class| class.probability * self.inclusion.membership(candidate))
    }

    /// Returns the probability that coefficients are off, whose significance was tested at 1 %.
    fn of_calibration(&self) -> f64 {
        if self.calibrated_off { 1.0 - OFF_BY_CHANCE } else { OFF_BY_CHANCE }
    }

    /// Returns the probability that no class of effects acts.
    fn none_of_classes(&self) -> f64 {
        self.classes.iter().map(|class| 1.0 - class.probability).product()
    }

    /// Returns the probability that the simulator lacks anything, from the evidence of the best set over the
    /// recalibrated simulator.
    fn incomplete(&self) -> f64 {
        acts(self.inclusion.sets.weighed.iter().map(|set| set.evidence).fold(0.0, f64::max))
    }

    /// Returns the probability that the simulator lacks something outside the vocabulary: something is left
    /// beside the named effects, or something is missing although no class acts.
    fn unlisted(&self) -> f64 {
        let left = self.nameless.max(self.left_over);
        left + (1.0 - left) * self.none_of_classes() * self.incomplete()
    }

    /// Returns the probability that the simulator lacks nothing.
    fn bare(&self) -> f64 {
        self.none_of_classes() * (1.0 - self.nameless) * (1.0 - self.incomplete())
    }
}

/// Probability from which on one of two interchangeable classes is certain to act.
const CERTAIN: f64 = 0.9;

/// Returns `true` if a class is more likely present than absent, or is the better one of two interchangeable
/// classes of which one certainly acts.
fn is_likely(class: &EffectClass) -> bool {
    class.probability >= LIKELY || class.either.is_some_and(|either| either >= CERTAIN)
}

/// Returns the classes that are more likely present than absent.
pub(crate) fn likely(classes: &[EffectClass]) -> Vec<&'static str> {
    classes.iter().filter(|class| is_likely(class)).map(|class| class.id).collect()
}

/// Returns the probability of every effect that may act, and of `none`, `calibration` and `unknown`, most
/// probable first.
pub(crate) fn probabilities(parts: &Parts<'_>) -> Vec<EffectProbability> {
    let mut list = Vec::from(verdicts(parts));
    list.extend(parts.shift.map(|shift| shifted(parts, shift)));
    for &candidate in parts.candidates {
        let is_named = parts.named().contains(&candidate);
        let is_other = parts.named().iter().any(|own| own.id() == candidate.id()) && !is_named;
        let is_listed = is_other || list.iter().any(|row| row.id == candidate.id());
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

/// Returns a row without coefficients and without a share of the gap.
fn plain(id: &'static str, probability: f64) -> EffectProbability {
    EffectProbability { id, probability, parameters: Vec::new(), gap_share: None }
}

/// Returns the rows of `unknown`, `none` and `calibration`.
fn verdicts(parts: &Parts<'_>) -> [EffectProbability; 3] {
    let bare = parts.bare();
    let of_shift = if parts.shift.is_some() && parts.named().is_empty() { SHIFTED } else { 0.0 };
    let of_calibration = parts.of_calibration();
    let coefficients = |torque: &Unnamed| parameters(parts.work, &torque.followed, Candidate::UNNAMED);
    [
        EffectProbability {
            parameters: parts.unnamed.into_iter().flat_map(coefficients).collect(),
            gap_share: parts.unnamed.map(|torque| torque.share),
            ..plain("unknown", parts.unlisted())
        },
        plain("none", bare * (1.0 - of_calibration)),
        plain("calibration", bare * of_calibration * (1.0 - of_shift)),
    ]
}

/// Returns the row of a constant torque that was found as a shift of the rest angle, beside the named effects
/// or alone.
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

/// Returns the row of a candidate, from the set of named effects if that contains it, else from the best set
/// that does.
fn fitted(parts: &Parts<'_>, candidate: Candidate) -> EffectProbability {
    let place = parts.named().iter().position(|own| *own == candidate);
    // Named effects share what the position-dependent torque leaves.
    let rest = parts.unnamed.map_or(1.0, |torque| 1.0 - torque.share.value);
    let of_named = |share: WithInterval| WithInterval {
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
        parameters: source.into_iter().flat_map(|fit| parameters(parts.work, fit, candidate)).collect(),
        gap_share: place.and_then(|place| parts.shares.get(place)).map(|share| of_named(share.1)),
    }
}

/// Returns the classes with their shares of the gap, and those that time stamps, values and the rest angle
/// show, most probable first.
pub(crate) fn classes(parts: &Parts<'_>, effects: &[EffectProbability]) -> Vec<EffectClass> {
    let mut classes = parts.classes.to_vec();
    for class in &mut classes {
        let own =
            parts.named().iter().zip(parts.shares).filter(|(own, _)| own.evidence_class().id() == class.id);
        let sum = |share: Option<WithInterval>, own: WithInterval| {
            let known = share.unwrap_or(WithInterval { value: 0.0, interval_95: [0.0; 2] });
            let [low, high] = known.interval_95;
            let [own_low, own_high] = own.interval_95;
            Some(WithInterval {
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
                // So far the fitted kinds share the whole probability of the class.
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
                evidence: ClassEvidenceRow::default(),
            }),
        }
    }
    classes.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    classes
}

/// Returns status, names, indistinguishable effects and confidence.
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
    // Likely classes that the best set of likely classes lacks.
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
    if status == Status::Calibration && parts.is_shifted {
        equivalent.push(vec!["calibration", "constant_torque"]);
    }
    Verdict { status, effects, confidence: confidence(parts, status), left_over: parts.left_over, equivalent }
}

/// Returns the probability that every named class acts, with the named kinds, and that nothing else is
/// missing: no other class, and nothing outside the vocabulary unless that is the verdict.
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
    let unlisted = parts.unlisted();
    let of_unlisted = if status == Status::Unknown { unlisted } else { 1.0 - unlisted };
    of_unlisted * classes.product::<f64>()
}
