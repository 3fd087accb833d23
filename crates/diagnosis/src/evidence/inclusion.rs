//! Evidence for every class of effects, by replacement.
//!
//! The evidence for a class is that of the best set with it, minus that of the best set without it, in which
//! all other effects may take its place. [`crate::evidence::weighed_sets`] defines the weights of the sets.

#![allow(clippy::indexing_slicing, reason = "places are found among the parameters that they index")]

use crate::answer::{EffectClass, Kind};
use crate::data::segments::Data;
use crate::evidence::context::{Predicted, Predictions};
use crate::evidence::half_swings::Witness;
use crate::evidence::held_out::HeldOut;
use crate::evidence::left_over::unexplained;
use crate::evidence::probability::{Shown, predicts_no_better, probability};
use crate::evidence::weighed_sets::{Left, Records, WeighedSets};
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::model::candidates::EvidenceClass;
use crate::noise::statistics::{normal_above, resampled};
use crate::residual::floor;
use crate::sets::archive::vanished;
use crate::sets::proposals::proposal;
use crate::sets::weights::{Weighed, acts, best_if_nothing_is_left};
use dynamics::DynamicsError;
use nalgebra::{DMatrix, DVector};
use results::{ClassEvidenceRow, DISTINCT_DISTANCE};
use seed::Seed;

/// Numbers of sets whose held-out predictions are computed: the best sets, and the best sets of plain laws
/// alone.
const BEST: usize = 5;
const PLAIN: usize = 2;

/// Returns the sets whose held-out predictions are computed: the best, the best of plain laws alone, the best
/// if nothing is left, for each class of the best set the best one without it, and for each class of any set
/// the best one with it.
pub(crate) fn asked<'a>(weighed: &[Weighed<'a>]) -> Vec<&'a Fit> {
    let named = || weighed.iter().filter(|w| !w.fit.hypothesis.candidates.is_empty());
    let first: Vec<Candidate> =
        named().take(1).flat_map(|w| w.fit.hypothesis.candidates.iter().copied()).collect();
    let without =
        first.iter().filter_map(|own| named().find(|w| w.fit.hypothesis.lacks(own.evidence_class())));
    let mut asked: Vec<&'a Fit> = Vec::new();
    let classes: Vec<EvidenceClass> =
        named().flat_map(|w| &w.fit.hypothesis.candidates).map(|own| own.evidence_class()).collect();
    let with = classes.iter().filter_map(|class| named().find(|w| w.fit.hypothesis.holds(*class)));
    let plain = named().filter(|w| w.fit.hypothesis.is_plain()).take(PLAIN);
    let clean = best_if_nothing_is_left(weighed.iter());
    for w in named().take(BEST).chain(plain).chain(clean).chain(without).chain(with) {
        if !asked.iter().any(|known| known.hypothesis.candidates == w.fit.hypothesis.candidates) {
            asked.push(w.fit);
        }
    }
    asked
}

/// Returns the probability that something is left beside a set. It is 1 if the set's error, or its held-out
/// error `held_out`, exceeds the white noise, whatever its spectrum. The noise of a drive was measured beside every law, so
/// that what lies within it is weighed as noise already, whatever lines it has.
fn left_over(data: &Data, set: &Fit, held_out: f64) -> Result<f64, DynamicsError> {
    let noise = data.facts.with_drive(floor::floor(data, &set.residuals).interval_95[1]);
    let is_white = (set.squares / set.freedom()).sqrt() <= WHITE * noise && held_out <= PREDICTED * noise;
    Ok(match is_white {
        true if data.facts.drive_noise > 0.0 => 0.0,
        true => acts(unexplained(data, set)?.evidence),
        false => 1.0,
    })
}

/// Returns `true` if an effect counts as one of a class.
fn is_of(own: Candidate, class: &str) -> bool {
    own.counts() && own.evidence_class().id() == class
}

/// Sets weighed by their residuals, and the records that they were fitted to.
pub(crate) struct Inclusion<'a> {
    pub(crate) sets: WeighedSets<'a>,
    records: Records<'a>,
}

/// Largest error of a residual that counts as white, relative to the upper end of the white noise's interval.
const WHITE: f64 = 1.05;

/// The same for held-out parts, where the coefficients differ a little from those of the other parts.
const PREDICTED: f64 = 1.2;

/// Ratio of sums of squares below which two errors are the same to three digits, and the largest probability of
/// a class that changes no error or may have no size. Of 16 such classes in four banks (the forty rigs of another
/// generator, `short`, seeds 92001 to 92003) four were there, of 557 others that were named 455.
const UNCHANGED: f64 = 1.001;
const UNLIKELY: f64 = 0.49;

/// Log evidence in nats from which a class is needed whatever the interval of its size. That interval is linearized, and
/// where a law's shape can undo its size, it says nothing of how much worse the best set without the class is. Of eight
/// classes whose size may be zero (the forty rigs, 64 of `short`, seeds 95001 and 95002), three of the four above this value
/// were there, and none of the four below, at 7 to 85 nats.
const CONTRADICTED: f64 = 100.0;

/// Upper ends of the chi-squared distribution's 95 %, by the number of sizes; none of no size.
const TOGETHER: [f64; 5] = [f64::INFINITY, 3.84, 5.99, 7.81, 9.49];

/// Difference in log evidence up to which two classes can replace each other.
const REPLACED: f64 = 2.0 * DISTINCT;

/// Number of draws of segments for the stability of a class.
const DRAWS: usize = 200;

/// Probability of a kind, given its class, from which on the kind counts as identified; likewise for its
/// absence.
const TOLD: f64 = 0.9;

/// Difference in log likelihood by which a kind has to explain more than another to be distinguished from it:
/// half the square of the distance at which either is mistaken for the other in one of twenty records.
const DISTINCT: f64 = 0.5 * DISTINCT_DISTANCE * DISTINCT_DISTANCE;

impl<'a> Inclusion<'a> {
    /// Weighs the sets by their residuals.
    ///
    /// # Errors
    /// Any [`DynamicsError`] of the simulation.
    pub(crate) fn of<'b>(
        records: Records<'a>,
        predictions: &'b Predictions<'a>,
    ) -> Result<Self, DynamicsError> {
        let own = |set: &'b Predicted<'a>| (set.followed, &set.after);
        let bare = (records.bare, &predictions.recalibrated);
        let sets: Vec<(&'a Fit, &'b HeldOut)> = predictions.sets.iter().map(own).chain([bare]).collect();
        let sets = WeighedSets::of(&records, &sets);
        let doubt = sets.best().map_or(Ok(1.0), |(best, error)| left_over(records.data, best, error))?;
        Ok(Self { sets: sets.priced(&records, doubt), records })
    }

    /// Returns every class that any of the sets has, with its probability. `gap_share` is filled in later.
    pub(crate) fn classes(&self, witness: Option<&Witness>, seed: &Seed) -> Vec<EffectClass> {
        let members = self.sets.weighed.iter().flat_map(|w| &w.fit.hypothesis.candidates);
        let (ids, mut rows): (Vec<EvidenceClass>, Vec<EffectClass>) = EvidenceClass::among(members)
            .into_iter()
            .filter(|class| *class != EvidenceClass::Unnamed)
            .filter_map(|class| Some((class, self.class(class, witness, seed)?)))
            .unzip();
        let most = rows.iter().map(|row| row.evidence.replacement).fold(0.0, f64::max);
        let mut doubted = Vec::new();
        for (row, class) in rows.iter_mut().zip(&ids) {
            let shown = Shown { evidence: &row.evidence, ratio: row.error_without / row.error_with, most };
            let is_doubted = predicts_no_better(&shown)
                || self.changes_nothing(*class)
                || row.evidence.replacement < CONTRADICTED && self.may_be_zero(*class);
            let most_likely = if is_doubted { UNLIKELY } else { 1.0 };
            row.probability = probability(&shown, self.sets.left_over).min(most_likely);
            doubted.push(is_doubted);
        }
        let known: Vec<f64> = rows.iter().map(|row| row.probability).collect();
        for (place, row) in rows.iter_mut().enumerate().filter(|(place, _)| !doubted[*place]) {
            for other in (0..ids.len()).filter(|other| *other != place) {
                let Some(either) = self.either(ids[place], ids[other], most) else { continue };
                let (own, rival) = (known[place], known[other]);
                row.probability = row.probability.max(either * own / (own + rival));
                let is_better = own > rival || own == rival && place < other;
                if is_better {
                    row.either = Some(row.either.map_or(either, |known| known.max(either)));
                }
            }
        }
        rows
    }

    /// Returns `true` if the best set with a class leaves the same error without the members of that class, to three
    /// digits.
    fn changes_nothing(&self, class: EvidenceClass) -> bool {
        let all = || self.sets.weighed.iter().map(|w| w.fit);
        let Some(with) = all().find(|fit| fit.hypothesis.holds(class)) else { return false };
        let is_other = |own: &&Candidate| own.evidence_class() != class;
        let others: Vec<Candidate> = with.hypothesis.candidates.iter().filter(is_other).copied().collect();
        let mut without = all().filter(|fit| fit.hypothesis.candidates == others);
        without.any(|without| without.squares < UNCHANGED * with.squares)
    }

    /// Returns `true` if no member of a class in the best set with it has a size significantly different from zero.
    /// Flexible effects are not tested: a linearization gives no interval for the size of a stiff stop or a small
    /// body.
    fn may_be_zero(&self, class: EvidenceClass) -> bool {
        let Some((with, _)) = self.first(&|fit| fit.hypothesis.holds(class)) else { return false };
        let (fit, facts) = (with.fit, &self.records.data.facts);
        let is_told = |value: f64, error: f64| value.abs() > normal_above(0.025) * error;
        let variance = fit.variance();
        let parts = fit.hypothesis.all_parts(facts, &fit.point.globals);
        let mut own = parts.into_iter().filter(|(member, _, _)| {
            fit.hypothesis.candidates.contains(member) && member.evidence_class() == class
        });
        own.all(|(member, place, values)| {
            let Some(first) = place.filter(|_| !member.is_flexible()) else { return false };
            let parameters = member.parameters(facts);
            let is_size = |at: usize| parameters.get(at).is_some_and(|own| !own.shape);
            let fitted = values
                .iter()
                .enumerate()
                .map(|(at, value)| (at, *value, (variance * fit.inverse[(first + at, first + at)]).sqrt()));
            // The size of a torque may be significant although its direction, and so each component, is not.
            let stated = member.values(values).into_iter().zip(fit.spread(member, first, values)).enumerate();
            let stated = stated.map(|(at, (value, error))| (at, value, error));
            // The size of a saturation is the inverse of its bound, which is a shape; its center does not measure it.
            let has_size = parameters.first().is_some_and(|first| !first.shape);
            let mut sizes = fitted.chain(stated).filter(|(at, ..)| is_size(*at));
            // Sizes that can replace each other, as those of friction with and without load, are tested together.
            let places: Vec<usize> = (0..values.len()).filter(|at| is_size(*at)).collect();
            let own = DVector::from_iterator(places.len(), places.iter().map(|at| values[*at]));
            let place = |at: usize| first + places[at];
            let covariance = DMatrix::from_fn(places.len(), places.len(), |row, column| {
                variance * fit.inverse[(place(row), place(column))]
            });
            let distance = covariance.cholesky().map(|covariance| own.dot(&covariance.solve(&own)));
            let least = TOGETHER.get(places.len());
            let together = distance.zip(least).is_some_and(|(distance, least)| distance > *least);
            has_size && !together && sizes.all(|(_, value, error)| !is_told(value, error))
        })
    }

    /// Returns the probability that at least one of two classes acts, if they can replace each other: of the
    /// sets with one of them alone, the best with either differ by no more than [`REPLACED`]. `None` otherwise.
    /// `most` is the largest evidence of a class.
    fn either(&self, one: EvidenceClass, other: EvidenceClass, most: f64) -> Option<f64> {
        let with_one = self.first(&|fit| fit.hypothesis.holds(one) && fit.hypothesis.lacks(other))?;
        let with_other = self.first(&|fit| fit.hypothesis.holds(other) && fit.hypothesis.lacks(one))?;
        let neither = self.first(&|fit| fit.hypothesis.lacks(one) && fit.hypothesis.lacks(other))?;
        if (with_one.0.evidence - with_other.0.evidence).abs() > REPLACED {
            return None;
        }
        let best = if with_one.0.evidence < with_other.0.evidence { with_other } else { with_one };
        let replacement = best.0.evidence - neither.0.evidence;
        let evidence = ClassEvidenceRow { replacement, half_swings: None };
        let shown = Shown { evidence: &evidence, ratio: neither.1.error / best.1.error, most };
        Some(probability(&shown, self.sets.left_over))
    }

    /// Returns the best set that has a property, with what it leaves.
    fn first(&self, has: &dyn Fn(&Fit) -> bool) -> Option<(&Weighed<'a>, &Left)> {
        self.sets.weighed.iter().zip(&self.sets.left).find(|(set, _)| has(set.fit))
    }

    fn class(&self, class: EvidenceClass, witness: Option<&Witness>, seed: &Seed) -> Option<EffectClass> {
        let with = self.first(&|fit| fit.hypothesis.holds(class))?;
        let without = self.first(&|fit| fit.hypothesis.lacks(class))?;
        Some(EffectClass {
            id: class.id(),
            probability: 0.0,
            either: None,
            gap_share: None,
            kinds: self.kinds(class),
            kind_is_told: self.is_kind_told(class),
            error_without: without.1.error,
            error_with: with.1.error,
            stability: self.stability(class, seed),
            evidence: ClassEvidenceRow {
                replacement: with.0.evidence - without.0.evidence,
                half_swings: witness.and_then(|witness| shown(witness, class)),
            },
        })
    }

    /// Returns the best set whose effects all belong to the given classes.
    pub(crate) fn within(&self, classes: &[&str]) -> Option<&Weighed<'a>> {
        let is_one = |own: &Candidate| !own.counts() || classes.contains(&own.evidence_class().id());
        self.sets.weighed.iter().find(|w| w.fit.hypothesis.candidates.iter().all(is_one))
    }

    /// Fits a set with effects of all the given classes and of no others; `None` if the best set within these
    /// classes already has all of them, if the fit fails or if one of its members vanishes. The fit starts
    /// from the best set with most of the classes, without its other members. Members of a missing class come
    /// from the best set that has the class.
    pub(crate) fn completed(&self, data: &Data, classes: &[&str]) -> Option<Fit> {
        let has = |fit: &Fit, id: &str| fit.hypothesis.candidates.iter().any(|own| is_of(*own, id));
        let count = |fit: &Fit| classes.iter().filter(|id| has(fit, id)).count();
        if self.within(classes).is_some_and(|own| count(own.fit) == classes.len()) {
            return None;
        }
        // The best of those with as many classes.
        let base = self.sets.weighed.iter().rev().max_by_key(|w| count(w.fit))?.fit;
        let mut added: Vec<(Candidate, Vec<f64>)> = Vec::new();
        for id in classes.iter().filter(|id| !has(base, id)) {
            let Some(from) = self.sets.weighed.iter().find(|w| has(w.fit, id)) else { continue };
            let parts = from.fit.hypothesis.parts(&data.facts, &from.fit.point.globals);
            let members = from.fit.hypothesis.candidates.iter().zip(parts);
            let own = members.filter(|(own, _)| is_of(**own, id));
            added.extend(own.map(|(own, part)| (*own, part.to_vec())));
        }
        let is_other = |own: &&Candidate| own.counts() && !classes.contains(&own.evidence_class().id());
        let others: Vec<Candidate> = base.hypothesis.candidates.iter().filter(is_other).copied().collect();
        let begun = proposal(data, base, &others, &added);
        let ended = fit(data, &begun.hypothesis, begun.point, Moving::All, Stopping::FINAL).ok()?;
        (!vanished(data, &ended)).then_some(ended)
    }

    /// Returns the log evidence of a further set, on the scale of the others.
    pub(crate) fn evidence(&self, set: &Predicted<'_>) -> f64 {
        self.sets.evidence(&self.records, set)
    }

    /// Returns the members of a class with their probabilities, given the class: the weight of the sets that
    /// have the member over that of all sets with the class. Several members can act at once.
    fn memberships(&self, class: EvidenceClass) -> Vec<(Candidate, f64)> {
        let with = || self.sets.weighed.iter().filter(|w| w.fit.hypothesis.holds(class));
        let Some(best) = with().next().map(|w| w.evidence) else { return Vec::new() };
        let odds = |w: &Weighed<'_>| libm::exp(w.evidence - best);
        let total: f64 = with().map(odds).sum();
        let mut members: Vec<(Candidate, f64)> = Vec::new();
        for w in with() {
            for &own in
                w.fit.hypothesis.candidates.iter().filter(|own| own.counts() && own.evidence_class() == class)
            {
                match members.iter_mut().find(|(known, _)| known.effect() == own.effect()) {
                    Some((_, sum)) => *sum += odds(w) / total,
                    None => members.push((own, odds(w) / total)),
                }
            }
        }
        members
    }

    /// Returns the probability that the system has a candidate, given its class.
    pub(crate) fn membership(&self, candidate: Candidate) -> f64 {
        let members = self.memberships(candidate.evidence_class());
        members.iter().find(|(own, _)| own.effect() == candidate.effect()).map_or(0.0, |(_, share)| *share)
    }

    /// Returns the members of a class with shares that add up to 1, largest first.
    fn kinds(&self, class: EvidenceClass) -> Vec<Kind> {
        let members = self.memberships(class);
        let total: f64 = members.iter().map(|(_, share)| share).sum();
        let of = |(own, share): &(Candidate, f64)| Kind { id: own.id(), share: share / total };
        let mut kinds: Vec<Kind> = members.iter().map(of).filter(|kind| kind.share > LEAST_SHARE).collect();
        kinds.sort_by(|a, b| b.share.total_cmp(&a.share));
        kinds
    }

    /// Returns `true` if these data identify the kind of a class: every member either acts or does not act
    /// with certainty, and no other member explains nearly as much in the place of the likeliest one. The
    /// prices of parameters do not count here.
    fn is_kind_told(&self, class: EvidenceClass) -> bool {
        let members = self.memberships(class);
        if !members.iter().all(|(_, share)| *share >= TOLD || *share <= 1.0 - TOLD) {
            return false;
        }
        let has = |w: &Weighed<'_>, own: Candidate| w.fit.hypothesis.has(own.effect());
        let explains = |chosen: &dyn Fn(&Weighed<'_>) -> bool| {
            let all = self.sets.weighed.iter().zip(&self.sets.left).filter(|(w, _)| chosen(w));
            all.map(|(w, left)| w.evidence + left.price).fold(f64::NEG_INFINITY, f64::max)
        };
        let Some((likeliest, _)) = members.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { return true };
        let with = explains(&|w| has(w, *likeliest));
        let others = members.iter().filter(|(own, share)| own != likeliest && *share < TOLD);
        others
            .map(|(other, _)| explains(&|w| has(w, *other) && !has(w, *likeliest)))
            .all(|own| with - own >= DISTINCT)
    }

    /// Returns the share of the draws of segments in which the best set has the class.
    fn stability(&self, class: EvidenceClass, seed: &Seed) -> f64 {
        let Some(segments) = self.sets.left.first().map(|left| left.powers.len()) else { return 0.0 };
        let comes_back = resampled(segments, DRAWS, &seed.child("stability")).filter(|drawn| {
            let of = |(w, left): (&Weighed<'_>, &Left)| {
                (self.sets.likelihood.log_of(&left.powers, drawn) - left.price, w.fit.hypothesis.holds(class))
            };
            let best =
                self.sets.weighed.iter().zip(&self.sets.left).map(of).max_by(|a, b| a.0.total_cmp(&b.0));
            best.is_some_and(|best| best.1)
        });
        comes_back.count() as f64 / DRAWS as f64
    }
}

/// Share of a class below which a kind is not listed.
const LEAST_SHARE: f64 = 0.005;

/// Returns the evidence of half swings for a class, in nats. Only losses count: changes of the duration or
/// the center often have other causes (training banks).
fn shown(witness: &Witness, class: EvidenceClass) -> Option<f64> {
    match class {
        EvidenceClass::Friction => witness.friction,
        EvidenceClass::Damping => witness.drag,
        _ => None,
    }
}
