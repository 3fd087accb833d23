//! All sets of plain laws.
//!
//! Dry friction, drag, a nonlinear spring and a weight occur in every mechanism. A search that follows the
//! gain expands whatever gains most, and an effect that can act anywhere on a record gains more than the law
//! that made the record. So all sets of plain laws are fitted before any set is judged.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::Dictionary;
use crate::model::candidate::Candidate;
use crate::search::gains::singles;
use crate::sets::archive::Archive;
use crate::sets::proposals::{Proposal, additions, proposal, take_in};
use rayon::prelude::*;

/// Fits every set of the plain laws among the candidates, and admits those that keep all members to the
/// archive. If a law has no gain beside a set, the two together are not fitted: its strength would be zero.
pub(crate) fn plain_family(data: &Data, calibrated: &Fit, candidates: &[Candidate], archive: &mut Archive) {
    let mut family: Vec<Fit> = vec![calibrated.clone()];
    for &law in candidates.iter().filter(|candidate| candidate.is_plain()) {
        let begun: Vec<Option<Proposal>> = family
            .par_iter()
            .map(|base| {
                let dictionary = Dictionary::at(data, base, &[law]).ok()?;
                let gain = singles(&dictionary).into_iter().next()?;
                Some(proposal(data, base, &[], &additions(&data.facts, &dictionary, &gain)))
            })
            .collect();
        let begun: Vec<Proposal> = begun.into_iter().flatten().collect();
        let sets: Vec<Vec<Candidate>> = begun.iter().map(|own| own.hypothesis.candidates.clone()).collect();
        take_in(data, archive, begun, Stopping::SEARCH);
        // The archive may know a better fit of a set than this one.
        family.extend(sets.iter().filter_map(|set| archive.find(set).cloned()));
    }
}
