//! Sets of effects that come into question, on the longest shooting interval that they follow.

use super::{Question, Request};
use crate::data::segments::Data;
use crate::data::shooting_interval::ShootingInterval;
use crate::fit::levenberg_marquardt::Fit;
use crate::model::candidate::Candidate;
use crate::search::archive::Archive;
use crate::search::beam::{Breadth, search};
use crate::search::plain::plain_family;

/// Most effects that a set can hold.
const MOST_EFFECTS: usize = 5;

/// Searches on longer shooting intervals at most.
const MOST_INTERVALS: usize = 3;

/// What a search has found.
pub(crate) struct Searched {
    /// The coarse samples, joined as far as the best sets follow, and the calibrated simulator on them.
    pub(crate) interval: ShootingInterval,
    pub(crate) found: Archive,
    pub(crate) breadth: Breadth,
}

impl Searched {
    /// `is_whole` tells whether no segment was left out.
    pub(crate) fn of(request: &Request<'_>, question: &Question, is_whole: bool) -> Self {
        let breadth = Breadth {
            most_effects: request.settings.most_effects.clamp(1, MOST_EFFECTS),
            singles: 8,
            pairs: 8,
            beam: 3,
            additions: 4,
        };
        let Question { candidates, coarse, coarse_base, enough, .. } = question;
        let (interval, mut found) = explore(coarse, coarse_base, candidates, &breadth, *enough, is_whole);
        plain_family(&interval.data, &interval.calibrated, candidates, &mut found);
        Self { interval, found, breadth }
    }
}

/// Searches on the longest horizon on which the recalibrated simulator is a model to begin at, and goes on to
/// longer ones for as long as what was found follows the motion there.
fn explore(
    segments: &Data,
    calibrated: &Fit,
    candidates: &[Candidate],
    breadth: &Breadth,
    threshold: f64,
    is_whole: bool,
) -> (ShootingInterval, Archive) {
    let begin = |horizon: &ShootingInterval| {
        search(&horizon.data, &horizon.calibrated, Vec::new(), candidates, breadth, threshold)
    };
    let shortest = ShootingInterval::shortest(segments, calibrated);
    // Parts that were left out of long records have nothing to go on through.
    if !is_whole {
        let pool = begin(&shortest);
        return (shortest, pool);
    }
    let mut horizon = ShootingInterval::longest(segments, calibrated);
    let mut pool = begin(&horizon);
    if horizon.by > 1 && !horizon.is_followed(segments, &pool) {
        pool = begin(&shortest);
        horizon = shortest;
    }
    for _ in 0..MOST_INTERVALS {
        let Some((longer, sets)) = horizon.beyond(segments, &pool) else { break };
        pool = search(&longer.data, &longer.calibrated, sets, candidates, breadth, threshold);
        horizon = longer;
    }
    (horizon, pool)
}
