//! Chains: sets that grow by one effect at a time, started from every class that could be the first.
//!
//! A search that expands its best sets follows one line: if two effects together gain less than a third one
//! that stands in for both, neither of them is expanded. A chain finds out how far a set with a given class
//! gets, whatever else leads. At every step it adds the effect with the largest first-order gain.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::model::dictionary::Dictionary;
use crate::search::archive::Archive;
use crate::search::asked::Asked;
use crate::search::gains::{singles, stands_out};
use crate::search::proposals::{Proposal, additions, begins_closer, left_over, proposal};
use rayon::prelude::*;

/// Number of chains, each from another class.
const MOST: usize = 6;

/// Grows chains up to the largest size of a set, and admits every set on the way to the archive.
pub(crate) fn chains(asked: &Asked<'_>, archive: &mut Archive) {
    let &Asked { data, calibrated, breadth, .. } = asked;
    let first: Vec<Vec<Proposal>> =
        next(asked, calibrated).into_iter().take(MOST).map(|own| vec![own]).collect();
    let known: &Archive = archive;
    let grown: Vec<Vec<Fit>> = first
        .into_par_iter()
        .map(|mut begun| {
            let mut chain: Vec<Fit> = Vec::new();
            while let Some(set) = begun.pop() {
                let Some(ended) = fitted(data, known, set) else { break };
                let size = ended.hypothesis.counted().count();
                let is_known = chain.iter().any(|own| own.hypothesis == ended.hypothesis);
                chain.push(ended);
                if let Some(last) = chain.last().filter(|_| size < breadth.most_effects && !is_known) {
                    begun = next(asked, last);
                    begun.truncate(1);
                }
            }
            chain
        })
        .collect();
    for own in grown.into_iter().flatten() {
        archive.admit(data, own);
    }
}

/// Returns a fit of a set without those of its members that end at strength zero: the known fit, unless the
/// set begins closer to the data than that fit ends.
fn fitted(data: &Data, archive: &Archive, set: Proposal) -> Option<Fit> {
    let known = archive.find(&set.hypothesis.candidates).cloned();
    if let Some(known) = known.filter(|_| !begins_closer(data, archive, &set)) {
        return Some(known);
    }
    let ended = fit(data, &set.hypothesis, set.point, Moving::All, Stopping::SEARCH).ok()?;
    match left_over(data, &ended) {
        Some(left) => fit(data, &left.hypothesis, left.point, Moving::All, Stopping::SEARCH).ok(),
        None => Some(ended),
    }
}

/// Proposes additions to a set that stand out there: the best of each class, largest gain first.
fn next(asked: &Asked<'_>, set: &Fit) -> Vec<Proposal> {
    let &Asked { data, candidates, threshold, .. } = asked;
    let own = &set.hypothesis.candidates;
    let others: Vec<Candidate> =
        candidates.iter().copied().filter(|other| other.counts() && !own.contains(other)).collect();
    let Ok(dictionary) = Dictionary::at(data, set, &others) else { return Vec::new() };
    let time = set.autocorrelation_time();
    let mut begun: Vec<(f64, Candidate, Proposal)> = Vec::new();
    for gain in singles(&dictionary) {
        let Some(candidate) = dictionary.candidate(&gain) else { continue };
        if stands_out(set, time, gain.squares, threshold, dictionary.looked(&gain)) {
            let added = additions(&data.facts, &dictionary, &gain);
            begun.push((gain.squares, candidate, proposal(data, set, &[], &added)));
        }
    }
    for (candidate, parameters, gain) in &dictionary.further {
        if stands_out(set, time, *gain, threshold, dictionary.frequencies) {
            let added = [(*candidate, parameters.clone())];
            begun.push((*gain, *candidate, proposal(data, set, &[], &added)));
        }
    }
    begun.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut classes = Vec::new();
    begun.retain(|(_, candidate, _)| {
        let class = candidate.evidence_class();
        let is_new = !classes.contains(&class);
        classes.push(class);
        is_new
    });
    begun.into_iter().map(|(_, _, proposal)| proposal).collect()
}
