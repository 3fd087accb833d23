//! The best sets once more, on every sample and to convergence.

use crate::candidate::Candidate;
use crate::fit::{Effort, Fit, Moving, Point, extended, fit};
use crate::score::score;
use crate::search::{Pool, vanished};
use crate::segments::Data;
use rayon::prelude::*;

/// Sets that are refined in any case.
const FEWEST: usize = 3;

/// Distance in log evidence behind the best from which on a set is not refined: its probability would be nil, and nobody
/// would mistake it for the best.
const HOPELESS: f64 = 60.0;

/// Refits the best `most` sets of a pool on other data with the same segments, and as many more that differ from the very
/// best in one member: its rivals. The calibrated simulator, fitted there already, comes first.
pub(crate) fn refine(data: &Data, calibrated: &Fit, pool: &Pool, most: usize, stride: usize) -> Pool {
    let time = pool.autocorrelation_time();
    let ranked: Vec<&Fit> =
        pool.ranked(time).into_iter().filter(|fit| !fit.hypothesis.candidates.is_empty()).collect();
    let score_of = |fit: &Fit| stride as f64 * score(fit, time);
    let highest = ranked.first().map_or(0.0, |fit| score_of(fit));
    let ranked: Vec<&Fit> = ranked
        .into_iter()
        .enumerate()
        .filter(|(place, fit)| *place < FEWEST || highest - score_of(fit) < HOPELESS)
        .map(|(_, fit)| fit)
        .collect();
    let best: &[Candidate] = ranked.first().map_or(&[], |fit| &fit.hypothesis.candidates);
    let rival = |fit: &Fit| {
        let own = &fit.hypothesis.candidates;
        own.len() == best.len() && own.iter().filter(|candidate| !best.contains(candidate)).count() == 1
    };
    let further = ranked.iter().skip(most).copied().filter(|fit| rival(fit)).take(most);
    let chosen: Vec<&Fit> = ranked.iter().take(most).copied().chain(further).collect();
    let refined: Vec<Option<Fit>> = chosen
        .par_iter()
        .map(|found| fit(data, &found.hypothesis, found.point.clone(), Moving::All, Effort::FINAL).ok())
        .collect();
    let (gone, fits): (Vec<Fit>, Vec<Fit>) =
        refined.into_iter().flatten().partition(|fit| vanished(data, fit));
    let mut rejected = pool.rejected.clone();
    rejected.extend(gone.into_iter().map(|fit| fit.hypothesis.candidates));
    let mut all = vec![calibrated.clone()];
    all.extend(fits);
    Pool { fits: all, rejected }
}

/// The fit of a set with one member left out, and what that costs: begun where the set was.
pub(crate) fn without(data: &Data, full: &Fit, keep: impl Fn(usize) -> bool) -> Option<Fit> {
    let parts = full.hypothesis.parts(&data.facts, &full.point.globals);
    let members: Vec<_> = full
        .hypothesis
        .candidates
        .iter()
        .zip(parts)
        .enumerate()
        .filter(|(index, _)| keep(*index))
        .map(|(_, (candidate, part))| (*candidate, part.to_vec()))
        .collect();
    let candidates: Vec<_> = members.iter().map(|(candidate, _)| *candidate).collect();
    let hypothesis = full.hypothesis.with(&candidates);
    let calibrated = full.point.globals.iter().copied().take(full.hypothesis.calibrated.len());
    let globals = calibrated.chain(members.into_iter().flat_map(|(_, part)| part)).collect();
    let starts = full.point.starts.iter().map(|start| extended(start, &hypothesis)).collect();
    fit(data, &hypothesis, Point { globals, starts }, Moving::All, Effort::FINAL).ok()
}

/// The best of two fits of the same set.
pub(crate) fn better<'a>(one: &'a Fit, other: &'a Fit, time: f64) -> &'a Fit {
    if score(one, time) >= score(other, time) { one } else { other }
}
