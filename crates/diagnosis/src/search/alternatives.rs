//! Alternatives to the best set: effects that could be added, and effects that could replace a class.
//!
//! A search follows the gains of sets. Once the sets are weighed, the best of them may be one that the search
//! has not expanded. So effects are added to it, one of each class at a time, as long as that gives a better
//! set. Then every class of it is removed and replaced, since the evidence for a class is that of the best
//! set with it minus that of the best set without it; each kind of the class is tried in its place too.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::Dictionary;
use crate::model::candidate::Candidate;
use crate::model::candidates::EvidenceClass;
use crate::search::gains::singles;
use crate::sets::archive::Archive;
use crate::sets::proposals::{Proposal, additions, proposal, take_in};
use crate::sets::weights::Weighing;
use rayon::prelude::*;

/// Largest number of effects added to the best set.
const ROUNDS: usize = 2;

/// Number of classes tried beside a set, and of effects tried in the place of a class.
const BESIDE: usize = 5;
const INSTEAD: usize = 2;

/// Fits sets with additional effects, and sets in which a class of the archive's best set is replaced.
pub(crate) fn alternatives(
    data: &Data,
    calibrated: &Fit,
    archive: &mut Archive,
    candidates: &[Candidate],
    vocabulary: usize,
) {
    let best = |archive: &Archive| {
        let weighing = Weighing::of(data, calibrated, archive, vocabulary);
        weighing.weigh(archive).first().map_or(calibrated.clone(), |w| w.fit.clone())
    };
    let mut top = best(archive);
    for _ in 0..ROUNDS {
        let beside = |own: &Candidate| !top.hypothesis.candidates.contains(own);
        let others: Vec<Candidate> = candidates.iter().copied().filter(beside).collect();
        let added = proposals(data, &top, &others, BESIDE, archive);
        if added.is_empty() {
            break;
        }
        take_in(data, archive, added, Stopping::SEARCH);
        let better = best(archive);
        if better.hypothesis.candidates == top.hypothesis.candidates {
            break;
        }
        top = better;
    }
    let classes = EvidenceClass::among(&top.hypothesis.candidates);
    let known: &Archive = archive;
    let replaced: Vec<(Option<Fit>, Vec<Proposal>)> =
        classes.par_iter().map(|&class| without(data, &top, class, candidates, known)).collect();
    let (bare, begun): (Vec<Option<Fit>>, Vec<Vec<Proposal>>) = replaced.into_iter().unzip();
    for fit in bare.into_iter().flatten() {
        archive.admit(data, fit);
    }
    take_in(data, archive, begun.into_iter().flatten().collect(), Stopping::SEARCH);
}

/// Returns a set without a class, and proposals for its replacement: other classes, and each kind of this
/// one.
fn without(
    data: &Data,
    set: &Fit,
    class: EvidenceClass,
    candidates: &[Candidate],
    archive: &Archive,
) -> (Option<Fit>, Vec<Proposal>) {
    let members = set.hypothesis.candidates.iter().copied().filter(|own| own.evidence_class() == class);
    let reduced = proposal(data, set, &members.collect::<Vec<_>>(), &[]);
    let known = archive.find(&reduced.hypothesis.candidates).cloned();
    let fitted = || fit(data, &reduced.hypothesis, reduced.point.clone(), Moving::All, Stopping::SEARCH).ok();
    let Some(bare) = known.or_else(fitted) else { return (None, Vec::new()) };
    let is_other =
        |own: &Candidate| own.evidence_class() != class && !bare.hypothesis.candidates.contains(own);
    let others: Vec<Candidate> = candidates.iter().copied().filter(is_other).collect();
    let mut begun = proposals(data, &bare, &others, INSTEAD, archive);
    // Each kind of the class is tried too.
    let kinds = candidates.iter().filter(|own| own.evidence_class() == class);
    begun.extend(kinds.flat_map(|own| proposals(data, &bare, &[*own], 1, archive)));
    (Some(bare), begun)
}

/// Proposes additions to a set: of each class the candidate with the largest first-order gain, for the best
/// `most` classes. Known sets are left out.
fn proposals(data: &Data, set: &Fit, others: &[Candidate], most: usize, archive: &Archive) -> Vec<Proposal> {
    let Ok(dictionary) = Dictionary::at(data, set, others) else { return Vec::new() };
    let mut classes: Vec<EvidenceClass> = Vec::new();
    let mut begun = Vec::new();
    for gain in singles(&dictionary) {
        let Some(class) = dictionary.candidate(&gain).map(|own| own.evidence_class()) else { continue };
        if classes.contains(&class) {
            continue;
        }
        classes.push(class);
        begun.push(proposal(data, set, &[], &additions(&data.facts, &dictionary, &gain)));
        if begun.len() == most {
            break;
        }
    }
    begun.retain(|own| archive.find(&own.hypothesis.candidates).is_none());
    begun
}
