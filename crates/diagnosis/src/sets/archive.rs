//! Archive of the sets that a search has fitted.

use crate::data::segments::Data;
use crate::fit::fitted::{Fit, Point};
use crate::model::candidate::{Candidate, MainMode};
use crate::model::hypothesis::Hypothesis;
use crate::sets::score::score;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Every set that was fitted, with the best fit of each.
#[derive(Debug, Clone, Default)]
pub(crate) struct Archive {
    pub(crate) fits: Vec<Fit>,
    /// Rejected sets: a strength ended at zero (the data do not support it, or only with the wrong sign), or
    /// a member turned into another effect.
    pub(crate) rejected: Vec<Vec<Candidate>>,
    /// Points at which fits have begun, to the bit; see [`Self::is_new`].
    begun: BTreeSet<Vec<u64>>,
}

impl Archive {
    /// Creates an archive of the recalibrated simulator alone.
    pub(crate) fn of(calibrated: &Fit) -> Self {
        Self::from(vec![calibrated.clone()], Vec::new())
    }

    /// Creates an archive of some fits and rejected sets.
    pub(crate) fn from(fits: Vec<Fit>, rejected: Vec<Vec<Candidate>>) -> Self {
        Self { fits, rejected, begun: BTreeSet::new() }
    }

    /// Returns `true` if no fit with this step limit has begun at a point yet, and records it: another one
    /// would end at the same point.
    pub(crate) fn is_new(&mut self, hypothesis: &Hypothesis, point: &Point, steps: usize) -> bool {
        let ranks = hypothesis.ranks().into_iter().chain([steps]).map(|number| number as u64);
        let values = point.globals.iter().chain(point.starts.iter().flatten());
        self.begun.insert(ranks.chain(values.map(|value| value.to_bits())).collect())
    }

    /// Returns the squares of the known fit of a set, which a new one has to fall below to be of use;
    /// infinite if none is known.
    pub(crate) fn known_squares(&self, hypothesis: &Hypothesis) -> f64 {
        self.find(&hypothesis.candidates).map_or(f64::INFINITY, |known| known.squares)
    }

    pub(crate) fn find(&self, candidates: &[Candidate]) -> Option<&Fit> {
        self.fits.iter().find(|fit| fit.hypothesis.candidates == candidates)
    }

    /// Returns the sets and candidates for another search, if this one was misled: its leading set is missing
    /// from `refined`, the archive on every sample. These are the sets that `refined` has too, and the
    /// candidates without the leader's members that no refined set holds. `None` if the search was not misled
    /// or nothing would change.
    pub(crate) fn misled(
        &self,
        refined: &Self,
        candidates: &[Candidate],
    ) -> Option<(Vec<Fit>, Vec<Candidate>)> {
        let leader = &self.ranked(self.autocorrelation_time()).first().copied()?.hypothesis.candidates;
        if refined.find(leader).is_some() {
            return None;
        }
        let stays = |candidate: &Candidate| {
            refined.fits.iter().any(|fit| fit.hypothesis.candidates.contains(candidate))
        };
        let gone = |candidate: &Candidate| leader.contains(candidate) && !stays(candidate);
        let others: Vec<Candidate> =
            candidates.iter().copied().filter(|candidate| !gone(candidate)).collect();
        let known = self.fits.iter().filter(|fit| refined.find(&fit.hypothesis.candidates).is_some());
        let known: Vec<Fit> = known.filter(|fit| !fit.hypothesis.candidates.is_empty()).cloned().collect();
        (others.len() < candidates.len() && !known.is_empty()).then_some((known, others))
    }

    /// Admits a fit if it is better than the known one of its set. A set with a vanished member is rejected.
    pub(crate) fn admit(&mut self, data: &Data, fit: Fit) {
        if vanished(data, &fit) {
            self.rejected.push(fit.hypothesis.candidates);
            return;
        }
        match self.fits.iter_mut().find(|known| known.hypothesis.candidates == fit.hypothesis.candidates) {
            Some(known) if fit.squares < known.squares => *known = fit,
            Some(_) => {}
            None => self.fits.push(fit),
        }
    }

    /// Removes a set and rejects it.
    pub(crate) fn reject(&mut self, candidates: &[Candidate]) {
        self.fits.retain(|known| known.hypothesis.candidates != candidates);
        self.rejected.push(candidates.to_vec());
    }

    /// Returns the autocorrelation time, in samples, of the set with the smallest squares: the richest
    /// adequate model. 1 if the archive is empty.
    pub(crate) fn autocorrelation_time(&self) -> f64 {
        let best = self.fits.iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        best.map_or(1.0, Fit::autocorrelation_time)
    }

    /// Returns the fits by their score ([`crate::sets::score::score`]) at an autocorrelation time, best
    /// first.
    pub(crate) fn ranked(&self, time: f64) -> Vec<&Fit> {
        let mut ranked: Vec<&Fit> = self.fits.iter().collect();
        ranked.sort_by(|a, b| score(b, time).total_cmp(&score(a, time)));
        ranked
    }

    /// Returns the highest of these scores.
    pub(crate) fn highest(&self, time: f64) -> f64 {
        self.fits.iter().map(|fit| score(fit, time)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Returns `true` if the fitted values of a member are not those of the effect that its name stands for,
/// given the fitted swing.
pub(crate) fn is_another(data: &Data, fit: &Fit) -> bool {
    let parts = fit.hypothesis.parts(&data.facts, &fit.point.globals);
    let mut members = fit.hypothesis.candidates.iter().zip(parts);
    let starts_once = data.segments.len() <= data.inputs.len();
    let (frequency, decay_rate, inertia) = match fit.hypothesis.swinging(&data.facts, &fit.point.globals) {
        Ok((nominal, stiffness)) => {
            let inertia = nominal.inertia();
            ((stiffness / inertia).max(0.0).sqrt(), 0.5 * nominal.damping() / inertia, inertia)
        }
        Err(_) => (data.facts.frequency, f64::INFINITY, data.facts.inertia),
    };
    let (resolution, repeats) = (TAU / data.facts.duration, data.facts.repeats);
    let swing =
        MainMode { frequency, decay_rate, inertia, resolution, starts_once, repeats, inputs: &data.inputs };
    members.any(|(candidate, part)| !candidate.is_itself(part, &swing))
}

/// Returns the members with a strength at zero.
pub(crate) fn gone(data: &Data, fit: &Fit) -> Vec<Candidate> {
    let parts = fit.hypothesis.parts(&data.facts, &fit.point.globals);
    let members = fit.hypothesis.candidates.iter().zip(parts);
    let at_zero = |(candidate, part): &(&Candidate, &[f64])| {
        let parameters = candidate.parameters(&data.facts);
        parameters.iter().zip(*part).any(|(own, value)| own.strength && *value <= own.lower)
    };
    members.filter(at_zero).map(|(candidate, _)| *candidate).collect()
}

/// Returns `true` if a member has vanished: its strength is zero, or its shape reduces it to a simpler
/// candidate or turns it into another one.
pub(crate) fn vanished(data: &Data, fit: &Fit) -> bool {
    let parameters = fit.hypothesis.parameters(&data.facts);
    let calibrated = fit.hypothesis.calibrated.len();
    let mut own = parameters.iter().zip(&fit.point.globals).skip(calibrated);
    own.any(|(parameter, value)| (parameter.strength || parameter.simpler) && *value <= parameter.lower)
        || is_another(data, fit)
}

#[cfg(test)]
mod tests {
    use super::Archive;
    use crate::fit::fitted::Fit;
    use crate::model::candidate::Candidate;
    use crate::model::candidates::flexible_coupling::FlexibleCoupling;
    use crate::model::candidates::gravity::Gravity;
    use crate::model::candidates::quadratic_drag::QuadraticDrag;
    use crate::sets::score::calibrated_swing;

    const GRAVITY: Candidate = Candidate::new(&Gravity);
    const SECOND_BODY: Candidate = Candidate::new(&FlexibleCoupling);

    #[test]
    fn a_search_led_by_what_does_not_stay_is_made_again_without_it() {
        let (_, base) = calibrated_swing();
        let set = |candidates: &[Candidate], part: f64| Fit {
            hypothesis: base.hypothesis.with(candidates),
            squares: part * base.squares,
            ..base.clone()
        };
        let (leader, other) = (set(&[GRAVITY, SECOND_BODY], 0.1), set(&[GRAVITY], 0.5));
        let pool = |fits: &[&Fit]| Archive::from(fits.iter().map(|fit| (*fit).clone()).collect(), Vec::new());
        let found = pool(&[&base, &leader, &other]);
        let all = [GRAVITY, SECOND_BODY, Candidate::new(&QuadraticDrag)];
        assert_eq!(found.misled(&pool(&[&base, &leader]), &all), None);
        let (known, others) = found.misled(&pool(&[&base, &other]), &all).unwrap();
        assert_eq!(known, [other]);
        assert_eq!(others, [all[0], all[2]]);
        assert_eq!(found.misled(&pool(&[&base]), &all), None, "there is nothing left to go on from");
    }
}
