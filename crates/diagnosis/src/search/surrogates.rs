//! Named effects that only stand in for a torque without a name.
//!
//! Two or three effects of the vocabulary together can follow a torque that repeats along the position, each of them
//! wrong. Where fewer of them with such a torque beside them are better supported, only these keep their names.

use crate::data::segments::Data;
use crate::evidence::score::score;
use crate::evidence::weights::{EVEN, Weighed, beyond};
use crate::explain::position_torque::{beside, evidence};
use crate::fit::levenberg_marquardt::Fit;
use crate::model::candidate::Candidate;
use crate::search::archive::Archive;
use crate::search::refine::without;
use dynamics::DynamicsError;
use rayon::prelude::*;

/// Log evidence by which a part of a set may fall behind the whole on the samples of the search and still be asked on all
/// samples.
const SLACK: f64 = 10.0;

/// Parts that are asked on all samples.
const ASKED: usize = 2;

/// Part of what is missing that a torque has to promise to first order: the recalibrated simulator may be far from where
/// the linearization holds.
const PROMISED: f64 = 0.5;

/// What the sets are, and what they are weighed by.
pub(crate) struct Question<'a> {
    /// All samples, and those of the search.
    pub(crate) data: &'a Data,
    pub(crate) coarse: &'a Data,
    /// The sets of the search.
    pub(crate) found: &'a Archive,
    /// The gain that chance alone exceeds with the false-alarm probability.
    pub(crate) threshold: f64,
    /// How many effects names are chosen from.
    pub(crate) vocabulary: usize,
}

impl Question<'_> {
    /// The fit of that part of a set which with a torque along the position beside it is supported best, and better than
    /// the whole set is with one or without; none where no part is.
    ///
    /// Every part is asked, and not one member after another: where some of the stand-ins are left, they have bent to the
    /// shape of the torque, and none is seen beside them.
    ///
    /// # Errors
    /// What the dynamics refuse.
    pub(crate) fn better_part(&self, leader: &Fit) -> Result<Option<Fit>, DynamicsError> {
        let mut near = self.near(leader)?;
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.truncate(ASKED);
        if near.is_empty() {
            return Ok(None);
        }
        let time = leader.autocorrelation_time();
        let alone = self.score(leader, time);
        let mut best = self.with_torque(leader, time)?.map_or(alone, |with| with.max(alone));
        let mut better = None;
        for (_, part) in near {
            let members = &leader.hypothesis.candidates;
            let keep = |index: usize| members.get(index).is_some_and(|own| part.contains(own));
            let Some(fit) = without(self.data, leader, keep) else { continue };
            if let Some(score) = self.with_torque(&fit, time)?.filter(|score| *score > best) {
                (best, better) = (score, Some(fit));
            }
        }
        Ok(better)
    }

    /// Parts that with a torque come near the whole on the samples of the search, with what they fall behind by.
    fn near(&self, leader: &Fit) -> Result<Vec<(f64, Vec<Candidate>)>, DynamicsError> {
        let set = &leader.hypothesis.candidates;
        let Some(whole) = self.found.find(set) else { return Ok(Vec::new()) };
        let time = self.found.autocorrelation_time();
        let alone = self.score(whole, time);
        let counted: Vec<Candidate> = set.iter().copied().filter(|own| own.counts()).collect();
        let of = |part: usize| {
            let is_out = |own: &Candidate| {
                counted.iter().position(|other| other == own).is_some_and(|place| part & (1 << place) == 0)
            };
            let own: Vec<Candidate> = set.iter().copied().filter(|own| !is_out(own)).collect();
            let known = self.found.find(&own).cloned();
            let keep = |index: usize| set.get(index).is_some_and(|own| !is_out(own));
            let Some(fit) = known.or_else(|| without(self.coarse, whole, keep)) else { return Ok(None) };
            let behind = alone - self.score(&fit, time) + EVEN;
            let bound = PROMISED * behind - SLACK;
            let Some(with) = beside(self.coarse, &fit, time, bound)? else { return Ok(None) };
            let behind = behind - evidence(self.coarse, &with, &fit, time);
            Ok((behind < SLACK).then_some((behind, own)))
        };
        let parts = (0..(1_usize << counted.len()) - 1).into_par_iter();
        let near: Vec<Result<Option<_>, _>> = parts.map(of).collect();
        near.into_iter().filter_map(Result::transpose).collect()
    }

    /// How well a set is supported at an autocorrelation time.
    fn score(&self, set: &Fit, time: f64) -> f64 {
        let hypothesis = &set.hypothesis;
        let parameters = set.globals() - hypothesis.calibrated.len();
        let worth = (set.samples() as f64 / time).max(2.0);
        let price = 0.5 * parameters as f64 * worth.ln();
        score(set, time) - beyond(hypothesis.candidates.len(), price, self.threshold, self.vocabulary)
    }

    /// The same on all samples with a torque along the position beside it, where one comes out.
    fn with_torque(&self, set: &Fit, time: f64) -> Result<Option<f64>, DynamicsError> {
        let with = beside(self.data, set, time, EVEN)?;
        Ok(with.map(|with| self.score(set, time) + evidence(self.data, &with, set, time) - EVEN))
    }
}

/// The sets that names are still taken from, the part of the leading set that was `kept` first: no larger than that, and
/// without what was not.
pub(crate) fn remaining<'a>(weighed: Vec<Weighed<'a>>, set: &[Candidate], kept: &Fit) -> Vec<Weighed<'a>> {
    let kept = &kept.hypothesis.candidates;
    let is_gone = |own: &Candidate| set.contains(own) && !kept.contains(own);
    let stays = |w: &Weighed<'_>| {
        let own = &w.fit.hypothesis.candidates;
        own.len() <= kept.len() && !own.iter().any(is_gone)
    };
    let mut rest: Vec<Weighed<'a>> = weighed.into_iter().filter(stays).collect();
    // The others have not been asked what a torque beside them would do.
    let first = rest.iter().position(|w| w.fit.hypothesis.candidates == *kept);
    if let Some(part) = first.and_then(|place| rest.get_mut(..=place)) {
        part.rotate_right(1);
    }
    let total: f64 = rest.iter().map(|w| w.probability).sum();
    // Those without what led can be too improbable beside it for a number.
    let even = 1.0 / rest.len().max(1) as f64;
    for w in &mut rest {
        w.probability = if total > 0.0 { w.probability / total } else { even };
    }
    rest
}
