//! Evidence for every class of effects, by replacement.
//!
//! Sets are weighed by what they predict of parts that they were not fitted to: what a flexible effect takes away of the
//! segments that it was fitted to often does not come back on the others. A class is as well supported as the best set
//! with it is over the best one without it, when everything else may take its place.

use crate::answer::{ClassEvidence, EffectClass, Kind};
use crate::data::segments::Data;
use crate::evidence::context::{Predicted, Predictions};
use crate::evidence::half_swings::Witness;
use crate::evidence::held_out::HeldOut;
use crate::evidence::likelihood::{BANDS, Likelihood};
use crate::evidence::probability::probability;
use crate::evidence::weights::{TEMPERATURE, Weighed};
use crate::fit::levenberg_marquardt::Fit;
use crate::model::candidate::Candidate;
use crate::model::candidates::EvidenceClass;
use crate::noise::floor;
use nalgebra::DVector;
use seed::Seed;

/// Sets that are asked for what they predict: the best, and the best of plain laws alone.
const BEST: usize = 5;
const PLAIN: usize = 2;

/// The sets that are asked for what they predict: the best, the best of plain laws alone, and for each class of the first
/// one the best without it, and for each class of any the best with it.
pub(crate) fn asked<'a>(weighed: &[Weighed<'a>]) -> Vec<&'a Fit> {
    let is_plain =
        |w: &&Weighed<'_>| w.fit.hypothesis.candidates.iter().all(|own| own.is_plain() || !own.counts());
    let named = || weighed.iter().filter(|w| !w.fit.hypothesis.candidates.is_empty());
    let first: Vec<Candidate> =
        named().next().map(|w| w.fit.hypothesis.candidates.clone()).unwrap_or_default();
    let without = first.iter().filter_map(|own| named().find(|w| !holds(w.fit, own.evidence_class())));
    let mut asked: Vec<&'a Fit> = Vec::new();
    let classes: Vec<EvidenceClass> =
        named().flat_map(|w| &w.fit.hypothesis.candidates).map(|own| own.evidence_class()).collect();
    let with = classes.iter().filter_map(|class| named().find(|w| holds(w.fit, *class)));
    let plain = named().filter(is_plain).take(PLAIN);
    for w in named().take(BEST).chain(plain).chain(without).chain(with) {
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

/// Sets weighed by what they predict.
pub(crate) struct Inclusion<'a> {
    /// The sets with their evidence, best first.
    pub(crate) weighed: Vec<Weighed<'a>>,
    /// For each of these the held-out error and the power that it leaves, by segment and band.
    left: Vec<Left>,
    likelihood: Likelihood,
    /// Standard deviation of the sensor's noise.
    noise: f64,
    /// What each effect of a set costs.
    price: f64,
}

struct Left {
    error: f64,
    powers: Vec<[f64; BANDS]>,
}

/// Draws of segments for a class's stability.
const DRAWS: usize = 200;

/// Share of a class's most probable member from which on the data tell its kind.
const TOLD: f64 = 0.9;

impl<'a> Inclusion<'a> {
    /// Weighs sets by what they predict of `segments`; the recalibrated simulator, `bare`, is the empty one.
    pub(crate) fn of(
        segments: &Data,
        predictions: &Predictions<'a>,
        bare: &'a Fit,
        vocabulary: usize,
    ) -> Self {
        let own = |set: &Predicted<'a>| (set.followed, scaled(&set.after));
        let sets = predictions.sets.iter().map(own).chain([(bare, scaled(&predictions.recalibrated))]);
        let sets: Vec<(&'a Fit, Vec<DVector<f64>>)> = sets.collect();
        let square = |own: &[DVector<f64>]| own.iter().map(DVector::norm_squared).sum::<f64>();
        let closest = sets.iter().min_by(|a, b| square(&a.1).total_cmp(&square(&b.1)));
        let closest = closest.map(|own| own.1.as_slice()).unwrap_or_default();
        let noise = floor::floor(segments, closest).value;
        let likelihood = Likelihood::of(segments, closest, noise);
        let price = (vocabulary.max(2) as f64).ln();
        let samples: usize = closest.iter().map(DVector::len).sum();
        let whole: Vec<usize> = (0..closest.len()).collect();
        let mut all: Vec<(Weighed<'a>, Left)> = sets
            .into_iter()
            .map(|(fit, residuals)| {
                let powers = likelihood.powers(&residuals);
                let evidence = likelihood.log_of(&powers, &whole) - places(fit) * price;
                let error = (square(&residuals) / samples.max(1) as f64).sqrt();
                (Weighed { fit, evidence, probability: 0.0 }, Left { error, powers })
            })
            .collect();
        let base = all.last().map_or(0.0, |bare| bare.0.evidence);
        all.sort_by(|a, b| b.0.evidence.total_cmp(&a.0.evidence));
        let (mut weighed, left): (Vec<Weighed<'a>>, Vec<Left>) = all.into_iter().unzip();
        let best = weighed.first().map_or(0.0, |w| w.evidence);
        let odds = |evidence: f64| ((evidence - best) / TEMPERATURE).exp();
        let total: f64 = weighed.iter().map(|w| odds(w.evidence)).sum();
        for w in &mut weighed {
            w.probability = odds(w.evidence) / total;
            w.evidence -= base;
        }
        Self { weighed, left, likelihood, noise, price }
    }

    /// Every class that any of the sets has, the best supported first; probabilities and shares of the gap are left to
    /// others.
    pub(crate) fn classes(&self, witness: Option<&Witness>, seed: &Seed) -> Vec<EffectClass> {
        let mut ids: Vec<EvidenceClass> = Vec::new();
        for own in self.weighed.iter().flat_map(|w| &w.fit.hypothesis.candidates) {
            if !ids.contains(&own.evidence_class()) {
                ids.push(own.evidence_class());
            }
        }
        ids.into_iter().filter_map(|class| self.class(class, witness, seed)).collect()
    }

    fn class(&self, class: EvidenceClass, witness: Option<&Witness>, seed: &Seed) -> Option<EffectClass> {
        let place = |with: bool| self.weighed.iter().position(|w| holds(w.fit, class) == with);
        let (with, without) = (place(true)?, place(false)?);
        let evidence = |at: usize| self.weighed.get(at).map_or(0.0, |w| w.evidence);
        let error = |at: usize| self.left.get(at).map_or(0.0, |left| left.error);
        let kinds = self.kinds(class);
        let kind_is_told = kinds.first().is_some_and(|kind| kind.share >= TOLD);
        let mut class_row = EffectClass {
            id: class.id(),
            probability: 0.0,
            gap_share: None,
            kinds,
            kind_is_told,
            error_without: error(without),
            error_with: error(with),
            stability: self.stability(class, seed),
            evidence: ClassEvidence {
                replacement: evidence(with) - evidence(without),
                half_swings: witness.and_then(|witness| shown(witness, class)),
            },
        };
        let members = self.weighed.get(with).map(|w| w.fit.hypothesis.candidates.as_slice());
        let mut members = members.unwrap_or_default().iter().filter(|own| own.evidence_class() == class);
        let is_flexible = members.all(|own| own.is_flexible());
        class_row.probability = probability(&class_row, is_flexible, error(with) / self.noise);
        Some(class_row)
    }

    /// The best set of effects of some classes, preferably one with all of them.
    pub(crate) fn best_of(&self, classes: &[&str]) -> Vec<Candidate> {
        let within = |w: &&Weighed<'_>| {
            w.fit.hypothesis.candidates.iter().all(|own| classes.contains(&own.evidence_class().id()))
        };
        let best = self.weighed.iter().find(within);
        best.map(|w| w.fit.hypothesis.candidates.clone()).unwrap_or_default()
    }

    /// The members of a class by the sets that have them.
    fn kinds(&self, class: EvidenceClass) -> Vec<Kind> {
        let mut kinds: Vec<Kind> = Vec::new();
        let best = self.weighed.iter().find(|w| holds(w.fit, class)).map_or(0.0, |w| w.evidence);
        for w in &self.weighed {
            let odds = ((w.evidence - best) / TEMPERATURE).exp();
            for own in w.fit.hypothesis.candidates.iter().filter(|own| own.evidence_class() == class) {
                match kinds.iter_mut().find(|kind| kind.id == own.id()) {
                    Some(kind) => kind.share += odds,
                    None => kinds.push(Kind { id: own.id(), share: odds }),
                }
            }
        }
        let total: f64 = kinds.iter().map(|kind| kind.share).sum();
        for kind in &mut kinds {
            kind.share /= total;
        }
        kinds.retain(|kind| kind.share > LEAST_SHARE);
        kinds.sort_by(|a, b| b.share.total_cmp(&a.share));
        kinds
    }

    /// Part of the draws of segments in which the best set has the class.
    fn stability(&self, class: EvidenceClass, seed: &Seed) -> f64 {
        let segments = self.left.first().map_or(0, |left| left.powers.len()).max(1);
        let mut generator = seed.child("stability").generator();
        let comes_back = (0..DRAWS).filter(|_| {
            let drawn: Vec<usize> =
                (0..segments).map(|_| rand::RngExt::random_range(&mut generator, 0..segments)).collect();
            let of = |(w, left): (&Weighed<'_>, &Left)| {
                (
                    self.likelihood.log_of(&left.powers, &drawn) - places(w.fit) * self.price,
                    holds(w.fit, class),
                )
            };
            let best = self.weighed.iter().zip(&self.left).map(of).max_by(|a, b| a.0.total_cmp(&b.0));
            best.is_some_and(|best| best.1)
        });
        comes_back.count() as f64 / DRAWS as f64
    }
}

/// Share of a class below which a member is not listed.
const LEAST_SHARE: f64 = 0.005;

/// How many places of a set its effects take.
fn places(fit: &Fit) -> f64 {
    fit.hypothesis.candidates.iter().filter(|own| own.counts()).count() as f64
}

/// What half swings say of a class.
fn shown(witness: &Witness, class: EvidenceClass) -> Option<f64> {
    let larger = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => Some(one.max(other)),
        (one, other) => one.or(other),
    };
    match class {
        EvidenceClass::Friction => witness.friction,
        EvidenceClass::Restoring => larger(witness.even_stiffness, witness.asymmetric),
        EvidenceClass::Damping => witness.drag,
        EvidenceClass::Play => witness.play,
        EvidenceClass::Drift => witness.period_drift,
        EvidenceClass::SecondBody
        | EvidenceClass::Forcing
        | EvidenceClass::Preload
        | EvidenceClass::Actuator
        | EvidenceClass::Sensor
        | EvidenceClass::Stamps => None,
    }
}

/// Held-out residuals, on the scale that they have before start states are fitted to them.
fn scaled(held: &HeldOut) -> Vec<DVector<f64>> {
    let of = |own: &DVector<f64>| {
        let freedom = (own.len() as f64 - held.starts as f64).max(1.0);
        own * (own.len() as f64 / freedom).sqrt()
    };
    held.residuals.iter().map(of).collect()
}
