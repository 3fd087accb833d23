//! Task of a search.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::model::candidate::Candidate;
use crate::search::weak_form::Proposed;

/// Task of a search: data, candidates and threshold.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) data: &'a Data,
    /// Recalibrated simulator, where a search begins.
    pub(crate) calibrated: &'a Fit,
    pub(crate) candidates: &'a [Candidate],
    /// Sets that the weak form proposes.
    pub(crate) proposed: &'a Proposed,
    /// Largest number of effects in a set.
    pub(crate) most_effects: usize,
    /// Increase of the score that an additional effect has to bring for the search to continue.
    pub(crate) threshold: f64,
}
