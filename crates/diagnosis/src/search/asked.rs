//! What is asked of a search.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::model::candidate::Candidate;

/// How wide to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Breadth {
    /// Most effects in a set.
    pub(crate) most_effects: usize,
    /// Single candidates fitted in the first round.
    pub(crate) singles: usize,
    /// Pairs fitted in the first round.
    pub(crate) pairs: usize,
    /// Sets that later rounds go on from.
    pub(crate) beam: usize,
    /// Candidates fitted at each of them.
    pub(crate) additions: usize,
}

/// What is asked of a search.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) data: &'a Data,
    /// The calibrated nominal simulator, where a search begins.
    pub(crate) calibrated: &'a Fit,
    pub(crate) candidates: &'a [Candidate],
    pub(crate) breadth: &'a Breadth,
    /// The increase of the score that a further effect has to bring for the search to go on.
    pub(crate) threshold: f64,
}
