//! Plain laws, all of their sets.
//!
//! Dry friction, drag, a spring that bends and a weight are what every mechanism has. A search that follows the gain
//! goes on from whatever gains most, and an effect that can sit where it likes on a record gains more than the law that
//! made the record. So all sets of plain laws are fitted before any is judged.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::model::dictionary::Dictionary;
use crate::search::archive::Archive;
use crate::search::gains::singles;
use crate::search::proposals::{Proposal, additions, proposal, take_in};
use rayon::prelude::*;

/// Fits every set of the plain laws among the candidates and takes those that keep all members into an archive. A set
/// that a law leaves no squares to take from in its direction is not fitted: the law has no size there.
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
        // What is known of a set may be a better fit than this one.
        family.extend(sets.iter().filter_map(|set| archive.find(set).cloned()));
    }
}
