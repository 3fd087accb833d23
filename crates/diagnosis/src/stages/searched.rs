//! Search for sets of effects, on the longest shooting interval that they follow.

use super::{Question, Request};
use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::search::asked::Asked;
use crate::search::beam::{Explored, first_rounds, go_on, search};
use crate::search::from_afar::from_afar;
use crate::search::plain::plain_family;
use crate::sets::archive::Archive;
use crate::sets::proposals::proposal;
use crate::sets::score::score;
use crate::sets::shooting_interval::{ShootingInterval, shortened};
use crate::sets::weights::price;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Largest number of effects in a set.
const MOST_EFFECTS: usize = 5;

/// Largest number of searches on longer shooting intervals.
const MOST_INTERVALS: usize = 3;

/// Number of sets of one effect that are compared under the other behavior of the input, beside the best set.
const SINGLES: usize = 3;

/// Number of sets from the first rounds under the other behavior that are compared.
const FRESH: usize = 2;

/// Set from which a search starts, on segments joined by `by`.
pub(crate) struct Known {
    pub(crate) by: usize,
    pub(crate) set: Fit,
}

/// Result of a search.
pub(crate) struct Searched {
    /// Shooting interval that the best sets follow, with the coarse samples and the recalibrated simulator on
    /// them.
    pub(crate) interval: ShootingInterval,
    pub(crate) found: Archive,
    /// Largest number of effects in a set.
    pub(crate) most_effects: usize,
}

impl Searched {
    /// Searches sets of effects. `is_whole` is `true` if no segment was left out. The search starts from the
    /// `known` set, if there is one.
    pub(crate) fn of(
        request: &Request<'_>,
        question: &Question,
        is_whole: bool,
        known: Option<Known>,
    ) -> Self {
        let candidates = &question.candidates;
        let most_effects = request.settings.most_effects.clamp(1, MOST_EFFECTS);
        let asked = question.asked(most_effects);
        let (interval, mut explored) = explore(&asked, is_whole, known);
        let ShootingInterval { data, calibrated, .. } = &interval;
        plain_family(data, calibrated, candidates, &mut explored.archive);
        let asked = Asked { data, calibrated, ..asked };
        go_on(&asked, &mut explored);
        if explored.leaves_more(data) {
            let refined = question.refined();
            let asked = Asked { proposed: &refined, ..asked };
            from_afar(&asked, &mut explored.archive);
            go_on(&asked, &mut explored);
        }
        Self { interval, found: explored.archive, most_effects }
    }

    /// Returns the best set.
    pub(crate) fn best(&self) -> Option<&Fit> {
        self.found.ranked(self.found.autocorrelation_time()).into_iter().next()
    }

    /// Returns the set with the highest evidence on every sample of another question, which differs from
    /// `own` in the behavior of the input, if that evidence exceeds that of all sets on the samples of `own`.
    /// Four kinds of sets are compared: the best set, the best set without each of its members, which may only
    /// compensate for the wrong behavior, the best [`SINGLES`] sets of one effect, and the best [`FRESH`] sets of the first
    /// rounds under the other behavior.
    pub(crate) fn better_on(&self, own: &Question, other: &Question) -> Option<Known> {
        let time = self.found.autocorrelation_time();
        let ranked = self.found.ranked(time);
        let best = ranked.first()?;
        let smaller: Vec<Fit> =
            best.hypothesis.candidates.par_iter().filter_map(|member| self.without(best, *member)).collect();
        let singles = ranked.iter().skip(1).filter(|set| set.hypothesis.counted().count() == 1);
        let singles = singles.filter(|set| smaller.iter().all(|one| one.hypothesis != set.hypothesis));
        let asked: Vec<&Fit> =
            std::iter::once(*best).chain(singles.take(SINGLES).copied()).chain(&smaller).collect();
        let short = |set: &&Fit| shortened(&own.coarse, &self.interval.data, set).ok();
        let mut short: Vec<Option<Fit>> = asked.par_iter().map(short).collect();
        // An effect of the input's own path may stand in for the wrong behavior in every set that was found.
        let fresh = first_rounds(&other.asked(self.most_effects));
        let fresh: Vec<Fit> =
            fresh.ranked(fresh.autocorrelation_time()).into_iter().take(FRESH).cloned().collect();
        short.extend(fresh.iter().cloned().map(Some));
        let asked: Vec<&Fit> = asked.into_iter().chain(&fresh).collect();
        // The best set leaves the least, so that the others need no more knots than it does.
        let at = short.first()?.as_ref()?;
        let [own_data, other_data] =
            [own, other].map(|question| question.data.with_fewer_knots(question.data.spare_knots(at)));
        let again = |set: &Option<Fit>| {
            let Fit { hypothesis, point, .. } = set.as_ref()?;
            let on = |data: &Data| fit(data, hypothesis, point.clone(), Moving::All, Stopping::SEARCH).ok();
            Some((on(&own_data)?, on(&other_data)?))
        };
        let fits: Vec<Option<(Fit, Fit)>> = short.par_iter().map(again).collect();
        let both = || fits.iter().zip(&asked).filter_map(|(fits, set)| Some((fits.as_ref()?, *set)));
        let closest = both().min_by(|a, b| a.0.0.squares.total_cmp(&b.0.0.squares))?;
        let time = closest.0.0.autocorrelation_time();
        let evidence = |set: &Fit| score(set, time) - price(&own.data, set, own.candidates.len(), 0.0);
        let most = both().map(|(fits, _)| evidence(&fits.0)).fold(f64::NEG_INFINITY, f64::max);
        let (fits, set) = both().max_by(|a, b| evidence(&a.0.1).total_cmp(&evidence(&b.0.1)))?;
        (evidence(&fits.1) > most).then(|| Known { by: self.interval.by, set: set.clone() })
    }

    /// Returns a set without one of its members: the known fit, or one that starts from the set.
    fn without(&self, set: &Fit, member: Candidate) -> Option<Fit> {
        let data = &self.interval.data;
        let less = proposal(data, set, &[member], &[]);
        let known = self.found.find(&less.hypothesis.candidates).cloned();
        known.or_else(|| fit(data, &less.hypothesis, less.point, Moving::All, Stopping::SEARCH).ok())
    }

    /// Returns the largest log evidence of any set, minus the price of its effects, from a vocabulary of the
    /// given size.
    fn evidence(&self, time: f64, vocabulary: usize) -> f64 {
        let data = &self.interval.data;
        let of = |fit: &Fit| score(fit, time) - price(data, fit, vocabulary, 1.0);
        self.found.fits.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns `true` if this search, on other clocks of the same records, has come closer than another one:
    /// the sets follow a longer shooting interval or, on an equal one, have more log evidence by more than
    /// `price` nats.
    pub(crate) fn is_closer(&self, other: &Self, vocabulary: usize, price: f64) -> bool {
        let time = self.found.autocorrelation_time().min(other.found.autocorrelation_time());
        match self.interval.by.cmp(&other.interval.by) {
            Ordering::Equal => self.evidence(time, vocabulary) - price > other.evidence(time, vocabulary),
            // Only a correct model follows the motion further.
            longer => longer == Ordering::Greater,
        }
    }
}

impl Known {
    /// Returns the shooting interval that the set was found on, built from other segments, and the set fitted
    /// on it, unless it is the recalibrated simulator. `None` if the number of segments differs.
    fn on(self, segments: &Data, calibrated: &Fit) -> Option<(ShootingInterval, Vec<Fit>)> {
        let interval = ShootingInterval::joined(segments, calibrated, self.by)?;
        if self.set.point.starts.len() != interval.data.segments.len() {
            return None;
        }
        let Fit { hypothesis, point, .. } = self.set;
        let set = fit(&interval.data, &hypothesis, point, Moving::All, Stopping::FINAL).ok()?;
        let sets = if set.hypothesis.candidates.is_empty() { Vec::new() } else { vec![set] };
        Some((interval, sets))
    }
}

/// Searches on the longest shooting interval on which the recalibrated simulator is a valid start, and
/// continues on longer ones as long as the sets found follow the motion there. If segments were left out,
/// only the unjoined segments are used.
fn explore(asked: &Asked<'_>, is_whole: bool, known: Option<Known>) -> (ShootingInterval, Explored) {
    let &Asked { data: segments, calibrated, .. } = asked;
    let from = |horizon: &ShootingInterval, known: Vec<Fit>| {
        let ShootingInterval { data, calibrated, .. } = horizon;
        search(&Asked { data, calibrated, ..*asked }, known)
    };
    let begin = |horizon: &ShootingInterval| from(horizon, Vec::new());
    let shortest = ShootingInterval::shortest(segments, calibrated);
    // If parts of long records were left out, the motion cannot be continued through them.
    if !is_whole {
        let pool = begin(&shortest);
        return (shortest, pool);
    }
    let begun = known.and_then(|known| known.on(segments, calibrated));
    let (mut horizon, sets) =
        begun.unwrap_or_else(|| (ShootingInterval::longest(segments, calibrated), Vec::new()));
    let mut pool = from(&horizon, sets);
    if horizon.by > 1 && !horizon.is_followed(segments, &pool.archive) {
        pool = begin(&shortest);
        horizon = shortest;
    }
    for _ in 0..MOST_INTERVALS {
        let Some((longer, sets)) = horizon.beyond(segments, &pool.archive) else { break };
        pool = from(&longer, sets);
        horizon = longer;
    }
    (horizon, pool)
}
