//! Task of a search and its breadth.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::model::candidate::Candidate;
use crate::search::weak_form::Proposed;

/// Breadth of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Breadth {
    /// Largest number of effects in a set.
    pub(crate) most_effects: usize,
    /// Number of single candidates fitted in the first round.
    pub(crate) singles: usize,
    /// Number of pairs fitted in the first round.
    pub(crate) pairs: usize,
    /// Number of candidates added to each of them.
    pub(crate) additions: usize,
}

/// Task of a search: data, candidates, breadth and threshold.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) data: &'a Data,
    /// Recalibrated simulator, where a search begins.
    pub(crate) calibrated: &'a Fit,
    pub(crate) candidates: &'a [Candidate],
    /// Sets that the weak form proposes.
    pub(crate) proposed: &'a Proposed,
    pub(crate) breadth: &'a Breadth,
    /// Increase of the score that an additional effect has to bring for the search to continue.
    pub(crate) threshold: f64,
}
