//! Refit of the best sets on every sample, to convergence.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::sets::archive::{Archive, vanished};
use crate::sets::proposals::{Proposal, generalized, left_over, proposal, take_in};
use crate::sets::weights::{Weighed, best_if_nothing_is_left};
use rayon::prelude::*;

/// Number of sets refined in any case.
const FEWEST: usize = 3;

/// Distance in nats from the best set beyond which a set is not refined, because its probability is negligible.
const HOPELESS: f64 = 30.0;

/// Largest number of sets refitted on every sample, and of their rivals.
const MOST: usize = 6;

/// Refits weighed sets on other data with the same segments: the best [`MOST`], up to as many more that
/// differ from the best of their size in one member (its rivals), the best set with every class of effects,
/// the best set without every class of the best set, and the best ones if nothing is left. Sets that are
/// already in `refined`, which begins with the recalibrated simulator, stay as they are.
pub(crate) fn refine(
    data: &Data,
    refined: &Archive,
    weighed: &[Weighed<'_>],
    rejected: &[Vec<Candidate>],
    candidates: &[Candidate],
) -> Archive {
    let ranked: Vec<&Weighed<'_>> =
        weighed.iter().filter(|w| !w.fit.hypothesis.candidates.is_empty()).collect();
    let mut all: Vec<Fit> = refined.find(&[]).cloned().into_iter().collect();
    let mut rejected = rejected.to_vec();
    let mut waiting = ranked.as_slice();
    // If none of the best sets keeps its members on every sample, the next ones follow.
    while let (1, [best, ..]) = (all.len(), waiting) {
        let near = waiting
            .iter()
            .enumerate()
            .take_while(|(place, w)| *place < FEWEST || best.evidence - w.evidence < HOPELESS)
            .count();
        let (batch, rest) = waiting.split_at(near);
        let chosen = chosen(best.fit, batch, waiting);
        waiting = rest;
        let beside = uncounted(data, best.fit);
        let again = |found: &Fit| {
            let begun = proposal(data, found, &[], &absent(found, &beside));
            if let Some(known) = refined.find(&begun.hypothesis.candidates) {
                return Some(known.clone());
            }
            let found = fit(data, &begun.hypothesis, begun.point, Moving::All, Stopping::FINAL).ok()?;
            // A vanished member that does not count as an effect is removed without rejecting the set.
            let left = left_over(data, &found);
            match left.filter(|left| left.hypothesis.counted().eq(found.hypothesis.counted())) {
                Some(left) => fit(data, &left.hypothesis, left.point, Moving::All, Stopping::FINAL).ok(),
                None => Some(found),
            }
        };
        let fitted: Vec<Option<Fit>> = chosen.par_iter().map(|found| again(found)).collect();
        let (gone, fits): (Vec<Fit>, Vec<Fit>) =
            fitted.into_iter().flatten().partition(|fit| vanished(data, fit));
        rejected.extend(gone.into_iter().map(|fit| fit.hypothesis.candidates));
        all.extend(fits);
    }
    let mut refined = Archive::from(all, rejected);
    // A special case and its generalization are judged on the same samples. The fits are in the order of
    // their evidence.
    if let Some(best) = refined.fits.iter().find(|fit| !fit.hypothesis.candidates.is_empty()).cloned() {
        take_in(data, &mut refined, generalized(data, &best, candidates), Stopping::FINAL);
    }
    refined
}

/// Selects, from the waiting sets, those that are refined with a batch of the best; see [`refine`].
fn chosen<'w>(best: &Fit, batch: &[&Weighed<'w>], waiting: &[&Weighed<'w>]) -> Vec<&'w Fit> {
    // On few samples spurious members come cheaply, so the rivals of the best set of every size are examined.
    let is_rival = |w: &&&Weighed<'_>| {
        let own = &w.fit.hypothesis.candidates;
        let best = batch.iter().find(|other| other.fit.hypothesis.candidates.len() == own.len());
        best.is_some_and(|best| {
            let others = &best.fit.hypothesis.candidates;
            own.iter().filter(|candidate| !others.contains(candidate)).count() == 1
        })
    };
    let further = batch.iter().skip(MOST).filter(is_rival).take(MOST);
    let classes = best.hypothesis.candidates.iter().map(|own| own.evidence_class());
    let without = classes.filter_map(|class| waiting.iter().find(|w| w.fit.hypothesis.lacks(class)));
    let classes = batch.iter().flat_map(|w| &w.fit.hypothesis.candidates).map(|own| own.evidence_class());
    let with = classes.filter_map(|class| waiting.iter().find(|w| w.fit.hypothesis.holds(class)));
    let clean = best_if_nothing_is_left(waiting.iter().copied());
    let mut chosen: Vec<&Fit> = Vec::new();
    for w in batch.iter().take(MOST).chain(further).chain(without).chain(with).chain(&clean) {
        if !chosen.iter().any(|known| known.hypothesis.counted().eq(w.fit.hypothesis.counted())) {
            chosen.push(w.fit);
        }
    }
    chosen
}

/// Returns the members of a set that do not count as effects, with their parameters. How the sensor shows the
/// motion is the same whatever moves it, so sets with and without such a member are not compared.
fn uncounted(data: &Data, set: &Fit) -> Vec<(Candidate, Vec<f64>)> {
    let parts = set.hypothesis.parts(&data.facts, &set.point.globals);
    let members = set.hypothesis.candidates.iter().zip(parts).filter(|(own, _)| !own.counts());
    members.map(|(own, part)| (*own, part.to_vec())).collect()
}

/// Returns those of the effects that a set lacks.
fn absent(set: &Fit, effects: &[(Candidate, Vec<f64>)]) -> Vec<(Candidate, Vec<f64>)> {
    effects.iter().filter(|(own, _)| !set.hypothesis.candidates.contains(own)).cloned().collect()
}

/// Fits a set without some of its members, starting where the set ended. `keep` selects the members by their
/// index.
pub(crate) fn without(
    data: &Data,
    full: &Fit,
    keep: impl Fn(usize) -> bool,
    effort: Stopping,
) -> Option<Fit> {
    let members = full.hypothesis.candidates.iter().enumerate();
    let gone: Vec<Candidate> = members.filter(|(index, _)| !keep(*index)).map(|(_, own)| *own).collect();
    let Proposal { hypothesis, point } = proposal(data, full, &gone, &[]);
    fit(data, &hypothesis, point, Moving::All, effort).ok()
}
